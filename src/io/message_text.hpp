#pragma once
// The words of messages: values as they are shown, and the name someone probably meant.
#include <span>
#include <string>
#include <string_view>

#include "raylab/core/vec.hpp"

namespace raylab {

/// Shortest decimal that reads back as the same number.
std::string number_text(float value);
std::string number_text(double value);

/// "(0.73, 0.73, 0.73)"
std::string color_text(const Rgb& color);

/// With a space for each line end or other control character, as a message is one line.
std::string on_one_line(std::string_view text);

/// In double quotes, on one line; long texts are cut.
std::string in_quotes(std::string_view text);

/// `: the nearest known KIND is "NAME"`, or where none is near `: known KINDs are "A", "B"`; nothing when there are no
/// candidates.
std::string nearest_hint(std::string_view name, std::span<const std::string> candidates, std::string_view kind);

/// Without the spaces, tabs and line ends around it.
std::string_view trimmed(std::string_view text);

}  // namespace raylab
