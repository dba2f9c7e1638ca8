#include <cmath>
#include <limits>

#include "catch.hpp"
#include "expect_error.hpp"
#include "file_size_limit.hpp"
#include "image_png_bytes.hpp"
#include "raylab/image/image_file.hpp"
#include "temp_folder.hpp"

using namespace raylab;
using namespace raylab::test;
namespace fs = std::filesystem;

namespace {

using Bytes = std::vector<std::uint8_t>;

}  // namespace

TEST_CASE("the sRGB curve has its known values", "[unit][image]") {
  CHECK(linear_to_srgb(0.0f) == 0.0f);
  CHECK(linear_to_srgb(1.0f) == 1.0f);
  CHECK(linear_to_srgb(0.5f) == Approx(0.7353569831).epsilon(1e-6));
  CHECK(linear_to_srgb(0.18f) == Approx(0.4613561295).epsilon(1e-6));
  CHECK(linear_to_srgb(0.001f) == Approx(0.01292).epsilon(1e-6));
  CHECK(srgb_to_linear(0.0f) == 0.0f);
  CHECK(srgb_to_linear(1.0f) == 1.0f);
  CHECK(srgb_to_linear(0.5f) == Approx(0.2140411405).epsilon(1e-6));
  CHECK(srgb_to_linear(0.04f) == Approx(0.04 / 12.92).epsilon(1e-6));
}

TEST_CASE("the sRGB curve clamps, and NaN is black", "[unit][image]") {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  for (const auto& curve : {linear_to_srgb, srgb_to_linear}) {
    CHECK(curve(-0.1f) == 0.0f);
    CHECK(curve(-kInf) == 0.0f);
    CHECK(curve(1.1f) == 1.0f);
    CHECK(curve(kInf) == 1.0f);
    CHECK(curve(std::nanf("")) == 0.0f);
  }
}

TEST_CASE("the sRGB curves rise and undo each other", "[unit][image]") {
  float previous = -1.0f;
  for (int i = 0; i <= 10000; ++i) {
    const float linear = static_cast<float>(i) / 10000.0f;
    const float encoded = linear_to_srgb(linear);
    REQUIRE(encoded > previous);
    REQUIRE(srgb_to_linear(encoded) == Approx(linear).epsilon(1e-5).margin(1e-7));
    previous = encoded;
  }
}

TEST_CASE("every value of an 8-bit PNG survives decoding and encoding", "[unit][image]") {
  const TempFolder folder;
  std::string samples;
  for (int i = 0; i < 256; ++i) samples += static_cast<char>(i);
  write_text(folder / "in.png", png_row(256, 8, PngColour::grey, samples));
  const Image image = read_image(folder / "in.png");
  REQUIRE(image.width == 256);
  CHECK(image.at(128, 0).g == Approx(0.2158605).epsilon(1e-5));
  write_png(folder / "out.png", image);
  const Image8 back = read_image8(folder / "out.png");
  REQUIRE(back.rgb.size() == 256 * 3);
  for (std::size_t i = 0; i < back.rgb.size(); ++i) REQUIRE(back.rgb[i] == i / 3);
}

TEST_CASE("a written PNG is rounded to nearest, row by row from the top", "[unit][image]") {
  const TempFolder folder;
  const auto encoded = [](double value) { return srgb_to_linear(static_cast<float>(value / 255.0)); };
  Image image(2, 2);
  image.pixels = {Rgb(encoded(10.4), encoded(10.6), 2.0f), Rgb(-1.0f, std::nanf(""), 0.0f), Rgb(1.0f),
                  Rgb(encoded(7.0))};
  write_image(folder / "a.PNG", image, {}, {{"seed", "7"}});
  const Image8 back = read_image8(folder / "a.PNG");
  CHECK(back.width == 2);
  CHECK(back.height == 2);
  CHECK(back.rgb == Bytes{10, 11, 255, 0, 0, 0, 255, 255, 255, 7, 7, 7});
  CHECK(folder.entries() == 1);
}

TEST_CASE("a written PNG says that its values are sRGB and what program wrote it", "[unit][image]") {
  const TempFolder folder;
  write_png(folder / "a.png", Image(3, 2));
  const std::string bytes = read_text(folder / "a.png");
  CHECK(bytes.find("sRGB") != std::string::npos);
  // After the header: the length of the text, its kind, and at its end the checksum.
  const std::string text = std::string("Software") + '\0' + "Raylab " RAYLAB_VERSION;
  CHECK(bytes.substr(33, text.size() + 12) == test::detail::png_chunk("tEXt", text));
  CHECK(read_image8(folder / "a.png").width == 3);
}

TEST_CASE("PNG files of every kind are widened to RGB", "[unit][image]") {
  const TempFolder folder;
  struct Case {
    const char* name;
    std::string bytes;
    Bytes rgb;
    std::vector<std::string> channels;
  };
  const std::vector<Case> cases{
      {"grey", png_row(2, 8, PngColour::grey, "\x10\xf0"), {16, 16, 16, 240, 240, 240}, {"Y 8-bit"}},
      {"grey, 1 bit", png_row(2, 1, PngColour::grey, "\x40"), {0, 0, 0, 255, 255, 255}, {"Y 8-bit"}},
      {"grey, 16 bits", png_row(1, 16, PngColour::grey, "\x12\x34"), {18, 18, 18}, {"Y 16-bit"}},
      {"grey and alpha", png_row(1, 8, PngColour::grey_alpha, "\x10\x20"), {16, 16, 16}, {"Y 8-bit", "A 8-bit"}},
      {"RGB, 16 bits",
       png_row(1, 16, PngColour::rgb, "\x01\x02\x03\x04\x05\x06"),
       {1, 3, 5},
       {"R 16-bit", "G 16-bit", "B 16-bit"}},
      {"RGB and alpha",
       png_row(1, 8, PngColour::rgb_alpha, "\x01\x02\x03\x04"),
       {1, 2, 3},
       {"R 8-bit", "G 8-bit", "B 8-bit", "A 8-bit"}},
      {"palette",
       png_row(2, 8, PngColour::palette, std::string("\x01\x00", 2), "\x01\x02\x03\x04\x05\x06"),
       {4, 5, 6, 1, 2, 3},
       {"R 8-bit", "G 8-bit", "B 8-bit"}},
  };
  for (const Case& c : cases) {
    INFO(c.name);
    write_text(folder / "a.png", c.bytes);
    CHECK(read_image8(folder / "a.png").rgb == c.rgb);
    const ImageInfo info = read_image_info(folder / "a.png");
    CHECK(info.channels == c.channels);
    CHECK(info.width * 3 == static_cast<int>(c.rgb.size()));
    CHECK(info.height == 1);
    CHECK(info.attributes.empty());
  }
}

TEST_CASE("what is no picture is refused", "[unit][image]") {
  const TempFolder folder;
  const auto expect = [](const fs::path& file, const char* part) {
    expect_error(ErrorKind::input, file.string(), {part}, [&] { read_image8(file); });
    expect_error(ErrorKind::input, file.string(), {part}, [&] { read_image(file); });
    expect_error(ErrorKind::input, file.string(), {part}, [&] { read_image_info(file); });
  };
  expect(folder / "missing.png", "No such file");
  expect(folder.path(), "Is a directory");
  write_text(folder / "empty.png", "");
  expect(folder / "empty.png", "not readable as a picture");
  write_text(folder / "text.png", "hello, this is text");
  expect(folder / "text.png", "not readable as a picture");
  write_text(folder / "radiance.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\nabcd");
  expect(folder / "radiance.hdr", "not readable as a picture");
  const std::string whole = png_row(2, 8, PngColour::rgb, "abcdef");
  write_text(folder / "part.png", whole.substr(0, whole.size() - 20));
  expect_error(ErrorKind::input, (folder / "part.png").string(), {"not readable as a picture"},
               [&] { read_image8(folder / "part.png"); });
}

TEST_CASE("a picture's format is told by its content where its ending does not say", "[unit][image]") {
  const TempFolder folder;
  Image image(1, 1);
  image.pixels[0] = Rgb(20.0f);
  write_exr(folder / "a.exr", image);
  fs::rename(folder / "a.exr", folder / "picture");
  CHECK(read_image(folder / "picture").pixels[0] == Rgb(20.0f));
  write_text(folder / "b.exr", png_row(1, 8, PngColour::grey, "x"));
  expect_error(ErrorKind::input, (folder / "b.exr").string(), {"not an OpenEXR file"},
               [&] { read_image(folder / "b.exr"); });
}

TEST_CASE("a picture's name is refused before anything is written", "[unit][image]") {
  const TempFolder folder;
  for (const char* name : {"a.jpg", "a", ".png", "exr", "a.exr.gz", ""}) {
    const fs::path file = folder / name;
    INFO(file);
    expect_error(ErrorKind::usage, file.string(), {"expected .exr or .png"}, [&] { check_writable_image(file); });
    expect_error(ErrorKind::usage, file.string(), {"expected .exr or .png"}, [&] { write_image(file, Image(1, 1)); });
  }
  fs::create_directory(folder / "folder.png");
  for (const char* name : {"missing/a.png", "folder.png", "missing/a.exr"}) {
    const fs::path file = folder / name;
    expect_error(ErrorKind::output, file.string(), {"cannot be written"}, [&] { check_writable_image(file); });
    expect_error(ErrorKind::output, file.string(), {"cannot be written"}, [&] { write_image(file, Image(1, 1)); });
  }
  check_writable_image(folder / "a.png");
  check_writable_image(folder / "a.Exr");
  CHECK(folder.entries() == 1);
}

TEST_CASE("a PNG file that cannot be written leaves the old one", "[unit][image]") {
  const TempFolder folder;
  const fs::path file = folder / "a.png";
  write_text(file, "old");
  {
    const FileSizeLimit limit(10);
    expect_error(ErrorKind::output, file.string(), {"File too large"}, [&] { write_png(file, Image(1, 1)); });
  }
  CHECK(read_text(file) == "old");
  CHECK(folder.entries() == 1);
}
