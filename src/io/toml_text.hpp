#pragma once
#include <string>
#include <string_view>

namespace raylab {

/// Refuses what TOML++ 3.3 mishandles in the text of a TOML document: keys of so many parts that trees of them exhaust
/// the stack, and characters that are not ASCII where it tests for white space, as its test has undefined behaviour
/// for some of them. TOML takes such characters in comments and texts alone. Throws Error (input) at
/// file:line:column.
void check_toml_text(std::string_view text, const std::string& file);

}  // namespace raylab
