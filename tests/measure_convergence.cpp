#include <cmath>

#include "catch.hpp"
#include "expect_error.hpp"
#include "raylab/measure/convergence.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

/// Channel number k of the picture is (k * factor mod modulus) / 64: exact in float, easily made elsewhere.
Image pattern(int factor, int modulus) {
  Image image(50, 40);
  for (int k = 0; k < 6000; ++k) {
    image.pixels[static_cast<std::size_t>(k / 3)][k % 3] = static_cast<float>(k * factor % modulus) / 64.0f;
  }
  return image;
}

ImageError with(double relmse, double mean_ratio, double mean_ratio_error) {
  ImageError error;
  error.relmse = relmse;
  error.relmse_trimmed = relmse / 2.0;
  error.mean_ratio = mean_ratio;
  error.mean_ratio_error = mean_ratio_error;
  return error;
}

}  // namespace

TEST_CASE("image errors are what numpy makes of their definitions", "[unit][measure]") {
  // k = arange(6000).reshape(2000, 3); I = k * 37 % 101 / 64; R = k * 53 % 97 / 64
  // rel = ((I - R)**2 / (R**2 + 0.01)).mean(axis=1); rel.mean(); sort(rel)[:-2].mean(); ((I - R)**2).mean()
  const ImageError error = image_error(pattern(37, 101), pattern(53, 97));
  CHECK(error.relmse == Approx(6.554855628577424).epsilon(1e-12));
  CHECK(error.relmse_trimmed == Approx(6.477883258839856).epsilon(1e-12));
  CHECK(error.mse == Approx(0.399092529296875).epsilon(1e-12));
  // a, b = I.sum(axis=1), R.sum(axis=1); ratio = a.mean() / b.mean(); (a - ratio * b).std(ddof=1) / sqrt(2000) /
  // b.mean()
  CHECK(error.mean_ratio == Approx(1.0419474042482253).epsilon(1e-12));
  CHECK(error.mean_ratio_error == Approx(0.008044645470042227).epsilon(1e-12));
}

TEST_CASE("a reference is the mean of its halves and tells its own error", "[unit][measure]") {
  const Image a = pattern(37, 101), b = pattern(29, 89);
  const Reference reference = make_reference(a, b);
  CHECK(reference.image.pixels[7] == 0.5f * (a.pixels[7] + b.pixels[7]));
  // M = (A + B) / 2; ((A - M)**2 / (M**2 + 0.01)).mean(), with numpy
  CHECK(reference.relmse == Approx(0.22210860473675204).epsilon(1e-6));
  CHECK(make_reference(a, a).relmse == 0.0);
  expect_error(ErrorKind::usage, "", {"50 x 40", "2 x 1"}, [&] { (void)make_reference(a, Image(2, 1)); });
}

TEST_CASE("the error that a reference tells of itself is that against the truth", "[statistical][measure]") {
  // Halves of truth plus noise: the mean's error against the truth is known, and must come out.
  Image truth(200, 200), a = truth, b = truth;
  std::uint64_t state = 1;
  const auto noise = [&] {
    state = state * 6364136223846793005ull + 1442695040888963407ull;
    return static_cast<float>(state >> 40) * 0x1p-24f - 0.5f;
  };
  for (std::size_t i = 0; i < truth.pixels.size(); ++i) {
    truth.pixels[i] = Rgb(1.0f);
    for (int c = 0; c < 3; ++c) {
      a.pixels[i][c] = 1.0f + noise();
      b.pixels[i][c] = 1.0f + noise();
    }
  }
  const Reference reference = make_reference(a, b);
  const ImageError real = image_error(reference.image, truth);
  CHECK(reference.relmse == Approx(real.relmse).epsilon(0.1));  // pixels vary: the divisor is not quite the truth's
  CHECK(reference.mean_ratio_error == Approx(real.mean_ratio_error).epsilon(0.02));
}

TEST_CASE("errors of several runs combine, the noise of the reference being shared", "[unit][measure]") {
  Reference reference;
  reference.mean_ratio_error = 0.003;
  const RunErrors all = combine({with(0.02, 1.01, 0.005), with(0.04, 0.99, 0.005)}, reference);
  CHECK(all.relmse == Approx(0.03));
  CHECK(all.relmse_error == Approx(0.01));
  CHECK(all.relmse_trimmed == Approx(0.015));
  CHECK(all.mean_ratio == Approx(1.0));
  // A run's own variance is 0.005² - 0.003² = 0.004²; halved for two runs, the reference's added.
  CHECK(all.mean_ratio_error == Approx(std::sqrt(0.004 * 0.004 / 2.0 + 0.003 * 0.003)));
  CHECK(std::isinf(combine({with(0.02, 1.0, 0.005)}, reference).relmse_error));
}

TEST_CASE("a picture's own error is what is measured less the reference's, and at least half", "[unit][measure]") {
  Reference reference;
  reference.relmse = 0.01;
  CHECK(own_relmse(0.04, reference) == Approx(0.03));
  CHECK(own_relmse(0.02, reference) == Approx(0.01));
  CHECK(own_relmse(0.012, reference) == Approx(0.006));
  CHECK(own_relmse(0.005, reference) == Approx(0.0025));
}

TEST_CASE("time to an error is interpolated by a power law", "[unit][measure]") {
  const std::vector<ErrorAtTime> points{{1.0, 0.16}, {4.0, 0.04}, {16.0, 0.0025}};
  const TimeToError first = time_to_error(points, 0.08);
  CHECK(first.seconds == Approx(2.0));
  CHECK_FALSE(first.extrapolated);
  CHECK(time_to_error(points, 0.01).seconds == Approx(8.0));  // falls with the square here
  CHECK(time_to_error(points, 0.04).seconds == Approx(4.0));
}

TEST_CASE("beyond what was measured, error times seconds is constant", "[unit][measure]") {
  const std::vector<ErrorAtTime> points{{1.0, 0.16}, {4.0, 0.01}};
  const TimeToError later = time_to_error(points, 0.005);
  CHECK(later.seconds == Approx(8.0));
  CHECK(later.extrapolated);
  const TimeToError sooner = time_to_error(points, 0.32);
  CHECK(sooner.seconds == Approx(0.5));
  CHECK(sooner.extrapolated);
  CHECK(time_to_error({{3.0, 0.02}}, 0.01).seconds == Approx(6.0));
}
