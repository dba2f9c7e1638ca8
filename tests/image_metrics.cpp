#include <cmath>
#include <limits>
#include <random>

#include "catch.hpp"
#include "expect_error.hpp"
#include "raylab/image/metrics.hpp"

using namespace raylab;
using raylab::test::expect_error;

namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

Image grey_row(std::initializer_list<float> values) {
  Image image(static_cast<int>(values.size()), 1);
  std::size_t i = 0;
  for (const float value : values) image.pixels[i++] = Rgb(value);
  return image;
}

}  // namespace

TEST_CASE("a picture has no error against itself", "[unit][image]") {
  const Image image = grey_row({0.0f, 0.5f, 100.0f});
  const ImageError error = image_error(image, image);
  CHECK(error.relmse == 0.0);
  CHECK(error.relmse_trimmed == 0.0);
  CHECK(error.mse == 0.0);
  CHECK(error.mean_ratio == 1.0);
  CHECK(error.mean_ratio_error == 0.0);
  CHECK(error.different_pixels == 0);
}

TEST_CASE("image errors are those computed by hand", "[unit][image]") {
  Image image(2, 1);
  Image reference(2, 1);
  image.pixels = {Rgb(2.0f, 0.0f, 0.0f), Rgb(1.0f, 1.0f, 4.0f)};
  reference.pixels = {Rgb(1.0f, 0.0f, 0.0f), Rgb(1.0f, 2.0f, 2.0f)};
  const ImageError error = image_error(image, reference);
  CHECK(error.mse == Approx((1.0 + 1.0 + 4.0) / 6.0).epsilon(1e-12));
  CHECK(error.relmse == Approx((1.0 / 1.01 + 1.0 / 4.01 + 4.0 / 4.01) / 6.0).epsilon(1e-12));
  CHECK(error.relmse_trimmed == error.relmse);
  CHECK(error.different_pixels == 2);
  // Sums over channels: I = 2, 6 and R = 1, 5, so the ratio is 8/6 and the residuals are 2 - 4/3 and 6 - 20/3.
  CHECK(error.mean_ratio == Approx(4.0 / 3.0).epsilon(1e-12));
  const double variance_of_residuals = 2.0 * (2.0 / 3.0) * (2.0 / 3.0) / 1.0;
  CHECK(error.mean_ratio_error == Approx(std::sqrt(variance_of_residuals / 2.0) / 3.0).epsilon(1e-12));
}

TEST_CASE("the trimmed error leaves out one pixel of each whole thousand, the worst", "[unit][image]") {
  for (const int count : {999, 1000, 1999, 2000}) {
    Image reference(count, 1);
    Image image(count, 1);
    for (auto& pixel : image.pixels) pixel = Rgb(0.1f);
    image.at(count / 2, 0) = Rgb(10.0f);
    image.at(count - 1, 0) = Rgb(20.0f);
    const double dim = 0.1f * 0.1f / 0.01;
    const double kept = static_cast<double>(count - count / 1000);
    double expected = dim * (count - 2) + 100.0 / 0.01 + 400.0 / 0.01;
    if (count >= 1000) expected -= 400.0 / 0.01;
    if (count >= 2000) expected -= 100.0 / 0.01;
    INFO(count << " pixels");
    CHECK(image_error(image, reference).relmse_trimmed == Approx(expected / kept).epsilon(1e-6));
  }
}

TEST_CASE("the standard error of the mean ratio is the spread that repetition shows", "[statistical][image]") {
  std::mt19937 random(11);
  std::normal_distribution<float> noise(0.0f, 0.3f);
  Image reference(40, 25);
  for (std::size_t i = 0; i < reference.pixels.size(); ++i) {
    reference.pixels[i] = Rgb(1.0f + static_cast<float>(i % 7));
  }
  const int trials = 400;
  double sum = 0.0, squares = 0.0, claimed = 0.0;
  for (int trial = 0; trial < trials; ++trial) {
    Image image = reference;
    for (Rgb& pixel : image.pixels) pixel = Rgb(pixel.r * (1.02f + noise(random)));
    const ImageError error = image_error(image, reference);
    sum += error.mean_ratio;
    squares += error.mean_ratio * error.mean_ratio;
    claimed += error.mean_ratio_error;
  }
  const double mean = sum / trials;
  const double spread = std::sqrt(squares / trials - mean * mean);
  CHECK(mean == Approx(1.02).margin(4.0 * spread / std::sqrt(trials)));
  CHECK(claimed / trials == Approx(spread).epsilon(0.15));
}

TEST_CASE("a value that is not finite is an infinite error in either picture", "[unit][image]") {
  const Image good = grey_row({1.0f, 2.0f, 3.0f});
  for (const float bad : {kNaN, kInf, -kInf}) {
    Image broken = good;
    broken.at(1, 0).g = bad;
    for (const ImageError& error :
         {image_error(broken, good), image_error(good, broken), image_error(broken, broken)}) {
      CHECK(error.relmse == kInf);
      CHECK(error.relmse_trimmed == kInf);
      CHECK(error.mse == kInf);
      CHECK(std::isnan(error.mean_ratio));
      CHECK(error.mean_ratio_error == kInf);
    }
    CHECK(image_error(broken, good).different_pixels == 1);
    CHECK(image_error(broken, broken).different_pixels == 0);
  }
}

TEST_CASE("pixels differ when their bits do", "[unit][image]") {
  CHECK(image_error(grey_row({0.0f, 1.0f}), grey_row({-0.0f, 1.0f})).different_pixels == 1);
  CHECK(image_error(grey_row({0.0f, 1.0f}), grey_row({0.0f, std::nextafter(1.0f, 2.0f)})).different_pixels == 1);
}

TEST_CASE("the mean ratio of black pictures is one, and against a black reference it is infinite", "[unit][image]") {
  const Image black = grey_row({0.0f, 0.0f});
  CHECK(image_error(black, black).mean_ratio == 1.0);
  CHECK(image_error(black, black).mean_ratio_error == 0.0);
  CHECK(image_error(grey_row({1.0f, 0.0f}), black).mean_ratio == kInf);
  CHECK(image_error(grey_row({1.0f, 0.0f}), black).mean_ratio_error == kInf);
  CHECK(image_error(black, grey_row({1.0f, 0.0f})).mean_ratio == 0.0);
  CHECK(image_error(grey_row({2.0f}), grey_row({1.0f})).mean_ratio_error == kInf);
}

TEST_CASE("pictures of other sizes or without pixels are not compared", "[unit][image]") {
  expect_error(ErrorKind::usage, "", {"2 x 3", "3 x 2"}, [] { image_error(Image(2, 3), Image(3, 2)); });
  expect_error(ErrorKind::input, "", {"without pixels"}, [] { image_error(Image(), Image()); });
  expect_error(ErrorKind::usage, "", {"2 x 3", "3 x 2"}, [] { error_picture(Image(2, 3), Image(3, 2)); });
}

TEST_CASE("the error picture goes from black through red and yellow to white", "[unit][image]") {
  // Against black the relative error is ten times the value.
  const Image errors = error_picture(grey_row({0.0f, 0.1f, 0.2f, 0.3f, 9.0f, kNaN}), Image(6, 1), 3.0);
  const Rgb expected[] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 1, 1}, {1, 1, 1}, {1, 0, 1}};
  for (int i = 0; i < 6; ++i) {
    for (int c = 0; c < 3; ++c) CHECK(errors.at(i, 0)[c] == Approx(expected[i][c]).margin(1e-5));
  }
  const Image half = error_picture(grey_row({0.05f}), Image(1, 1), 3.0);
  CHECK(linear_to_srgb(half.at(0, 0).r) == Approx(0.5).epsilon(1e-5));
}
