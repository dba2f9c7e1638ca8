#pragma once
#include <string>
#include <string_view>

namespace raylab {

/// Refuses a TOML document with a key of so many parts that the tree made of it would exhaust the stack of TOML++.
/// Throws Error (input) at file:line:column.
void check_toml_text(std::string_view text, const std::string& file);

}  // namespace raylab
