#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "catch.hpp"

namespace raylab::test {

/// The file of a scene of scenes/; nothing, and a warning, where it shows a model that has not been fetched.
inline std::optional<std::filesystem::path> shipped_scene(const std::string& name) {
  const std::filesystem::path folder = std::filesystem::path(RAYLAB_SOURCE_DIR) / "scenes";
  const std::filesystem::path model = folder / "models" / (name == "town" ? "town/CREDITS.txt" : name + ".obj");
  if ((name == "dragon" || name == "bunny" || name == "town") && !std::filesystem::exists(model)) {
    WARN(name << " is left out: " << model.string() << " is not there (see scenes/fetch)");
    return std::nullopt;
  }
  return folder / (name == "town" ? "town/town.toml" : name + ".toml");
}

}  // namespace raylab::test
