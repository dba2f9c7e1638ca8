// What pictures of 8 bits a channel have in common, whatever their format.
#include <array>
#include <string_view>

#include "formats.hpp"
#include "raylab/core/error.hpp"

namespace raylab {

namespace fs = std::filesystem;

namespace {

bool is_png(const fs::path& file) {
  const detail::InputFile input = detail::open_input(file);
  std::array<char, 8> start{};
  const std::string_view read(start.data(), std::fread(start.data(), 1, start.size(), input.get()));
  if (read == "\x89PNG\r\n\x1a\n") return true;
  if (!read.starts_with("\xff\xd8")) detail::fail_reading(file, "neither PNG nor JPEG");
  return false;
}

}  // namespace

void detail::fail_reading(const fs::path& file, const std::string& reason) {
  throw Error(ErrorKind::input, file.string(), "not readable as a picture: " + reason);
}

std::vector<std::string> detail::channel_names(bool color, bool alpha, bool is_16_bit) {
  const char* type = is_16_bit ? " 16-bit" : " 8-bit";
  std::vector<std::string> names = color ? std::vector<std::string>{"R", "G", "B"} : std::vector<std::string>{"Y"};
  if (alpha) names.emplace_back("A");
  for (std::string& name : names) name += type;
  return names;
}

Image8 read_image8(const fs::path& file) { return is_png(file) ? detail::read_png(file) : detail::read_jpeg(file); }

ImageInfo detail::read_image8_info(const fs::path& file) {
  return is_png(file) ? read_png_info(file) : read_jpeg_info(file);
}

}  // namespace raylab
