#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfTileDescription.h>
#include <OpenEXR/ImfTiledOutputFile.h>

#include <cmath>
#include <limits>
#include <random>

#include "catch.hpp"
#include "expect_error.hpp"
#include "file_size_limit.hpp"
#include "raylab/image/image_file.hpp"
#include "temp_folder.hpp"

using namespace raylab;
using namespace raylab::test;
namespace fs = std::filesystem;
using Imath::Box2i;
using Imath::V2i;

namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

/// Its values are small integers: half holds them exactly.
Image numbered(int width, int height) {
  Image image(width, height);
  for (int i = 0; i < width * height; ++i) image.pixels[static_cast<std::size_t>(i)] = Rgb(i, i + 0.5f, -i);
  return image;
}

/// Adds float slices for the named channels, which all take their values from the picture's: R, G, B in turn.
Imf::FrameBuffer float_buffer(Imf::Header& header, const Image& image, const std::vector<std::string>& channels) {
  Imf::FrameBuffer buffer;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    header.channels().insert(channels[c], Imf::Channel(Imf::FLOAT));
    auto* values = const_cast<float*>(&image.pixels[0][static_cast<int>(c % 3)]);
    buffer.insert(channels[c], Imf::Slice::Make(Imf::FLOAT, values, header.dataWindow(), sizeof(Rgb),
                                                sizeof(Rgb) * static_cast<std::size_t>(image.width)));
  }
  return buffer;
}

void write_float_exr(const fs::path& file, const Image& image, Imf::Header header,
                     const std::vector<std::string>& channels = {"R", "G", "B"}) {
  const Imf::FrameBuffer buffer = float_buffer(header, image, channels);
  Imf::OutputFile output(file.c_str(), header);
  output.setFrameBuffer(buffer);
  output.writePixels(image.height);
}

std::vector<float> read_channel(const fs::path& file, const char* name) {
  Imf::InputFile input(file.c_str());
  const Box2i window = input.header().dataWindow();
  const auto width = static_cast<std::size_t>(window.max.x - window.min.x + 1);
  std::vector<float> values(width * static_cast<std::size_t>(window.max.y - window.min.y + 1));
  Imf::FrameBuffer buffer;
  buffer.insert(name, Imf::Slice::Make(Imf::FLOAT, values.data(), window, sizeof(float), sizeof(float) * width));
  input.setFrameBuffer(buffer);
  input.readPixels(window.min.y, window.max.y);
  return values;
}

void expect_unreadable(const fs::path& file, std::initializer_list<const char*> parts) {
  expect_error(ErrorKind::input, file.string(), parts, [&] { read_exr(file); });
}

}  // namespace

TEST_CASE("an EXR file gives back what half can hold", "[unit][image]") {
  const TempFolder folder;
  const Image image = numbered(5, 3);
  write_exr(folder / "a.exr", image);
  const Image back = read_exr(folder / "a.exr");
  CHECK(back.width == 5);
  CHECK(back.height == 3);
  CHECK(back.pixels == image.pixels);
  CHECK(read_channel(folder / "a.exr", "A") == std::vector<float>(15, 1.0f));
  CHECK(folder.entries() == 1);
}

TEST_CASE("an EXR file is within half a unit of half's last place", "[unit][image]") {
  const TempFolder folder;
  std::mt19937 random(2);
  std::uniform_real_distribution<float> mantissa(1.0f, 2.0f);
  Image image(64, 16);
  for (auto& pixel : image.pixels) {
    for (int c = 0; c < 3; ++c) pixel[c] = std::ldexp(mantissa(random), static_cast<int>(random() % 28) - 14);
  }
  write_exr(folder / "a.exr", image);
  const Image back = read_exr(folder / "a.exr");
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      REQUIRE(std::abs(back.pixels[i][c] - image.pixels[i][c]) <= std::abs(image.pixels[i][c]) * 0x1p-11f);
    }
  }
}

TEST_CASE("values beyond half's range are clamped to it, and NaN stays", "[unit][image]") {
  const TempFolder folder;
  Image image(2, 1);
  image.pixels = {Rgb(1e30f, -1e30f, kInf), Rgb(65519.0f, 65521.0f, std::nanf(""))};
  Layer layer{"Z", false, {1e10f, -kInf}};
  write_exr(folder / "a.exr", image, {layer});
  const Image back = read_exr(folder / "a.exr");
  CHECK(back.pixels[0] == Rgb(65504.0f, -65504.0f, 65504.0f));
  CHECK(back.pixels[1].r == 65504.0f);
  CHECK(back.pixels[1].g == 65504.0f);
  CHECK(std::isnan(back.pixels[1].b));
  CHECK(read_channel(folder / "a.exr", "Z") == std::vector<float>{65504.0f, -65504.0f});
}

TEST_CASE("layers keep their values, floats to the bit", "[unit][image]") {
  const TempFolder folder;
  const std::vector<float> depths{0.1f, 1e30f, kInf, 1e-30f, -7.0f, 123456.789f};
  const std::vector<float> halves{0.25f, 1.0f, 2.0f, 3.0f, 4.0f, 5.0f};
  write_exr(folder / "a.exr", numbered(3, 2),
            {{"Z", true, depths}, {"albedo.R", false, halves}, {"sampleCount", true, halves}});
  CHECK(read_channel(folder / "a.exr", "Z") == depths);
  CHECK(read_channel(folder / "a.exr", "albedo.R") == halves);
  CHECK(read_exr(folder / "a.exr").pixels == numbered(3, 2).pixels);
  const ImageInfo info = read_image_info(folder / "a.exr");
  CHECK(info.width == 3);
  CHECK(info.height == 2);
  CHECK(info.channels == std::vector<std::string>{"A half", "B half", "G half", "R half", "Z float", "albedo.R half",
                                                  "sampleCount float"});
}

TEST_CASE("attributes come back as they were", "[unit][image]") {
  const TempFolder folder;
  const Attributes attributes{{"seed", "7"},
                              {"commandLine", "a \"b\" ü\nc"},
                              {"empty", ""},
                              {"aNameOfMoreThanThirtyOneCharacters", std::string(5000, 'x')}};
  write_image(folder / "a.EXR", numbered(2, 2), {}, attributes);
  CHECK(read_exr_attributes(folder / "a.EXR") == attributes);
  CHECK(read_image_info(folder / "a.EXR").attributes == attributes);
}

TEST_CASE("float and tiled EXR files are read, other channels left aside", "[unit][image]") {
  const TempFolder folder;
  Image image(40, 23);
  std::mt19937 random(4);
  for (auto& pixel : image.pixels) pixel = Rgb{float(random()), random() * 1e-20f, random() * 1e20f};
  write_float_exr(folder / "float.exr", image, Imf::Header(40, 23), {"R", "G", "B", "N.X", "diffuse.R"});
  CHECK(read_exr(folder / "float.exr").pixels == image.pixels);

  Imf::Header header(40, 23);
  header.setTileDescription(Imf::TileDescription(16, 16, Imf::ONE_LEVEL));
  const Imf::FrameBuffer buffer = float_buffer(header, image, {"R", "G", "B"});
  {
    Imf::TiledOutputFile output((folder / "tiled.exr").c_str(), header);
    output.setFrameBuffer(buffer);
    output.writeTiles(0, output.numXTiles() - 1, 0, output.numYTiles() - 1);
  }
  CHECK(read_exr(folder / "tiled.exr").pixels == image.pixels);
}

TEST_CASE("an EXR picture is what its display window shows", "[unit][image]") {
  const TempFolder folder;
  const fs::path file = folder / "a.exr";
  const Image data = numbered(3, 2);
  const auto window = [](int x0, int y0, int x1, int y1) { return Box2i(V2i(x0, y0), V2i(x1, y1)); };

  SECTION("black around a smaller data window") {
    write_float_exr(file, data, Imf::Header(window(-1, -1, 3, 2), window(0, 1, 2, 2)));
    const Image image = read_exr(file);
    REQUIRE(image.width == 5);
    REQUIRE(image.height == 4);
    for (int y = 0; y < 4; ++y) {
      for (int x = 0; x < 5; ++x) {
        const bool inside = x >= 1 && x <= 3 && y >= 2;
        CHECK(image.at(x, y) == (inside ? data.at(x - 1, y - 2) : Rgb(0.0f)));
      }
    }
  }
  SECTION("cut out of a larger one") {
    write_float_exr(file, data, Imf::Header(window(10, 10, 10, 11), window(9, 10, 11, 11)));
    const Image image = read_exr(file);
    REQUIRE(image.width == 1);
    REQUIRE(image.height == 2);
    CHECK(image.at(0, 0) == data.at(1, 0));
    CHECK(image.at(0, 1) == data.at(1, 1));
  }
  SECTION("black when they do not meet") {
    write_float_exr(file, data, Imf::Header(window(0, 0, 1, 1), window(100, 100, 102, 101)));
    CHECK(read_exr(file).pixels == std::vector<Rgb>(4));
  }
}

TEST_CASE("an EXR file without colours is refused, naming what is missing and what is there", "[unit][image]") {
  const TempFolder folder;
  write_float_exr(folder / "a.exr", numbered(2, 2), Imf::Header(2, 2), {"G", "Y"});
  expect_unreadable(folder / "a.exr", {"channel R B missing", "the file has G Y"});
}

TEST_CASE("what is not an EXR file is refused", "[unit][image]") {
  const TempFolder folder;
  expect_unreadable(folder / "missing.exr", {"No such file"});
  expect_unreadable(folder.path(), {"Is a directory"});
  write_text(folder / "empty.exr", "");
  expect_unreadable(folder / "empty.exr", {"not an OpenEXR file"});
  write_text(folder / "text.exr", "hello, this is text");
  expect_unreadable(folder / "text.exr", {"not an OpenEXR file"});
  expect_error(ErrorKind::input, (folder / "text.exr").string(), {"not an OpenEXR file"},
               [&] { read_exr_attributes(folder / "text.exr"); });
}

TEST_CASE("a truncated EXR file is refused wherever it ends", "[unit][image]") {
  const TempFolder folder;
  std::mt19937 random(9);
  Image image(20, 40);
  for (auto& pixel : image.pixels) pixel = Rgb(static_cast<float>(random() % 1000));
  write_exr(folder / "whole.exr", image);
  const std::string whole = read_text(folder / "whole.exr");
  const fs::path file = folder / "part.exr";
  for (std::size_t size = 0; size < whole.size(); size += 1 + size / 16) {
    write_text(file, whole.substr(0, size));
    INFO(size << " of " << whole.size() << " bytes");
    expect_unreadable(file, {});
  }
  write_text(file, whole.substr(0, whole.size() - 1));
  expect_unreadable(file, {"not readable as OpenEXR"});
}

TEST_CASE("an EXR file of absurd size is refused before its memory is asked for", "[unit][image]") {
  const TempFolder folder;
  write_exr(folder / "a.exr", numbered(2, 2));
  std::string bytes = read_text(folder / "a.exr");
  const std::string huge("\x00\x00\x00\x00\x00\x00\x00\x00\xff\xff\x0f\x00\xff\xff\x0f\x00", 16);
  for (const char* name : {"dataWindow", "displayWindow"}) {
    std::string changed = bytes;
    // The name, its type box2i, each ended by a zero, the size in four bytes, then the window.
    changed.replace(changed.find(name) + std::string(name).size() + 1 + 6 + 4, 16, huge);
    write_text(folder / "huge.exr", changed);
    expect_unreadable(folder / "huge.exr", {});
    if (name == std::string("displayWindow")) expect_unreadable(folder / "huge.exr", {"1048576 x 1048576"});
  }
}

TEST_CASE("an EXR file that cannot be written leaves the old one", "[unit][image]") {
  const TempFolder folder;
  const fs::path file = folder / "a.exr";
  write_text(file, "old");
  // The header has an attribute of this name and another type.
  expect_error(ErrorKind::output, file.string(), {"cannot be written"}, [&] {
    write_exr(file, numbered(2, 2), {}, {{"compression", "none"}});
  });
  CHECK(read_text(file) == "old");
  CHECK(folder.entries() == 1);
  expect_error(ErrorKind::output, (file / "b.exr").string(), {"Not a directory"},
               [&] { write_exr(file / "b.exr", numbered(2, 2)); });
  {
    const FileSizeLimit limit(100);
    expect_error(ErrorKind::output, file.string(), {"cannot be written"}, [&] { write_exr(file, numbered(9, 9)); });
  }
  CHECK(read_text(file) == "old");
  CHECK(folder.entries() == 1);
}
