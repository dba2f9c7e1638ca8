#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "options.hpp"
#include "raylab/io/scene_file.hpp"

namespace raylab {

/// A picture that is to be made.
struct Shot {
  std::string suffix;  ///< of its files' names: "-front", "-0001"; empty for the only picture
  CameraSettings camera;
};

/// The scene's camera; with --views each view; with --fly so many frames on a path through the views. Throws Error
/// (input) when the scene has too few views.
std::vector<Shot> shots_of(const RenderCommand& command, const LoadedScene& loaded);

/// "pictures/a.png" with "-front": "pictures/a-front.png".
std::filesystem::path with_suffix(const std::filesystem::path& file, const std::string& suffix);

/// Makes a film of the frames of an output, beside them. Returns what there is to say of it: the film's
/// name, or how to make one where ffmpeg is not installed or fails.
std::string make_film(const std::filesystem::path& output);

}  // namespace raylab
