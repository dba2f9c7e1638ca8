#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "raylab/scene/camera.hpp"
#include "raylab/scene/scene.hpp"

namespace raylab {

struct LoadOptions {
  /// `key=value` as on the command line: key a dotted path into the scene file such as camera.vfov,
  /// material.white.albedo or sphere.0.radius, value in TOML syntax. Later ones win.
  std::vector<std::string> overrides;
  bool keep_unneeded = false;  ///< keep mesh attributes that no material reads (see drop_unneeded)
};

/// A scene, the camera that its file gives, and what loading it had to say.
struct LoadedScene {
  Scene scene;
  CameraSettings camera;
  std::vector<std::string> warnings;  ///< "file:line: message": textures missing, faces left out, and the like
  std::vector<std::string> notes;     ///< how each material was understood, one line each
  std::uint64_t hash = 0;             ///< of the scene file's bytes, overrides, and all files it names
  std::size_t dropped_bytes = 0;      ///< freed by drop_unneeded
};

/// Reads a scene file (TOML; see README) and all files it names, paths being relative to the scene file.
/// Throws Error (input) with file:line:column, what was found, what was expected and the nearest known key.
/// Unknown keys, materials no one uses and files that are not there are errors; what OBJ and MTL files lack is a
/// warning (see read_obj). What an override brings about is an Error (usage) placed at "--set KEY".
LoadedScene load_scene(const std::filesystem::path& file, const LoadOptions& options = {});

}  // namespace raylab
