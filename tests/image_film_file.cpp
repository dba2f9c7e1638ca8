#include <algorithm>
#include <random>

#include "catch.hpp"
#include "expect_error.hpp"
#include "raylab/image/film_file.hpp"
#include "temp_folder.hpp"

using namespace raylab;
using namespace raylab::test;
namespace fs = std::filesystem;

namespace {

constexpr int kWidth = 7, kHeight = 37;  // more than the rows that are written at a time

Film random_film(unsigned seed, int samples = 2000) {
  std::mt19937 random(seed);
  std::lognormal_distribution<float> radiance(0.0f, 3.0f);
  Film film(kWidth, kHeight);
  for (int i = 0; i < samples; ++i) {
    const int x = static_cast<int>(random() % kWidth), y = static_cast<int>(random() % kHeight);
    if (i % 50 == 0) {
      film.drop(x, y, 1);
    } else {
      film.add(x, y, Rgb(radiance(random), radiance(random), radiance(random)));
    }
  }
  return film;
}

FilmPicture picture_of(const Film& film) {
  FilmPicture picture;
  picture.width = film.width();
  picture.height = film.height();
  picture.rows = [&film](int first, int count) { return film.rows(first, count); };
  picture.attributes = {{"seed", "7"}};
  picture.film = FilmInfo{{{"scene", "a"}, {"seed", "7"}}, {{3, 100}, {200, 300}}, 400, kWidth * kHeight, 0.1};
  return picture;
}

Film read_film(const fs::path& file) {
  FilmFile opened(file);
  Film film(opened.width(), opened.height());
  opened.add_to(film);
  return film;
}

void expect_refused(const fs::path& file, std::initializer_list<const char*> parts) {
  expect_error(ErrorKind::input, file.string(), parts, [&] { read_film(file); });
}

}  // namespace

TEST_CASE("a film file holds the film to the bit, and any reader sees its picture", "[unit][image]") {
  const TempFolder folder;
  const Film film = random_film(1);
  write_film_picture(folder / "a.exr", picture_of(film));
  FilmFile file(folder / "a.exr");
  CHECK(file.info() == *picture_of(film).film);
  CHECK(file.attributes() == Attributes{{"seed", "7"}});
  Film twice(kWidth, kHeight);
  const SampleRange taken = file.add_to(twice);
  CHECK(twice == film);
  CHECK(taken.first >= 1);
  CHECK(taken.end < 30);
  file.add_to(twice);
  Film expected = film;
  expected.add(film);
  CHECK(twice == expected);
  CHECK(FilmFile::is_one(folder / "a.exr"));

  FilmPicture plain = picture_of(film);
  plain.film.reset();
  write_film_picture(folder / "b.exr", plain);
  CHECK(read_exr(folder / "a.exr").pixels == read_exr(folder / "b.exr").pixels);
  CHECK(read_image_info(folder / "a.exr").channels == read_image_info(folder / "b.exr").channels);
  CHECK_FALSE(FilmFile::is_one(folder / "b.exr"));
  expect_refused(folder / "b.exr", {"is a picture without a film"});
}

TEST_CASE("a film file says of how many samples its pixels are, those without any too", "[unit][image]") {
  const TempFolder folder;
  Film film(2, 2);
  for (int i = 0; i < 3; ++i) film.add(0, 0, Rgb(1.0f));
  film.drop(1, 1, 5);
  FilmPicture picture = picture_of(film);
  const auto taken = [&](std::uint64_t pixels) {
    picture.film->pixels = pixels;
    write_film_picture(folder / "a.exr", picture);
    Film back(2, 2);
    return FilmFile(folder / "a.exr").add_to(back);
  };
  CHECK(taken(2) == SampleRange{3, 5});  // of a crop
  CHECK(taken(4) == SampleRange{0, 5});
}

TEST_CASE("a picture written by rows is that of the whole film, in every format", "[unit][image]") {
  const TempFolder folder;
  const Film film = random_film(2);
  FilmPicture picture = picture_of(film);
  picture.film.reset();
  picture.variance = picture.samples = true;
  picture.layers = {{"Z", true, std::vector<float>(kWidth * kHeight, 2.5f)}};
  std::vector<Layer> layers = picture.layers;
  for (int c = 0; c < 3; ++c) {
    layers.push_back({std::string("variance.") + "RGB"[c], true, {}});
    for (int i = 0; i < kWidth * kHeight; ++i) {
      layers.back().values.push_back(static_cast<float>(film.variance_of_mean(i % kWidth, i / kWidth)[c]));
    }
  }
  layers.push_back({"sampleCount", true, {}});
  for (int i = 0; i < kWidth * kHeight; ++i) {
    layers.back().values.push_back(static_cast<float>(film.samples(i % kWidth, i / kWidth)));
  }
  write_film_picture(folder / "rows.exr", picture);
  write_exr(folder / "whole.exr", film.image(), layers, picture.attributes);
  CHECK(read_text(folder / "rows.exr") == read_text(folder / "whole.exr"));
  write_film_picture(folder / "rows.png", picture);
  write_png(folder / "whole.png", film.image());
  CHECK(read_text(folder / "rows.png") == read_text(folder / "whole.png"));
  CHECK_FALSE(fs::exists(folder / "rows.jpg"));
  CHECK_THROWS_AS(write_film_picture(folder / "rows.jpg", picture), Error);
}

TEST_CASE("a picture is written in float where it is asked for, and what half loses is found", "[unit][image]") {
  const TempFolder folder;
  const auto film_of = [](float value) {
    Film film(2, 1);
    film.add(0, 0, Rgb(value, 0.0f, 1.0f));
    return film;
  };
  CHECK(fits_half(film_of(65504.0f)));
  CHECK_FALSE(fits_half(film_of(65536.0f)));
  CHECK(fits_half(film_of(1e-7f)));
  CHECK_FALSE(fits_half(film_of(1e-9f)));
  const Film bright = film_of(1e5f);
  FilmPicture picture = picture_of(bright);
  write_film_picture(folder / "half.exr", picture);
  CHECK(read_exr(folder / "half.exr").at(0, 0).r == 65504.0f);
  picture.as_float = true;
  write_film_picture(folder / "float.exr", picture);
  CHECK(read_exr(folder / "float.exr").at(0, 0).r == 1e5f);
  CHECK(read_image_info(folder / "float.exr").channels.front() == "A float");
}

TEST_CASE("a film of an earlier format is refused with its version", "[unit][image]") {
  expect_refused(RAYLAB_SOURCE_DIR "/tests/fuzz/seeds/exr/film-1.exr",
                 {"its film is of format version 1, and this program reads 2"});
}

TEST_CASE("damage to a film file is found wherever it is, with its place", "[unit][image]") {
  const TempFolder folder;
  const fs::path file = folder / "a.exr";
  write_film_picture(file, picture_of(random_film(3)));
  const std::string whole = read_text(file);
  const auto damaged = [&](std::size_t at, char change) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ change);
    write_text(file, bytes);
  };
  // The last row of the film is the end of the file: 28 words and a check of its 7 pixels each.
  for (std::size_t word = 0; word < 27; ++word) {
    damaged(whole.size() - 1 - 28 * word - 4 * 2, 1 << (word % 8));
    expect_refused(file, {"its film is damaged at pixel 4, 36"});
  }
  for (const char* text : {"400", "3:100 200:300", "0000"}) {
    damaged(whole.find(text), 1);
    expect_refused(file, {});
  }
  // Of every byte of the header and the tables, none is believed: it is refused, or does not matter.
  const Film film = random_film(3);
  int refused = 0;
  for (std::size_t at = 8; at < 5000; ++at) {
    damaged(at, static_cast<char>(1 << (at % 8)));
    try {
      const Film read = read_film(file);
      CHECK(read == film);
    } catch (const Error& e) {
      refused += e.kind() == ErrorKind::input;
    }
  }
  CHECK(refused > 1500);
  for (const std::size_t size : {whole.size() - 1, whole.size() / 2, std::size_t{3000}, std::size_t{100}}) {
    write_text(file, whole.substr(0, size));
    expect_refused(file, {});
  }
  expect_refused(folder / "missing.exr", {"cannot be read"});
}
