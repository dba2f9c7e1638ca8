// PNG in and out: all of libpng stays in this file.
#include <png.h>
#include <zlib.h>

#include <csetjmp>
#include <new>
#include <utility>

#include "formats.hpp"
#include "raylab/core/atomic_file.hpp"
#include "raylab/core/check.hpp"
#include "raylab/core/error.hpp"

namespace raylab {

namespace fs = std::filesystem;

namespace {

/// libpng leaves a function at an error by longjmp, so the two that call it hold nothing that a destructor ends.
class PngReader {
 public:
  explicit PngReader(detail::Input8 input) : PngReader(std::move(input), nullptr) {
    if (!read_header()) refuse();
  }
  ~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;

  int width() const { return static_cast<int>(png_get_image_width(png_, info_)); }
  int height() const { return static_cast<int>(png_get_image_height(png_, info_)); }

  std::vector<std::string> channels() const {
    const int kind = png_get_color_type(png_, info_);
    const bool alpha = (kind & PNG_COLOR_MASK_ALPHA) != 0 || png_get_valid(png_, info_, PNG_INFO_tRNS) != 0;
    return detail::channel_names((kind & PNG_COLOR_MASK_COLOR) != 0, alpha, png_get_bit_depth(png_, info_) == 16);
  }

  std::vector<std::uint8_t> rgb() {
    detail::check_budget(width(), height(), input_.name, input_.budget);
    const std::size_t row_size = 3 * static_cast<std::size_t>(width());
    std::vector<std::uint8_t> pixels(row_size * static_cast<std::size_t>(height()));
    std::vector<png_bytep> rows;
    for (std::size_t at = 0; at < pixels.size(); at += row_size) rows.push_back(&pixels[at]);
    if (!read_pixels(rows.data())) refuse();
    return pixels;
  }

 private:
  /// Apart, so that the destructor runs where the header is refused.
  PngReader(detail::Input8&& input, std::nullptr_t)
      : input_(std::move(input)),
        png_(png_create_read_struct(PNG_LIBPNG_VER_STRING, this, fail, ignore)),
        info_(png_ != nullptr ? png_create_info_struct(png_) : nullptr) {
    if (info_ == nullptr) throw std::bad_alloc();
  }

  [[noreturn]] static void fail(png_structp png, png_const_charp reason) {
    static_cast<PngReader*>(png_get_error_ptr(png))->reason_ = reason;
    png_longjmp(png, 1);
  }
  static void ignore(png_structp /*png*/, png_const_charp /*warning*/) {}

  [[noreturn]] void refuse() const { detail::fail_reading(input_.name, reason_); }

  bool read_header() {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_init_io(png_, input_.stream.get());
    png_set_crc_action(png_, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
    png_set_benign_errors(png_, 0);                                          // the checksum of all pixels among them
    png_set_keep_unknown_chunks(png_, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);  // nor what is known but does not matter
    png_read_info(png_, info_);
    return true;
  }

  /// To 8 bits a channel, R G B.
  bool read_pixels(png_bytepp rows) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_set_expand(png_);
    png_set_strip_16(png_);
    png_set_strip_alpha(png_);
    png_set_gray_to_rgb(png_);
    png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
    png_read_image(png_, rows);
    png_read_end(png_, nullptr);
    return true;
  }

  detail::Input8 input_;
  png_structp png_;
  png_infop info_;
  std::string reason_;
};

/// A chunk that names the program and its version. libpng's writer in one call takes no text.
std::string software_chunk() {
  const auto big_endian = [](std::uint32_t value) {
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 0xff);
    return bytes;
  };
  const std::string text = std::string("Software") + '\0' + "Raylab " RAYLAB_VERSION;
  const std::string body = "tEXt" + text;
  const auto checksum = crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()));
  return big_endian(static_cast<std::uint32_t>(text.size())) + body + big_endian(static_cast<std::uint32_t>(checksum));
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
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::string bytes(size, '\0');
  if (png_image_write_to_memory(&png, bytes.data(), &size, 0, encoded.data(), 0, nullptr) == 0) {
    throw Error(ErrorKind::output, file.string(), std::string("cannot be written: ") + png.message);
  }
  bytes.resize(size);
  constexpr std::size_t after_header = 8 + 25;  // the signature and the first chunk
  bytes.insert(after_header, software_chunk());
  output.stream() << bytes;
  output.commit();
}

Image8 detail::read_png(Input8 input) {
  PngReader png(std::move(input));
  return {png.width(), png.height(), png.rgb()};
}

ImageInfo detail::read_png_info(Input8 input) {
  const PngReader png(std::move(input));
  return {png.width(), png.height(), png.channels(), {}};
}

}  // namespace raylab
