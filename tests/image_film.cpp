#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "catch.hpp"
#include "raylab/core/numeric.hpp"
#include "raylab/core/parallel.hpp"
#include "raylab/image/film.hpp"

using namespace raylab;

namespace {

/// Random numbers of either sign, their exponents spread evenly over 2^-60 to 2^39.
std::vector<float> spread_numbers(std::size_t count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> mantissa(-2.0f, 2.0f);
  std::uniform_int_distribution<int> exponent(-60, 38);
  std::vector<float> numbers(count);
  for (float& x : numbers) x = std::ldexp(mantissa(random), exponent(random));
  return numbers;
}

ExactSum sum_of(const std::vector<float>& numbers) {
  ExactSum sum;
  for (const float x : numbers) sum.add(x);
  return sum;
}

double value_of(double x) {
  ExactSum sum;
  sum.add(x);
  return sum.value();
}

}  // namespace

TEST_CASE("an exact sum is the true sum where long double can hold it", "[unit][image]") {
  // Multiples of 2^-20 below 2^30, 4000 of them: the sum has fewer than 63 bits.
  std::mt19937_64 random(1);
  ExactSum sum;
  long double expected = 0.0L;
  for (int i = 0; i < 4000; ++i) {
    const auto x = static_cast<double>(static_cast<std::int64_t>(random()) >> 14) * 0x1p-20;
    sum.add(x);
    expected += static_cast<long double>(x);
  }
  CHECK(sum.value() == static_cast<double>(expected));
}

TEST_CASE("an exact sum does not depend on order or grouping, where a float sum does", "[unit][image]") {
  std::vector<float> numbers = spread_numbers(10000);
  const ExactSum in_order = sum_of(numbers);
  const float naive_in_order = std::accumulate(numbers.begin(), numbers.end(), 0.0f);
  std::mt19937 random(3);
  bool naive_differs = false;
  for (int trial = 0; trial < 20; ++trial) {
    std::shuffle(numbers.begin(), numbers.end(), random);
    CHECK(sum_of(numbers) == in_order);
    naive_differs |= std::accumulate(numbers.begin(), numbers.end(), 0.0f) != naive_in_order;

    ExactSum grouped;
    for (std::size_t begin = 0; begin < numbers.size();) {
      const std::size_t end = std::min(numbers.size(), begin + 1 + random() % 500);
      ExactSum group;
      for (; begin < end; ++begin) group.add(numbers[begin]);
      grouped.add(group);
    }
    CHECK(grouped == in_order);
  }
  CHECK(naive_differs);
}

TEST_CASE("an exact sum keeps floats from 2^-32 to 2^40 as they are, and subtracts what it added", "[unit][image]") {
  for (const float x : {0x1p-32f, 0x1.fffffep-32f, 0.1f, 1.0f, 65504.0f, 0x1.234566p39f, 0x1p40f}) {
    CHECK(value_of(x) == x);
    CHECK(value_of(-x) == -x);
    ExactSum sum;
    sum.add(1.0 / 3.0);
    const ExactSum before = sum;
    sum.add(x);
    sum.add(-x);
    CHECK(sum == before);
  }
}

TEST_CASE("an exact sum cuts each term towards zero at 2^-55", "[unit][image]") {
  CHECK(value_of(0x1p-55) == 0x1p-55);
  CHECK(value_of(0x1.cp-55) == 0x1p-55);
  CHECK(value_of(-0x1.cp-55) == -0x1p-55);
  CHECK(value_of(1.0 + 0x1p-52) == 1.0 + 0x1p-52);
  CHECK(value_of(0x1.8p-56) == 0.0);
  ExactSum twice;
  twice.add(0x1.8p-56);
  twice.add(0x1.8p-56);
  CHECK(twice.value() == 0.0);
  CHECK(value_of(std::numeric_limits<float>::denorm_min()) == 0.0);
}

TEST_CASE("an exact sum clamps its terms to 2^40 and has room for 2^32 - 1 of them", "[unit][image]") {
  CHECK(value_of(1e30f) == 0x1p40);
  CHECK(value_of(-1e30f) == -0x1p40);
  CHECK(value_of(kInfinity) == 0x1p40);
  CHECK(value_of(std::nextafter(0x1p40, 0.0)) < 0x1p40);
  ExactSum largest;
  for (int bit = 0; bit < 32; ++bit) {
    ExactSum power;  // 2^bit times the largest term
    power.add(kInfinity);
    for (int i = 0; i < bit; ++i) power.add(ExactSum(power));
    largest.add(power);
  }
  CHECK(largest.value() == 0x1p40 * 4294967295.0);
}

TEST_CASE("a film is the same with denormals flushed or not", "[unit][image]") {
  const auto fill = [](Film& film) {
    std::vector<float> numbers = spread_numbers(3000);
    for (int e = -149; e < -120; ++e) numbers.push_back(std::ldexp(1.75f, e));
    for (std::size_t i = 0; i + 2 < numbers.size(); ++i) {
      film.add(0, 0, Rgb(std::abs(numbers[i]), std::abs(numbers[i + 1]), std::abs(numbers[i + 2])));
    }
  };
  Film plain(1, 1);
  fill(plain);
  Film flushed(1, 1);
  {
    const FlushDenormals flush;
    fill(flushed);
  }
  CHECK(plain.mean(0, 0) == flushed.mean(0, 0));
  CHECK(plain.variance_of_mean(0, 0) == flushed.variance_of_mean(0, 0));
}

TEST_CASE("a film's mean and variance are those of its samples", "[unit][image]") {
  Film film(3, 2);
  CHECK(film.width() == 3);
  CHECK(film.height() == 2);
  for (const float grey : {1.0f, 2.0f, 6.0f}) film.add(2, 1, Rgb(grey));
  CHECK(film.samples(2, 1) == 3);
  CHECK(film.mean(2, 1) == Rgb(3.0f));
  // Squared deviations 4 + 1 + 9, over n - 1 = 2, over n = 3.
  CHECK(film.variance_of_mean(2, 1).y == Approx(14.0 / 6.0).epsilon(1e-12));
  CHECK(film.estimated_relmse() == Approx(14.0 / 6.0 / 9.01).epsilon(1e-12));
  CHECK(film.samples(1, 1) == 0);
  CHECK(film.mean(1, 1) == Rgb(0.0f));
  CHECK(film.image().at(2, 1) == Rgb(3.0f));
  CHECK(film.image().at(1, 1) == Rgb(0.0f));

  Film coloured(1, 1);
  coloured.add(0, 0, Rgb(1.0f, 0.0f, 0.0f));
  coloured.add(0, 0, Rgb(0.0f, 0.0f, 1.0f));
  CHECK(coloured.mean(0, 0) == Rgb(0.5f, 0.0f, 0.5f));
  CHECK(coloured.variance_of_mean(0, 0) == dvec3(0.25, 0.0, 0.25));
}

TEST_CASE("equal samples have no variance worth the name", "[unit][image]") {
  Film film(1, 1);
  for (int i = 0; i < 1000; ++i) film.add(0, 0, Rgb(0.1f, 123.4f, 7.7f));
  CHECK(glm::all(glm::lessThan(film.variance_of_mean(0, 0), dvec3(1e-12))));
}

TEST_CASE("samples of one pixel given together are those given one by one, small and large", "[unit][image]") {
  Film together(2, 1), apart(2, 1);
  const std::vector<float> red = {1.0f, 15.9f, 16.0f, 17.0f}, green = {0.0f, 300.0f, 100.0f, 2e6f};
  const std::vector<float> blue = {0.25f, 0.5f, 1e-12f, 0.125f};
  together.add(1, 0, {red.data(), green.data(), blue.data()}, red.size(), 0);
  for (std::size_t i = 0; i < red.size(); ++i) apart.add(1, 0, Rgb(red[i], green[i], blue[i]));
  CHECK(together.samples(1, 0) == 4);
  CHECK(together.samples(0, 0) == 0);
  CHECK(together.mean(1, 0) == apart.mean(1, 0));
  CHECK(together.variance_of_mean(1, 0) == apart.variance_of_mean(1, 0));
  // Of the reds: mean 12.475, squared deviations summed 131.675625 + 11.730625 + 12.425625 + 20.475625.
  CHECK(together.mean(1, 0).r == Approx(12.475));
  CHECK(together.variance_of_mean(1, 0).x == Approx(176.3075 / 3.0 / 4.0).epsilon(1e-6));
}

TEST_CASE("the estimated error of a film leaves out pixels that say nothing", "[unit][image]") {
  Film film(2, 2);
  CHECK(film.estimated_relmse() == kInfinity);
  film.add(0, 0, Rgb(5.0f));
  CHECK(film.variance_of_mean(0, 0) == dvec3(0.0));
  CHECK(film.estimated_relmse() == kInfinity);
  film.add(1, 0, Rgb(1.0f));
  film.add(1, 0, Rgb(3.0f));
  film.add(0, 1, Rgb(1.0f));
  film.add(0, 1, Rgb(1.0f));
  // What the pixel of 2 differs by is held against its one neighbour that says something, of 1.
  CHECK(film.estimated_relmse() == Approx(0.5 * (1.0 / 1.01)).epsilon(1e-12));
}

TEST_CASE("films of parts of the samples add up to the film of all", "[unit][image]") {
  std::mt19937 random(5);
  std::lognormal_distribution<float> radiance(0.0f, 4.0f);
  Film all(4, 3);
  std::vector<Film> parts(3, Film(4, 3));
  for (int i = 0; i < 2000; ++i) {
    const int x = static_cast<int>(random() % 4);
    const int y = static_cast<int>(random() % 3);
    const Rgb sample(radiance(random), radiance(random), radiance(random));
    all.add(x, y, sample);
    parts[random() % 3].add(x, y, sample);
  }
  Film sum = parts[2];
  sum.add(parts[0]);
  sum.add(parts[1]);
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 4; ++x) {
      CHECK(sum.samples(x, y) == all.samples(x, y));
      CHECK(sum.mean(x, y) == all.mean(x, y));
      CHECK(sum.variance_of_mean(x, y) == all.variance_of_mean(x, y));
    }
  }
  CHECK(sum.estimated_relmse() == all.estimated_relmse());
  sum.clear();
  CHECK(sum.samples(1, 1) == 0);
  CHECK(sum.mean(1, 1) == Rgb(0.0f));
  sum.add(1, 1, Rgb(2.0f));
  CHECK(sum.mean(1, 1) == Rgb(2.0f));
}

TEST_CASE("a film of a window is added at its place in a larger one", "[unit][image]") {
  Film window(2, 1);
  window.add(0, 0, Rgb(1.0f));
  window.add(1, 0, Rgb(2.0f));
  Film film(4, 3);
  film.add(3, 2, Rgb(6.0f));
  film.add(window, 2, 2);
  CHECK(film.mean(2, 2) == Rgb(1.0f));
  CHECK(film.mean(3, 2) == Rgb(4.0f));
  CHECK(film.samples(3, 2) == 2);
  CHECK(film.samples(0, 0) == 0);
  CHECK(film.samples(1, 2) == 0);
}

TEST_CASE("a sum of squares ends at the largest there is, whatever the order", "[unit][image]") {
  const auto sum_of_squares = [](const std::vector<float>& numbers, std::size_t first_group) {
    SquareSum sum, rest;
    sum.add(numbers.data(), first_group);
    rest.add(numbers.data() + first_group, numbers.size() - first_group);
    sum.add(rest);
    return sum;
  };
  const double most = 0x1p60 - 0x1p-36;  // 96 bits, of which 36 are a fraction
  CHECK(sum_of_squares({0x1p29f, 0x1p29f, 0x1p29f}, 1).value() == 3.0 * 0x1p58);
  std::vector<float> numbers = {0x1p29f, 3.0f, 0x1p29f, 1e-3f, 0x1p29f, 0x1p29f};
  for (int trial = 0; trial < 6; ++trial) {
    for (std::size_t group = 0; group <= numbers.size(); ++group) {
      CHECK(sum_of_squares(numbers, group).value() == most);
    }
    std::rotate(numbers.begin(), numbers.begin() + 1, numbers.end());
  }
  CHECK(sum_of_squares({std::numeric_limits<float>::max(), kInfinity, 0x1p30f}, 2).value() == most);
  CHECK(sum_of_squares({0x1p-18f, 0x1p-18f, 0x1.fp-19f}, 1).value() == 2 * 0x1p-36);
}

TEST_CASE("the estimate of error is as good as one of long doubles, dark and bright", "[unit][image]") {
  std::mt19937 random(11);
  for (const double scale : {1e-3, 1.0, 1e4, 1e6}) {
    std::lognormal_distribution<double> radiance(std::log(scale), 1.5);
    Film film(1, 1);
    long double sum = 0.0L, squares = 0.0L;
    constexpr int kCount = 4096;
    for (int i = 0; i < kCount; ++i) {
      const auto x = static_cast<float>(radiance(random));
      film.add(0, 0, Rgb(x));
      sum += x;
      squares += static_cast<long double>(x) * x;
    }
    const long double mean = sum / kCount;
    const auto variance = static_cast<double>((squares - kCount * mean * mean) / (kCount - 1) / kCount);
    INFO("radiance about " << scale);
    CHECK(film.variance_of_mean(0, 0).x == Approx(variance).epsilon(1e-5));
  }
}

TEST_CASE("a film takes 99 bytes a pixel, and its rows go through words and come back the same", "[unit][image]") {
  CHECK(Film::kBytes == 99);
  std::mt19937 random(9);
  std::lognormal_distribution<float> radiance(0.0f, 9.0f);
  Film film(5, 3);
  for (int i = 0; i < 300; ++i) {
    film.add(static_cast<int>(random() % 5), static_cast<int>(random() % 3),
             Rgb(radiance(random), radiance(random), radiance(random)));
  }
  film.drop(2, 1, 7);
  CHECK(film.taken(2, 1) == film.samples(2, 1) + 7);
  Film back(5, 3), twice = film;
  twice.add(film);
  Film twice_back(5, 3);
  for (int y = 0; y < 3; ++y) {
    std::vector<std::uint32_t> words(5 * Film::kWords);
    film.row_words(y, words.data());
    back.add_row_words(y, words.data());
    twice_back.add_row_words(y, words.data());
    twice_back.add_row_words(y, words.data());
  }
  CHECK(back == film);
  CHECK(twice_back == twice);
  CHECK_FALSE(back == twice);
}
