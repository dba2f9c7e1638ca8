#pragma once
// What URIs hold in their text.
#include <optional>
#include <string>
#include <string_view>

namespace raylab {

/// With the byte that %XX stands for in the place of each such three characters.
std::string with_percents_decoded(std::string_view text);

/// The bytes of base64 (RFC 4648), with or without padding; nullopt where the text is none.
std::optional<std::string> from_base64(std::string_view text);

}  // namespace raylab
