#pragma once
#include <string>
#include <vector>

#include "raylab/image/image.hpp"
#include "raylab/render/render_session.hpp"

namespace raylab {

/// Why the picture will not be what was wanted, each with what to do: a scene without light, a camera that sees
/// nothing, or no mesh. Looks through at most 64 x 64 pixels.
std::vector<std::string> view_warnings(const Scene& scene, const Accelerator& accelerator,
                                       const RenderOptions& options);

/// Whether the picture is black everywhere.
bool is_black(const Film& film);

}  // namespace raylab
