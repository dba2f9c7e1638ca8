// What pictures of 8 bits a channel have in common, whatever their format.
#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <utility>

#include "formats.hpp"
#include "raylab/core/error.hpp"

namespace raylab {

namespace fs = std::filesystem;

namespace {

detail::Input8 open_file(const fs::path& file) { return {detail::open_input(file), file, detail::memory_budget(file)}; }

bool is_png(const detail::Input8& input) {
  std::array<char, 8> start{};
  const std::string_view read(start.data(), std::fread(start.data(), 1, start.size(), input.stream.get()));
  std::rewind(input.stream.get());
  if (read == "\x89PNG\r\n\x1a\n") return true;
  if (!read.starts_with("\xff\xd8")) detail::fail_reading(input.name, "neither PNG nor JPEG");
  return false;
}

Image8 read(detail::Input8 input) {
  return is_png(input) ? detail::read_png(std::move(input)) : detail::read_jpeg(std::move(input));
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

Image8 read_image8(const fs::path& file) { return read(open_file(file)); }

Image8 read_image8(std::string_view bytes, const std::string& name) {
  // The stream only reads. There is none of no bytes.
  detail::InputFile stream(bytes.empty() ? nullptr : fmemopen(const_cast<char*>(bytes.data()), bytes.size(), "rb"));
  if (!stream) detail::fail_reading(name, bytes.empty() ? "it is empty" : std::strerror(errno));
  return read({std::move(stream), name, detail::memory_budget(bytes.size())});
}

ImageInfo detail::read_image8_info(const fs::path& file) {
  Input8 input = open_file(file);
  return is_png(input) ? read_png_info(std::move(input)) : read_jpeg_info(std::move(input));
}

}  // namespace raylab
