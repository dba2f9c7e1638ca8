#include "texture_files.hpp"

#include <algorithm>
#include <utility>

#include "message_text.hpp"
#include "raylab/core/error.hpp"
#include "raylab/image/image_file.hpp"

namespace raylab {
namespace {

/// Pictures of light may hold what is no light: such a texel would spoil every path that meets it.
void check_texels(const TextureImage& image, const std::filesystem::path& file) {
  for (std::size_t i = 0; i < image.texels.size(); ++i) {
    const Rgb& c = image.texels[i];
    if (is_finite(c) && c.r >= 0.0f && c.g >= 0.0f && c.b >= 0.0f) continue;
    const std::size_t width = static_cast<std::size_t>(image.width);
    throw Error(ErrorKind::input, file.string(),
                "pixel (" + std::to_string(i % width) + ", " + std::to_string(i / width) + "): found " + color_text(c) +
                    ", expected finite values, at least 0");
  }
}

}  // namespace

TextureImage make_texture(Image image, const std::string& name) {
  TextureImage texture;
  texture.name = name;
  texture.width = image.width;
  texture.height = image.height;
  texture.texels = std::move(image.pixels);
  dvec3 sum(0.0);
  for (const Rgb& texel : texture.texels) sum += dvec3(texel);
  texture.mean = Rgb(sum / static_cast<double>(std::max<std::size_t>(texture.texels.size(), 1)));
  return texture;
}

TextureImage read_texture(const std::filesystem::path& file, const std::string& name) {
  TextureImage texture = make_texture(read_image(file), name);
  check_texels(texture, file);
  return texture;
}

void check_albedo(const TextureImage& image, const std::string& location) {
  for (const Rgb& texel : image.texels) {
    if (max_component(texel) <= 1.0f) continue;
    throw Error(
        ErrorKind::input, location,
        "albedo picture " + in_quotes(image.name) + ": found " + color_text(texel) + ", expected values in [0, 1]");
  }
}

std::uint32_t TextureFiles::load(const std::filesystem::path& file, const std::string& name) {
  const auto next = static_cast<std::uint32_t>(images_.size());
  const auto [entry, is_new] = index_.try_emplace(std::filesystem::weakly_canonical(file), next);
  if (is_new) {
    images_.push_back(read_texture(file, name));
    files_.push_back(file);
  }
  return entry->second;
}

std::uint32_t TextureFiles::add(const std::string& key, const std::function<TextureImage()>& make) {
  if (const auto known = made_.find(key); known != made_.end()) return known->second;
  images_.push_back(make());
  return made_[key] = static_cast<std::uint32_t>(images_.size() - 1);
}

}  // namespace raylab
