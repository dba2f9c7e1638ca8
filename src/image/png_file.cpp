// PNG in and out: all of libpng stays in this file.
#include <png.h>

#include <csetjmp>
#include <cstdio>
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

/// As PngReader is: what a longjmp leaves holds nothing that a destructor ends.
class PngWriter {
 public:
  explicit PngWriter(std::ostream& stream)
      : stream_(stream), png_(png_create_write_struct(PNG_LIBPNG_VER_STRING, this, fail, ignore)) {
    info_ = png_ != nullptr ? png_create_info_struct(png_) : nullptr;
    if (info_ == nullptr) throw std::bad_alloc();
  }
  ~PngWriter() { png_destroy_write_struct(&png_, &info_); }
  PngWriter(const PngWriter&) = delete;
  PngWriter& operator=(const PngWriter&) = delete;

  // Each returns false where it fails, for reason().
  bool write_header(int width, int height) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_set_write_fn(png_, this, write, nullptr);
    png_set_IHDR(png_, info_, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), 8, PNG_COLOR_TYPE_RGB,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_text software{};
    software.compression = PNG_TEXT_COMPRESSION_NONE;
    software.key = keyword_;
    software.text = program_;
    png_set_text(png_, info_, &software, 1);
    png_write_info(png_, info_);
    constexpr png_byte kPerceptual = 0;
    png_write_chunk(png_, reinterpret_cast<png_const_bytep>("sRGB"), &kPerceptual, 1);
    return true;
  }
  bool write_row(const std::uint8_t* rgb) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_write_row(png_, rgb);
    return true;
  }
  bool write_end() {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_write_end(png_, nullptr);
    return true;
  }
  const char* reason() const { return reason_; }

 private:
  [[noreturn]] static void fail(png_structp png, png_const_charp reason) {
    auto* const self = static_cast<PngWriter*>(png_get_error_ptr(png));
    std::snprintf(self->reason_, sizeof self->reason_, "%s", reason);
    png_longjmp(png, 1);
  }
  static void ignore(png_structp /*png*/, png_const_charp /*warning*/) {}
  static void write(png_structp png, png_bytep bytes, std::size_t count) {
    static_cast<PngWriter*>(png_get_io_ptr(png))
        ->stream_.write(reinterpret_cast<const char*>(bytes), static_cast<std::streamsize>(count));
  }

  std::ostream& stream_;
  png_structp png_;
  png_infop info_ = nullptr;
  char keyword_[9] = "Software";
  char program_[64] = "Raylab " RAYLAB_VERSION;
  char reason_[128] = "";
};

}  // namespace

void detail::write_png(const fs::path& file, const PictureRows& picture) {
  RAYLAB_CHECK(picture.width > 0 && picture.height > 0);
  AtomicFile output(file);
  PngWriter png(output.stream());
  const auto check = [&](bool written) {
    if (!written) throw Error(ErrorKind::output, file.string(), std::string("cannot be written: ") + png.reason());
  };
  check(png.write_header(picture.width, picture.height));
  std::vector<Rgb> row(static_cast<std::size_t>(picture.width));
  std::vector<std::uint8_t> encoded(3 * row.size());
  std::vector<float> layers(row.size() * picture.layers.size());  // which PNG has none of
  for (int y = 0; y < picture.height; ++y) {
    picture.fill(y, row.data(), layers.data());
    for (std::size_t i = 0; i < encoded.size(); ++i) {
      encoded[i] = linear_to_srgb_byte(row[i / 3][static_cast<int>(i % 3)]);
    }
    check(png.write_row(encoded.data()));
  }
  check(png.write_end());
  output.commit();
}

void write_png(const fs::path& file, const Image& image) { detail::write_png(file, detail::rows_of(image)); }

Image8 detail::read_png(Input8 input) {
  PngReader png(std::move(input));
  return {png.width(), png.height(), png.rgb()};
}

ImageInfo detail::read_png_info(Input8 input) {
  const PngReader png(std::move(input));
  return {png.width(), png.height(), png.channels(), {}};
}

}  // namespace raylab
