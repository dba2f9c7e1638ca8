// JPEG in: all of libjpeg stays in this file.
#include <cstddef>
#include <cstdio>
// After the header that it needs and does not include.
#include <jpeglib.h>
// Codes of its messages.
#include <jerror.h>

#include <csetjmp>
#include <utility>

#include "formats.hpp"
#include "raylab/core/error.hpp"

namespace raylab {

namespace fs = std::filesystem;

namespace {

/// libjpeg leaves a function at an error by longjmp, so the two that call it hold nothing that a destructor ends.
class JpegReader {
 public:
  explicit JpegReader(detail::Input8 input) : JpegReader(std::move(input), nullptr) {
    if (!read_header()) refuse();
  }
  ~JpegReader() { jpeg_destroy_decompress(&jpeg_); }
  JpegReader(const JpegReader&) = delete;
  JpegReader& operator=(const JpegReader&) = delete;

  int width() const { return static_cast<int>(jpeg_.image_width); }
  int height() const { return static_cast<int>(jpeg_.image_height); }
  std::vector<std::string> channels() const { return detail::channel_names(jpeg_.num_components >= 3, false, false); }

  std::vector<std::uint8_t> rgb() {
    detail::check_budget(width(), height(), input_.name, input_.budget);
    std::vector<std::uint8_t> pixels(3 * static_cast<std::size_t>(width()) * static_cast<std::size_t>(height()));
    if (!read_pixels(pixels.data())) refuse();
    return pixels;
  }

 private:
  /// Apart, so that the destructor runs where the header is refused.
  JpegReader(detail::Input8&& input, std::nullptr_t) : input_(std::move(input)) {
    jpeg_.err = jpeg_std_error(&errors_);
    jpeg_.client_data = this;
    errors_.error_exit = fail;
    errors_.emit_message = note;
  }

  static JpegReader& of(j_common_ptr jpeg) { return *static_cast<JpegReader*>(jpeg->client_data); }

  [[noreturn]] static void fail(j_common_ptr jpeg) {
    jpeg->err->format_message(jpeg, of(jpeg).reason_);
    std::longjmp(of(jpeg).at_error_, 1);
  }

  /// Where data are damaged, libjpeg warns and makes something up. What it is lenient about in files that are whole,
  /// others are too.
  static void note(j_common_ptr jpeg, int level) {
    const int code = jpeg->err->msg_code;
    const bool damaged = code != JWRN_EXTRANEOUS_DATA && code != JWRN_ADOBE_XFORM && code != JWRN_JFIF_MAJOR;
    if (level < 0 && damaged) fail(jpeg);
  }

  /// Each scan goes over the whole picture, and takes a few bytes to ask for.
  static void count_scans(j_common_ptr jpeg) {
    constexpr int most_scans = 100;
    JpegReader& self = of(jpeg);
    if (self.jpeg_.input_scan_number <= most_scans) return;
    std::snprintf(self.reason_, sizeof self.reason_, "more than %d scans", most_scans);
    std::longjmp(self.at_error_, 1);
  }

  [[noreturn]] void refuse() const { detail::fail_reading(input_.name, reason_); }

  bool read_header() {
    if (setjmp(at_error_) != 0) return false;
    jpeg_create_decompress(&jpeg_);
    jpeg_.progress = &progress_;
    progress_.progress_monitor = count_scans;
    jpeg_stdio_src(&jpeg_, input_.stream.get());
    jpeg_read_header(&jpeg_, TRUE);
    return true;
  }

  bool read_pixels(std::uint8_t* pixels) {
    if (setjmp(at_error_) != 0) return false;
    jpeg_.out_color_space = JCS_RGB;
    jpeg_start_decompress(&jpeg_);
    while (jpeg_.output_scanline < jpeg_.output_height) {
      JSAMPROW row = pixels + std::size_t{3} * jpeg_.output_width * jpeg_.output_scanline;
      jpeg_read_scanlines(&jpeg_, &row, 1);
    }
    jpeg_finish_decompress(&jpeg_);
    return true;
  }

  detail::Input8 input_;
  jpeg_decompress_struct jpeg_{};
  jpeg_error_mgr errors_{};
  jpeg_progress_mgr progress_{};
  std::jmp_buf at_error_{};
  char reason_[JMSG_LENGTH_MAX] = {};
};

}  // namespace

Image8 detail::read_jpeg(Input8 input) {
  JpegReader jpeg(std::move(input));
  return {jpeg.width(), jpeg.height(), jpeg.rgb()};
}

ImageInfo detail::read_jpeg_info(Input8 input) {
  const JpegReader jpeg(std::move(input));
  return {jpeg.width(), jpeg.height(), jpeg.channels(), {}};
}

}  // namespace raylab
