#include <cmath>
#include <functional>
#include <vector>

#include "catch.hpp"
#include "core_statistics.hpp"
#include "expect_error.hpp"
#include "raylab/render/sampler.hpp"

using namespace raylab;
using raylab::test::chi_square_z;
using raylab::test::expect_error;
using raylab::test::kLimitZ;

namespace {

int cell(float x, int cells) { return static_cast<int>(x * static_cast<float>(cells)); }

/// How unevenly pairs of numbers in [0,1) fill the square: z of a chi-square over 8 x 8 cells.
double unevenness(int count, const std::function<vec2(std::uint32_t)>& pair) {
  constexpr int kCells = 8;
  std::vector<double> counted(kCells * kCells, 0.0);
  for (int i = 0; i < count; ++i) {
    const vec2 p = pair(static_cast<std::uint32_t>(i));
    ++counted[cell(p.y, kCells) * kCells + cell(p.x, kCells)];
  }
  return chi_square_z(counted, std::vector<double>(kCells * kCells, count / double(kCells * kCells)));
}

}  // namespace

TEST_CASE("any aligned block of 2^k Sobol samples is a (0,k,2)-net in every pixel and dimension", "[unit][sampler]") {
  int tried = 0, broken = 0;
  for (const std::uint32_t seed : {0u, 77u}) {
    for (const std::uint32_t pixel : {0u, 1u, 799u}) {
      for (const std::uint32_t dimension : {0u, 1u, 2u, 36u}) {
        for (int k = 0; k <= 8; ++k) {
          const std::uint32_t size = 1u << k;
          for (const std::uint32_t block : {0u, 1u, 2u, 5u, 1000u}) {
            std::vector<vec2> points;
            std::vector<float> numbers;
            for (std::uint32_t i = 0; i < size; ++i) {
              const Sampler s(SamplerKind::sobol, seed, pixel, 3 * pixel, block * size + i);
              points.push_back(s.get2(dimension));
              numbers.push_back(s.get1(dimension));
            }
            // Elementary intervals: 2^a columns by 2^(k-a) rows for every a, each to hold one point.
            for (int a = 0; a <= k; ++a) {
              std::vector<int> held(size, 0);
              for (const vec2& p : points) ++held[(cell(p.y, 1 << (k - a)) << a) + cell(p.x, 1 << a)];
              for (const int n : held) broken += n != 1;
              ++tried;
            }
            std::vector<int> held(size, 0);
            for (const float x : numbers) ++held[cell(x, static_cast<int>(size))];
            for (const int n : held) broken += n != 1;
          }
        }
      }
    }
  }
  CHECK(tried == 2 * 3 * 4 * 45 * 5);
  CHECK(broken == 0);
}

TEST_CASE("the numbers of two dimensions and of two pixels are unrelated", "[statistical][sampler]") {
  constexpr int kCount = 4096;
  for (const SamplerKind kind : {SamplerKind::independent, SamplerKind::sobol}) {
    const auto sampler = [&](std::uint32_t x, std::uint32_t y, std::uint32_t i) { return Sampler(kind, 4, x, y, i); };
    double worst = 0.0;
    for (std::uint32_t d = 0; d < 12; ++d) {
      for (const std::uint32_t e : {d + 1, d + 5, d + 31}) {
        const double z[] = {
            unevenness(kCount, [&](auto i) { return vec2(sampler(3, 4, i).get1(d), sampler(3, 4, i).get1(e)); }),
            unevenness(kCount, [&](auto i) { return vec2(sampler(3, 4, i).get2(d).x, sampler(3, 4, i).get2(e).x); }),
            unevenness(kCount, [&](auto i) { return vec2(sampler(3, 4, i).get2(d).y, sampler(3, 4, i).get2(e).x); }),
            unevenness(kCount, [&](auto i) { return vec2(sampler(3, 4, i).get1(d), sampler(3, 4, i).get2(e).y); }),
        };
        for (const double value : z) worst = std::max(worst, value);
      }
      const double z[] = {
          unevenness(kCount, [&](auto i) { return vec2(sampler(d, 4, i).get1(2), sampler(d + 1, 4, i).get1(2)); }),
          unevenness(kCount, [&](auto i) { return vec2(sampler(7, d, i).get1(2), sampler(7, d + 1, i).get1(2)); }),
          unevenness(kCount, [&](auto i) { return vec2(sampler(7, d, i).get2(2).x, sampler(d, 7, i).get2(2).x); }),
      };
      if (d != 7) worst = std::max({worst, z[0], z[1], z[2]});
    }
    // The same sample of many pixels, at neighbouring places and in neighbouring dimensions.
    for (std::uint32_t d = 0; d < 12; ++d) {
      const double z[] = {
          unevenness(
              kCount,
              [&](auto i) { return vec2(sampler(i % 64, i / 64, 0).get1(d), sampler(i % 64, i / 64, 0).get1(d + 1)); }),
          unevenness(
              kCount,
              [&](auto i) { return vec2(sampler(i % 64, i / 64, 0).get1(d), sampler(i % 64 + 1, i / 64, 0).get1(d)); }),
          unevenness(
              kCount,
              [&](auto i) { return vec2(sampler(i % 64, i / 64, 0).get1(d), sampler(i % 64, i / 64, 1).get1(d + 5)); }),
      };
      worst = std::max({worst, z[0], z[1], z[2]});
    }
    INFO(sampler_name(kind));
    // The largest of some 220 statistics.
    CHECK(worst < kLimitZ + 1.5);
  }
}

TEST_CASE("independent numbers are uniform", "[statistical][sampler]") {
  constexpr int kCells = 256;
  constexpr int kCount = 200000;
  std::vector<double> numbers(kCells, 0.0), points(kCells, 0.0), pairs(kCells, 0.0);
  for (std::uint32_t i = 0; i < kCount; ++i) {
    const Sampler s(SamplerKind::independent, 1, i % 17, i / 1000, i);
    ++numbers[cell(s.get1(i % 40), kCells)];
    const vec2 p = s.get2(i % 40);
    ++points[cell(p.y, 16) * 16 + cell(p.x, 16)];
    const Sampler next(SamplerKind::independent, 1, i % 17, i / 1000, i + 1);
    ++pairs[cell(s.get1(i % 40), 16) * 16 + cell(next.get1(i % 40), 16)];
  }
  const std::vector<double> expected(kCells, kCount / double(kCells));
  CHECK(chi_square_z(numbers, expected) < kLimitZ);
  CHECK(chi_square_z(points, expected) < kLimitZ);
  CHECK(chi_square_z(pairs, expected) < kLimitZ);
}

TEST_CASE("a number depends on seed, pixel, sample and dimension, on each of them, and on nothing else",
          "[unit][sampler]") {
  for (const SamplerKind kind : {SamplerKind::independent, SamplerKind::sobol}) {
    INFO(sampler_name(kind));
    const Sampler s(kind, 3, 10, 20, 5);
    const float number = s.get1(7);
    const vec2 point = s.get2(7);
    for (std::uint32_t d = 0; d < 50; ++d) s.get1(d), s.get2(d);
    CHECK(s.get1(7) == number);
    CHECK(s.get2(7) == point);
    CHECK(Sampler(kind, 3, 10, 20, 5).get1(7) == number);
    CHECK(Sampler(kind, 3, 10, 20, 5).get2(7) == point);
    for (const Sampler& other : {Sampler(kind, 4, 10, 20, 5), Sampler(kind, 3, 11, 20, 5), Sampler(kind, 3, 10, 21, 5),
                                 Sampler(kind, 3, 20, 10, 5), Sampler(kind, 3, 10, 20, 6)}) {
      CHECK(other.get1(7) != number);
      CHECK(other.get2(7) != point);
    }
    CHECK(s.get1(8) != number);
    CHECK(s.get2(8) != point);
  }
}

TEST_CASE("random numbers at the ends of every index are below one and not negative", "[unit][sampler]") {
  constexpr std::uint32_t kEnds[] = {0u, 1u, 0x7fffffffu, 0x80000000u, 0xffffffffu};
  int outside = 0;
  for (const SamplerKind kind : {SamplerKind::independent, SamplerKind::sobol}) {
    for (const auto seed : kEnds) {
      for (const auto x : kEnds) {
        for (const auto sample : kEnds) {
          for (const auto dimension : kEnds) {
            const Sampler s(kind, seed, x, ~x, sample);
            const vec2 p = s.get2(dimension);
            for (const float v : {s.get1(dimension), p.x, p.y}) outside += !(v >= 0.0f && v < 1.0f);
          }
        }
      }
    }
  }
  CHECK(outside == 0);
}

TEST_CASE("samplers are chosen by name", "[unit][sampler]") {
  for (const SamplerKind kind : {SamplerKind::independent, SamplerKind::sobol}) {
    CHECK(parse_sampler(sampler_name(kind)) == kind);
  }
  expect_error(ErrorKind::usage, "--sampler", {"halton", "independent", "sobol"}, [] { parse_sampler("halton"); });
}
