#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "raylab/image/image.hpp"
#include "raylab/scene/texture.hpp"

namespace raylab {

/// The pictures of a scene, each file read once however many materials use it.
class TextureFiles {
 public:
  /// Index into images() of a picture file: EXR as it is, others decoded from sRGB. `name` is kept for messages.
  /// Throws Error (input) when it cannot be read or, an EXR, holds a value that is negative or not finite.
  std::uint32_t load(const std::filesystem::path& file, const std::string& name);

  /// Index of a picture that is no file as it is, such as one inside another file. make() makes it where `key` is new.
  std::uint32_t add(const std::string& key, const std::function<TextureImage()>& make);

  const std::vector<TextureImage>& images() const { return images_; }
  /// The files that load() read.
  const std::vector<std::filesystem::path>& files() const { return files_; }
  std::vector<TextureImage> take_images() { return std::move(images_); }

 private:
  std::vector<TextureImage> images_;
  std::vector<std::filesystem::path> files_;
  std::map<std::filesystem::path, std::uint32_t> index_;  // by canonical path
  std::map<std::string, std::uint32_t> made_;             // by key
};

/// A picture as texture, with its mean.
TextureImage make_texture(Image image, const std::string& name);

/// Reads one picture as load() does, for a background.
TextureImage read_texture(const std::filesystem::path& file, const std::string& name);

/// Throws Error (input) at `location` when the picture, as an EXR may, has values above 1: as an albedo it would make
/// light out of nothing.
void check_albedo(const TextureImage& image, const std::string& location);

}  // namespace raylab
