#include "raylab/image/image_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cinttypes>
#include <system_error>

#include "formats.hpp"
#include "raylab/core/atomic_file.hpp"
#include "raylab/core/check.hpp"
#include "raylab/core/error.hpp"
#include "raylab/core/text.hpp"

namespace raylab {

namespace fs = std::filesystem;

std::string lowercase_ending(const fs::path& file) {
  std::string ending = file.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending;
}

namespace detail {

Format output_format(const fs::path& file) {
  const std::string ending = lowercase_ending(file);
  if (ending == ".exr") return Format::exr;
  if (ending == ".png") return Format::png;
  throw Error(ErrorKind::usage, file.string(),
              (ending.empty() ? "a picture's name without an ending" : "the ending " + ending + " is not known") +
                  std::string("; expected .exr or .png"));
}

PictureRows rows_of(const Image& image, const std::vector<Layer>& layers) {
  PictureRows rows{image.width, image.height, false, {}, {}};
  for (const Layer& layer : layers) {
    RAYLAB_CHECK(layer.values.size() == image.pixels.size());
    rows.layers.emplace_back(layer.name, layer.as_float);
  }
  rows.fill = [&image, &layers](int y, Rgb* pixels, float* values) {
    const std::ptrdiff_t first = std::ptrdiff_t{y} * image.width;
    std::copy_n(image.pixels.begin() + first, image.width, pixels);
    for (const Layer& layer : layers) values = std::copy_n(layer.values.begin() + first, image.width, values);
  };
  return rows;
}

InputFile open_input(const fs::path& file) {
  const auto fail = [&](int error) {
    throw Error(ErrorKind::input, file.string(), "cannot be read: " + std::generic_category().message(error));
  };
  std::error_code ignored;
  // Opening a folder succeeds on Linux; only reading from it fails.
  if (fs::is_directory(file, ignored)) fail(EISDIR);
  InputFile opened(std::fopen(file.c_str(), "rb"));
  if (!opened) fail(errno);
  return opened;
}

bool is_exr(const fs::path& file) {
  const InputFile opened = open_input(file);
  constexpr std::array<unsigned char, 4> kMagic{0x76, 0x2f, 0x31, 0x01};
  std::array<unsigned char, 4> start{};
  const bool magic = std::fread(start.data(), 1, start.size(), opened.get()) == start.size() && start == kMagic;
  return magic || lowercase_ending(file) == ".exr";
}

std::int64_t memory_budget(std::uint64_t bytes) {
  constexpr std::int64_t least = std::int64_t{1} << 26, most = std::int64_t{1} << 31;
  constexpr std::int64_t expansion = 1 << 17;  // 1 bit a pixel that deflates to 1/1032 and becomes three floats
  return bytes > most / expansion ? most : std::max(least, expansion * static_cast<std::int64_t>(bytes));
}

std::int64_t memory_budget(const fs::path& file) {
  std::error_code no_size;  // which is as a very large one
  return memory_budget(fs::file_size(file, no_size));
}

void check_budget(std::int64_t width, std::int64_t height, const fs::path& file, std::int64_t budget) {
  if (width > 0 && height > 0 && width <= budget / static_cast<std::int64_t>(sizeof(Rgb)) / height) return;
  throw Error(ErrorKind::input, file.string(),
              format("a picture of %" PRId64 " x %" PRId64 " pixels is not supported; expected 1 to %" PRId64
                     ", as this file's budget is %" PRId64 " MiB",
                     width, height, budget / static_cast<std::int64_t>(sizeof(Rgb)), budget >> 20));
}

}  // namespace detail

void write_image(const fs::path& file, const Image& image, const std::vector<Layer>& layers,
                 const Attributes& attributes, bool as_float) {
  switch (detail::output_format(file)) {
    case detail::Format::exr:
      return write_exr(file, image, layers, attributes, as_float);
    case detail::Format::png:
      return write_png(file, image);
  }
}

void check_writable_image(const fs::path& file) {
  detail::output_format(file);
  std::error_code ignored;
  if (fs::is_fifo(fs::status(file, ignored))) {
    throw Error(ErrorKind::output, file.string(), "is a pipe, and pictures are written to files");
  }
  check_writable(file);
}

namespace {

Image from_srgb(const Image8& encoded) {
  Image image(encoded.width, encoded.height);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      image.pixels[i][c] = srgb_byte_to_linear(encoded.rgb[3 * i + static_cast<std::size_t>(c)]);
    }
  }
  return image;
}

}  // namespace

Image read_image(const fs::path& file) { return detail::is_exr(file) ? read_exr(file) : from_srgb(read_image8(file)); }

Image read_image(std::string_view bytes, const std::string& name) { return from_srgb(read_image8(bytes, name)); }

ImageInfo read_image_info(const fs::path& file) {
  return detail::is_exr(file) ? detail::read_exr_info(file) : detail::read_image8_info(file);
}

}  // namespace raylab
