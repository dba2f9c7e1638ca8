#pragma once
#include <string>
#include <vector>

#include "live_render.hpp"

namespace raylab {

/// What the display says of the traced picture that is shown, under the name of an accelerator; null: none is shown
/// yet. Figures of another accelerator's picture are not among it.
std::vector<std::string> traced_text(const TracedPicture* picture, const std::string& accel, std::uint32_t wanted);

}  // namespace raylab
