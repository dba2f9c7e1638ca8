#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "raylab/scene/camera.hpp"
#include "raylab/scene/scene.hpp"

namespace raylab {

/// How a model is shown that comes without a scene file.
struct ModelOptions {
  char up = '\0';       ///< 'x', 'y' or 'z': the file's axis that points up; 0: z for STL, else y
  bool ground = false;  ///< put something under it
  int width = 640;      ///< of the picture in pixels
  int height = 480;
  /// The folder that the made scene's paths are relative to; empty: the model's.
  std::filesystem::path folder;
};

struct LoadOptions {
  /// `key=value` as on the command line: key a dotted path into the scene file such as camera.vfov,
  /// material.white.albedo or sphere.0.radius, value in TOML syntax. Later ones win.
  std::vector<std::string> overrides;
  bool keep_unneeded = false;  ///< keep mesh attributes that no material reads (see drop_unneeded)
  ModelOptions model;          ///< for a model; a scene file takes none
};

/// A camera beside the scene's own, that pictures are made from and flights lead through.
struct NamedView {
  std::string name;  ///< of letters, digits, - and _
  CameraSettings camera;
};

/// A scene, the camera that its file gives, and what loading it had to say.
struct LoadedScene {
  Scene scene;
  CameraSettings camera;
  std::vector<NamedView> views;              ///< in the order of the file
  bool made_for_model = false;               ///< the file is a model, and the scene was made for it
  std::string text;                          ///< of the scene file: as it is, or as made for the model
  std::vector<std::filesystem::path> files;  ///< all that were read: the file, and those that it names
  std::vector<std::string> warnings;         ///< "file:line: message": textures missing, faces left out, and the like
  std::vector<std::string> notes;            ///< how each material was understood, one line each
  std::uint64_t hash = 0;                    ///< of the scene file's bytes, overrides, and all files it names
  std::size_t dropped_bytes = 0;             ///< freed by drop_unneeded
};

/// Whether load_scene() would make a scene for the file. Throws Error as it does.
bool is_model_file(const std::filesystem::path& file);

/// Reads a scene file (TOML; see README) and all files it names, paths being relative to the scene file; or a model
/// (OBJ, PLY, STL or glTF, by its content), for which a scene is made.
/// Throws Error (input) with file:line:column, what was found, what was expected and the nearest known key.
/// Unknown keys, materials no one uses and files that are not there are errors; what OBJ and MTL files lack is a
/// warning (see read_obj). What an override brings about is an Error (usage) placed at "--set KEY".
LoadedScene load_scene(const std::filesystem::path& file, const LoadOptions& options = {});

}  // namespace raylab
