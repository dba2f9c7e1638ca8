// PNG out, and pictures of 8 bits a channel in: all of stb stays in this file.
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_NO_HDR
#define STBI_NO_LINEAR
#include <stb/stb_image.h>
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STBI_WRITE_NO_STDIO
#include <stb/stb_image_write.h>

#include "formats.hpp"
#include "raylab/core/atomic_file.hpp"
#include "raylab/core/check.hpp"
#include "raylab/core/error.hpp"

namespace raylab {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail_reading(const fs::path& file) {
  const char* reason = stbi_failure_reason();
  throw Error(ErrorKind::input, file.string(),
              std::string("not readable as a picture: ") + (reason != nullptr ? reason : "unknown format"));
}

struct FreePixels {
  void operator()(stbi_uc* pixels) const { stbi_image_free(pixels); }
};

void append(void* stream, void* bytes, int size) {
  static_cast<std::ofstream*>(stream)->write(static_cast<const char*>(bytes), size);
}

}  // namespace

void write_png(const fs::path& file, const Image& image) {
  RAYLAB_CHECK(image.width > 0 && image.height > 0);
  std::vector<std::uint8_t> encoded;
  encoded.reserve(3 * image.pixels.size());
  for (const Rgb& pixel : image.pixels) {
    for (int c = 0; c < 3; ++c) encoded.push_back(linear_to_srgb_byte(pixel[c]));
  }
  AtomicFile output(file);
  if (stbi_write_png_to_func(append, &output.stream(), image.width, image.height, 3, encoded.data(), 3 * image.width) ==
      0) {
    throw Error(ErrorKind::output, file.string(), "cannot be written: too large for a PNG");
  }
  output.commit();
}

Image8 read_image8(const fs::path& file) {
  const detail::InputFile input = detail::open_input(file);
  Image8 image;
  int channels = 0;
  const std::unique_ptr<stbi_uc, FreePixels> pixels(
      stbi_load_from_file(input.get(), &image.width, &image.height, &channels, 3));
  if (!pixels) fail_reading(file);
  const std::size_t count = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  image.rgb.assign(pixels.get(), pixels.get() + 3 * count);
  return image;
}

ImageInfo detail::read_image8_info(const fs::path& file) {
  const InputFile input = open_input(file);
  ImageInfo info;
  int channels = 0;
  if (stbi_info_from_file(input.get(), &info.width, &info.height, &channels) == 0) fail_reading(file);
  const char* type = stbi_is_16_bit_from_file(input.get()) != 0 ? " 16-bit" : " 8-bit";
  const bool colour = channels >= 3;
  for (const char* name : {"R", "G", "B"}) {
    if (colour) info.channels.push_back(std::string(name) + type);
  }
  if (!colour) info.channels.push_back(std::string("Y") + type);
  if (channels % 2 == 0) info.channels.push_back(std::string("A") + type);
  return info;
}

}  // namespace raylab
