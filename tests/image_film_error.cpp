#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "catch.hpp"
#include "raylab/image/film_error.hpp"

using namespace raylab;

namespace {

/// 64 samples in each of 40 x 40 pixels: 1, and rarely `bright`.
Film noisy_film(float bright, double probability, unsigned seed) {
  std::mt19937 random(seed);
  std::bernoulli_distribution is_bright(probability);
  Film film(40, 40);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 40; ++x) {
      for (int i = 0; i < 64; ++i) film.add(x, y, Rgb(is_bright(random) ? bright : 1.0f));
    }
  }
  return film;
}

/// Against the picture of `mean` everywhere.
double true_relmse(const Film& film, double mean) {
  double sum = 0.0;
  for (int y = 0; y < film.height(); ++y) {
    for (int x = 0; x < film.width(); ++x) sum += std::pow(film.mean(x, y).g - mean, 2) / (mean * mean + 0.01);
  }
  return sum / film.width() / film.height();
}

OctaveSum octave_of(const std::vector<float>& numbers, std::uint32_t first, std::size_t begin, std::size_t end) {
  OctaveSum sum;
  const float* const from = numbers.data() + begin;
  sum.add({from, from, from}, end - begin, first + static_cast<std::uint32_t>(begin));
  return sum;
}

}  // namespace

TEST_CASE("the estimate of error holds rare bright samples against what is around them", "[unit][image]") {
  // The pixel's own mean, of 2.6 where one is bright, would hide five sixths of the error.
  double estimated = 0.0, truth = 0.0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Film film = noisy_film(100.0f, 5e-4, seed);
    const RelmseEstimate estimate = estimate_relmse(film, false);
    CHECK(estimate.low < estimate.relmse);
    CHECK(estimate.relmse < estimate.high);
    estimated += estimate.relmse;
    truth += true_relmse(film, 1.0 + 99.0 * 5e-4);
  }
  CHECK(estimated == Approx(truth).epsilon(0.2));
}

TEST_CASE("pixels with other numbers of samples than their neighbours count each with its own", "[unit][image]") {
  const auto estimated = [](int even, int odd) {
    Film film(20, 10);
    for (int y = 0; y < film.height(); ++y) {
      for (int x = 0; x < film.width(); ++x) {
        for (int i = 0; i < (x % 2 == 0 ? even : odd); ++i) film.add(x, y, Rgb(i % 2 == 0 ? 0.7f : 1.3f));
      }
    }
    return estimate_relmse(film, true).relmse;
  };
  CHECK(estimated(16, 48) == Approx(0.5 * (estimated(16, 16) + estimated(48, 48))));
}

TEST_CASE("an estimate of error that a few pixels carry says that it is not reliable", "[unit][image]") {
  CHECK(estimate_relmse(noisy_film(2.0f, 0.5, 1), false).reliable);
  Film film = noisy_film(2.0f, 0.5, 1);
  film.add(20, 20, Rgb(3000.0f));  // of 1600 pixels two are 0.1%, rounded up
  film.add(5, 9, Rgb(3000.0f));
  const RelmseEstimate estimate = estimate_relmse(film, false);
  CHECK(estimate.relmse > 1.0);
  CHECK_FALSE(estimate.reliable);
  CHECK(estimate.text().find("not reliable") != std::string::npos);
  CHECK(estimate.attributes().at("raylab.estimatedRelmseReliable") == "false");
  CHECK_FALSE(estimate_relmse(Film(2, 2), false).reliable);
}

TEST_CASE("the error of radiance whose squares are more than a film holds is bound, not nothing", "[unit][image]") {
  Film film(1, 1);
  film.add(0, 0, Rgb(0x1p35f));
  film.add(0, 0, Rgb(0.0f));
  const RelmseEstimate estimate = estimate_relmse(film, false);
  CHECK(film.variance_of_mean(0, 0).x == 0x1p68);
  CHECK(estimate.relmse == Approx(1.0));
  CHECK_FALSE(estimate.reliable);
}

TEST_CASE("the sums of the highest octave do not depend on order or grouping", "[unit][image]") {
  std::mt19937 random(4);
  std::lognormal_distribution<float> radiance(0.0f, 4.0f);
  std::vector<float> numbers(100);
  for (float& x : numbers) x = radiance(random);
  for (const std::uint32_t first : {0u, 5u, 60u}) {
    const OctaveSum whole = octave_of(numbers, first, 0, numbers.size());
    CHECK(whole.octave() == (first == 60 ? 8 : 7));
    for (int trial = 0; trial < 50; ++trial) {
      std::vector<std::size_t> cuts = {0, random() % 101, random() % 101, random() % 101, 100};
      std::sort(cuts.begin(), cuts.end());
      std::vector<OctaveSum> parts;
      for (std::size_t i = 1; i < cuts.size(); ++i) {
        if (cuts[i - 1] < cuts[i]) parts.push_back(octave_of(numbers, first, cuts[i - 1], cuts[i]));
      }
      std::shuffle(parts.begin(), parts.end(), random);
      OctaveSum sum;
      for (const OctaveSum& part : parts) sum.add(OctaveSum::from_bits(part.bits()));
      CHECK(sum == whole);
    }
  }
  // Samples 64 to 99.
  double expected = 0.0;
  for (std::size_t i = 64; i < 100; ++i) expected += numbers[i];
  CHECK(octave_of(numbers, 0, 0, 100).units(1) * OctaveSum::kUnit == Approx(expected).epsilon(1e-3));
  CHECK(octave_of({1e30f, 1.0f}, 0, 0, 1).units(0) == OctaveSum::kMost);
  const std::vector<float> dark(4096, 1e-4f);
  CHECK(octave_of(dark, 4096, 0, 4096).units(0) * OctaveSum::kUnit == Approx(0.4096).epsilon(0.01));
}

TEST_CASE("means of octaves stand for the variance of independent samples, whole octaves or not", "[unit][image]") {
  std::mt19937 random(8);
  std::exponential_distribution<float> radiance(1.0f);
  for (const int samples : {2, 16, 24, 64, 100}) {
    double from_octaves = 0.0, from_samples = 0.0;
    Film film(60, 60);
    for (int y = 0; y < 60; ++y) {
      for (int x = 0; x < 60; ++x) {
        for (int i = 0; i < samples; ++i) film.add(x, y, Rgb(radiance(random)));
        const auto variance = film.octave_variance(x, y);
        REQUIRE(variance);
        from_octaves += variance->g;
        from_samples += film.variance_of_mean(x, y).g;
      }
    }
    INFO(samples << " samples");
    CHECK(from_octaves == Approx(from_samples).epsilon(0.1));
  }
  Film film(1, 1);
  film.add(0, 0, Rgb(1.0f));
  CHECK_FALSE(film.octave_variance(0, 0));
  film.drop(0, 0, 1);
  film.add(0, 0, Rgb(1.0f));
  CHECK_FALSE(film.octave_variance(0, 0));  // one of the octave's is missing
}

TEST_CASE("rows gathered apart estimate the error of the whole film", "[unit][image]") {
  const Film film = noisy_film(3.0f, 0.1, 2);
  RelmseEstimator first(true), second(true);
  first.add(film.rows(0, 14), 0, 13);
  second.add(film.rows(12, 28), 1, 27);
  first.add(second);
  const RelmseEstimate parts = first.estimate(), whole = estimate_relmse(film, true);
  CHECK(parts.relmse == Approx(whole.relmse).epsilon(1e-12));
  CHECK(parts.low == Approx(whole.low).epsilon(1e-12));
  CHECK(parts.high == Approx(whole.high).epsilon(1e-12));
  CHECK(parts.reliable == whole.reliable);
}
