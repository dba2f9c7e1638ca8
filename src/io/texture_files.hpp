#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "raylab/scene/texture.hpp"

namespace raylab {

/// The pictures of a scene, each file read once however many materials use it.
class TextureFiles {
 public:
  /// Index into images() of a picture file: EXR as it is, others decoded from sRGB. `name` is kept for messages.
  /// Throws Error (input) when it cannot be read or, an EXR, holds a value that is negative or not finite.
  std::uint32_t load(const std::filesystem::path& file, const std::string& name);

  const std::vector<TextureImage>& images() const { return images_; }
  /// The files read, in the order of images().
  const std::vector<std::filesystem::path>& files() const { return files_; }
  std::vector<TextureImage> take_images() { return std::move(images_); }

 private:
  std::vector<TextureImage> images_;
  std::vector<std::filesystem::path> files_;
  std::map<std::filesystem::path, std::uint32_t> index_;  // by canonical path
};

/// Reads one picture as load() does, for a background.
TextureImage read_texture(const std::filesystem::path& file, const std::string& name);

/// Throws Error (input) at `location` when the picture, as an EXR may, has values above 1: as an albedo it would make
/// light out of nothing.
void check_albedo(const TextureImage& image, const std::string& location);

}  // namespace raylab
