#pragma once
#include <string>

#include "toml_value.hpp"

namespace raylab {

/// Sets one value of a scene file's tree from `key=value`, as if the file said so. The key is a dotted path with
/// indices into arrays ("sphere.0.radius"), parts in double quotes where they hold dots. The value is TOML; what
/// is no TOML and looks like a bare word is taken as a string.
/// A key that a table lacks is added: whether it means anything is decided when the table is read. Throws Error
/// (usage), placed at "--set KEY".
void apply_override(TomlValue& root, const std::string& assignment);

}  // namespace raylab
