// Pictures that are damaged, or that ask for what they cannot fill, are refused before memory is asked for.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfStdIO.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTileDescription.h>

#include <cstddef>
#include <cstdio>
// After the headers that it needs and does not include.
#include <jpeglib.h>
#include <sys/resource.h>

#include <cstdlib>
#include <fstream>

#include "catch.hpp"
#include "expect_error.hpp"
#include "image_png_bytes.hpp"
#include "raylab/image/image_file.hpp"
#include "temp_folder.hpp"

using namespace raylab;
using namespace raylab::test;
namespace fs = std::filesystem;

namespace {

#ifdef RAYLAB_SANITIZED
constexpr bool kLimitsMemory = false;  // the sanitizers' own memory would count
#else
constexpr bool kLimitsMemory = true;
#endif

/// Within its life, the process can take no more than that much memory beyond what it has.
class MemoryLimit {
 public:
  explicit MemoryLimit(rlim_t bytes) {
    getrlimit(RLIMIT_AS, &old_);
    if (!kLimitsMemory) return;
    std::ifstream pages("/proc/self/statm");
    rlim_t used = 0;
    pages >> used;
    const rlimit limit{used * 4096 + bytes, old_.rlim_max};
    setrlimit(RLIMIT_AS, &limit);
  }
  ~MemoryLimit() { setrlimit(RLIMIT_AS, &old_); }
  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;

 private:
  rlimit old_{};
};

void expect_refused(const fs::path& file, const std::string& bytes, std::initializer_list<const char*> parts) {
  write_text(file, bytes);
  const MemoryLimit limit(200 << 20);
  expect_error(ErrorKind::input, file.string(), parts, [&] { read_image(file); });
}

std::string png_header(std::uint32_t width, std::uint32_t height, char bits, char colour) {
  using detail::big_endian;
  return "\x89PNG\r\n\x1a\n" +
         detail::png_chunk("IHDR", big_endian(width) + big_endian(height) + std::string{bits, colour, 0, 0, 0});
}

void write_jpeg(const fs::path& file, int width, int height, bool progressive, bool grey = false) {
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  std::FILE* out = std::fopen(file.c_str(), "wb");
  REQUIRE(out != nullptr);
  jpeg_stdio_dest(&jpeg, out);
  jpeg.image_width = static_cast<JDIMENSION>(width);
  jpeg.image_height = static_cast<JDIMENSION>(height);
  jpeg.input_components = grey ? 1 : 3;
  jpeg.in_color_space = grey ? JCS_GRAYSCALE : JCS_RGB;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, 100, TRUE);
  if (progressive) jpeg_simple_progression(&jpeg);
  jpeg_start_compress(&jpeg, TRUE);
  std::vector<JSAMPLE> samples;
  for (int x = 0; x < width; ++x) samples.insert(samples.end(), {200, 100, 50});
  if (grey) samples.assign(samples.size(), 77);
  JSAMPROW row = samples.data();
  for (int y = 0; y < height; ++y) jpeg_write_scanlines(&jpeg, &row, 1);
  jpeg_finish_compress(&jpeg);
  jpeg_destroy_compress(&jpeg);
  std::fclose(out);
}

/// An EXR file of nothing but a header, with room for its table of chunks.
std::string exr_header(Imf::Header header) {
  for (const char* name : {"R", "G", "B"}) header.channels().insert(name, Imf::Channel(Imf::HALF));
  Imf::StdOSStream stream;
  header.writeTo(stream);
  return std::string("\x76\x2f\x31\x01\x02\x00\x00\x00", 8) + stream.str() + std::string(64, '\0');
}

}  // namespace

TEST_CASE("every checksum of a PNG file is checked", "[unit][image]") {
  const TempFolder folder;
  using detail::png_chunk;
  const std::string text = png_chunk("tEXt", std::string("Title\0x", 7));
  const std::string data = detail::zlib_stored(std::string("\0abc", 4));
  const std::string start = png_header(1, 1, 8, 2);
  const auto damaged = [](std::string bytes, std::size_t from_end) {
    bytes[bytes.size() - from_end] ^= 1;
    return bytes;
  };
  const std::string end = png_chunk("IEND", "");
  write_text(folder / "a.png", start + text + png_chunk("IDAT", data) + end);
  CHECK(read_image8(folder / "a.png").rgb == std::vector<std::uint8_t>{'a', 'b', 'c'});
  expect_refused(folder / "a.png", damaged(start, 1) + png_chunk("IDAT", data) + end, {"not readable", "IHDR", "CRC"});
  expect_refused(folder / "a.png", start + damaged(text, 1) + png_chunk("IDAT", data) + end, {"tEXt", "CRC"});
  expect_refused(folder / "a.png", start + damaged(png_chunk("IDAT", data), 1) + end, {"IDAT", "CRC"});
  expect_refused(folder / "a.png", start + png_chunk("IDAT", damaged(data, 1)) + end, {"IDAT"});
  expect_refused(folder / "a.png", start + png_chunk("IDAT", data), {"not readable"});
}

TEST_CASE("a PNG file with transparent colours is widened to RGB", "[unit][image]") {
  const TempFolder folder;
  using detail::png_chunk;
  write_text(folder / "a.png", png_header(2, 1, 8, 3) + png_chunk("PLTE", "abcdef") + png_chunk("tRNS", "\x10") +
                                   png_chunk("IDAT", detail::zlib_stored(std::string("\0\1\0", 3))) +
                                   png_chunk("IEND", ""));
  CHECK(read_image8(folder / "a.png").rgb == std::vector<std::uint8_t>{'d', 'e', 'f', 'a', 'b', 'c'});
  CHECK(read_image_info(folder / "a.png").channels ==
        std::vector<std::string>{"R 8-bit", "G 8-bit", "B 8-bit", "A 8-bit"});
}

TEST_CASE("JPEG files are read, grey, in colour and progressive", "[unit][image]") {
  const TempFolder folder;
  for (const bool progressive : {false, true}) {
    write_jpeg(folder / "a.jpg", 19, 10, progressive);
    const Image8 image = read_image8(folder / "a.jpg");
    CHECK(image.width == 19);
    CHECK(image.height == 10);
    REQUIRE(image.rgb.size() == 19 * 10 * 3);
    for (std::size_t i = 0; i < image.rgb.size(); ++i) REQUIRE(std::abs(image.rgb[i] - (200 >> (i % 3))) <= 1);
    CHECK(read_image_info(folder / "a.jpg").channels == std::vector<std::string>{"R 8-bit", "G 8-bit", "B 8-bit"});
    write_jpeg(folder / "grey.jpg", 3, 2, progressive, true);
    CHECK(read_image8(folder / "grey.jpg").rgb == std::vector<std::uint8_t>(18, 77));
    CHECK(read_image_info(folder / "grey.jpg").channels == std::vector<std::string>{"Y 8-bit"});
  }
}

TEST_CASE("a damaged JPEG file is refused", "[unit][image]") {
  const TempFolder folder;
  write_jpeg(folder / "whole.jpg", 40, 30, false);
  const std::string whole = read_text(folder / "whole.jpg");
  for (std::size_t size = 0; size < whole.size(); size += 1 + size / 16) {
    INFO(size << " of " << whole.size() << " bytes");
    expect_refused(folder / "a.jpg", whole.substr(0, size), {"not readable as a picture"});
  }
  // A Huffman table of 16 x 17 codes.
  expect_refused(folder / "a.jpg",
                 "\xff\xd8\xff\xc4\x01\x23" + std::string(1, '\0') + std::string(16, '\x11') + std::string(272, 'x'),
                 {"not readable as a picture", "Huffman"});
  // Scans that go over the picture again and again.
  write_jpeg(folder / "progressive.jpg", 40, 30, true);
  std::string scans = read_text(folder / "progressive.jpg");
  const std::size_t last = scans.rfind("\xff\xda");
  const std::string scan = scans.substr(last, scans.size() - 2 - last);
  std::string many = scans.substr(0, last);
  for (int i = 0; i < 200; ++i) many += scan;
  expect_refused(folder / "a.jpg", many + "\xff\xd9", {"not readable as a picture"});
}

TEST_CASE("a picture whose header asks for more than its file can hold is refused by its budget", "[unit][image]") {
  const TempFolder folder;
  const std::string pixels = detail::png_chunk("IDAT", detail::zlib_stored("abc"));
  expect_refused(folder / "a.png", png_header(16384, 16384, 8, 2) + pixels, {"16384 x 16384", "budget is 64 MiB"});
  expect_refused(folder / "a.png", png_header(0x7fffffff, 0x7fffffff, 8, 2) + pixels, {"not "});
  write_jpeg(folder / "a.jpg", 8, 8, false);
  std::string jpeg = read_text(folder / "a.jpg");
  jpeg.replace(jpeg.find("\xff\xc0") + 5, 4, "\xff\xdc\xff\xdc");
  expect_refused(folder / "a.jpg", jpeg, {"65500 x 65500", "budget is"});
  const auto window = [](int x0, int y0, int x1, int y1) {
    return Imath::Box2i(Imath::V2i(x0, y0), Imath::V2i(x1, y1));
  };
  const Imath::Box2i small = window(0, 0, 3, 3);
  for (const Imath::Box2i& large :
       {window(0, 0, 16383, 16383), window(-2, 5, 1 << 27, 5), window(3, -1000000000, 3, 1000000000)}) {
    expect_refused(folder / "a.exr", exr_header(Imf::Header(large, large)), {"budget is 64 MiB"});
    expect_refused(folder / "a.exr", exr_header(Imf::Header(small, large)), {"budget is 64 MiB"});
    expect_refused(folder / "a.exr", exr_header(Imf::Header(large, small)), {"budget is 64 MiB"});
  }
  Imf::Header wide(1 << 20, 1);
  wide.compression() = Imf::DWAB_COMPRESSION;
  expect_refused(folder / "a.exr", exr_header(wide), {"256 lines of 1048576 pixels of 6 bytes", "budget of 64 MiB"});
  Imf::Header tiled(4, 4);
  tiled.setTileDescription(Imf::TileDescription(1 << 14, 1 << 14));
  std::string bytes = exr_header(tiled);
  bytes[5] = 2;  // the flag of tiles
  expect_refused(folder / "a.exr", bytes, {"16384 lines of 16384 pixels", "budget of 64 MiB"});
}

TEST_CASE("an EXR file whose attributes reach beyond its end, or that is deep, is refused", "[unit][image]") {
  const TempFolder folder;
  Imf::Header header(4, 4);
  header.insert("note", Imf::StringAttribute("text"));
  std::string bytes = exr_header(header);
  std::string endless = bytes;
  endless.replace(bytes.find("note") + 5 + 7, 4, "\xff\xff\xff\x7f");
  expect_refused(folder / "a.exr", endless, {"not readable as OpenEXR: the header is damaged"});
  expect_error(ErrorKind::input, (folder / "a.exr").string(), {"the header is damaged"},
               [&] { read_image_info(folder / "a.exr"); });
  // A window that is shorter than its type says leaves what follows to be read as something else.
  endless = bytes;
  endless.replace(bytes.find("box2i") + 6, 4, std::string("\x08\0\0\0", 4));
  expect_refused(folder / "a.exr", endless, {"the header is damaged"});
  endless = bytes;
  endless.replace(bytes.find("compression") + 24, 4, "name");
  expect_refused(folder / "a.exr", endless, {"the header is damaged: attribute compression"});
  bytes[5] = 8;
  expect_refused(folder / "a.exr", bytes, {"deep pictures are not supported"});
}

TEST_CASE("reading a picture takes no more than 1.5 times its pixels in memory", "[unit][image]") {
  const TempFolder folder;
  Image image(2048, 2048);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = Rgb(static_cast<float>(i % 251) / 251.0f);
  write_png(folder / "a.png", image);
  write_exr(folder / "a.exr", image);
  write_jpeg(folder / "a.jpg", 2048, 2048, true);
  std::string cropped = read_text(folder / "a.exr");
  // One column less is shown; the name and its type, box2i, end in a zero, and the size takes four bytes.
  cropped[cropped.find("displayWindow") + 14 + 6 + 4 + 8] -= 1;
  write_text(folder / "cropped.exr", cropped);
  for (const char* name : {"a.png", "a.jpg", "a.exr", "cropped.exr"}) {
    INFO(name);
    const MemoryLimit limit(sizeof(Rgb) * image.pixels.size() * 3 / 2);
    CHECK(read_image(folder / name).width >= 2047);
  }
}
