#include <set>
#include <vector>

#include "catch.hpp"
#include "core/low_discrepancy.hpp"
#include "core_statistics.hpp"
#include "raylab/core/numeric.hpp"
#include "raylab/core/random.hpp"

using namespace raylab;
using raylab::test::chi_square_z;
using raylab::test::kLimitZ;

TEST_CASE("the largest random bits give a number below one", "[unit][core]") {
  CHECK(bits_to_unit(0xffffffffu) < 1.0f);
  CHECK(bits_to_unit(0xffffffffu) == kOneMinusEpsilon);
  CHECK(bits_to_unit(0u) == 0.0f);
  CHECK(bits_to_unit(0x80000000u) == 0.5f);
  // The textbook conversion, which divides by the largest value, does reach it.
  CHECK(static_cast<float>(0xffffffffu) / static_cast<float>(0xffffffffu) == 1.0f);
}

TEST_CASE("reverse_bits mirrors the bits of a word", "[unit][core]") {
  for (int i = 0; i < 32; ++i) CHECK(reverse_bits(1u << i) == 1u << (31 - i));
  CHECK(reverse_bits(0x12345678u) == 0x1e6a2c48u);
  CHECK(reverse_bits(reverse_bits(0xdeadbeefu)) == 0xdeadbeefu);
}

TEST_CASE("mixing bits loses none and changes half of them", "[statistical][core]") {
  std::set<std::uint64_t> seen;
  double flipped = 0.0;
  const int trials = 500;
  for (std::uint64_t i = 0; i < trials; ++i) {
    seen.insert(mix_bits(i));
    for (int bit = 0; bit < 64; ++bit) {
      flipped += __builtin_popcountll(mix_bits(i) ^ mix_bits(i ^ (std::uint64_t{1} << bit)));
    }
  }
  CHECK(seen.size() == trials);
  CHECK(flipped / (trials * 64.0) == Approx(32.0).epsilon(0.01));
}

TEST_CASE("the second Sobol coordinate has the direction numbers of the literature", "[unit][core]") {
  // Sobol's second dimension, from the polynomial x + 1: 1/2, 1/4 and 3/4, 3/8 and 7/8, ... in the order of the
  // index.
  const double expected[] = {0.0, 0.5, 0.75, 0.25, 0.625, 0.125, 0.375, 0.875};
  for (std::uint32_t i = 0; i < 8; ++i) CHECK(reverse_bits(sobol_second_reversed(i)) * 0x1p-32 == expected[i]);
}

TEST_CASE("Owen scrambling permutes each digit by the digits before it alone", "[statistical][core]") {
  // In reversed order a bit may depend on those below it only: words equal in their low k bits stay so, and words
  // that first differ in bit k differ there.
  const int trials = 20000;
  std::uint64_t state = 9;
  int broken = 0;
  std::vector<double> ones(32, 0.0);
  for (int i = 0; i < trials; ++i) {
    const std::uint64_t r = mix_bits(++state);
    const auto x = static_cast<std::uint32_t>(r);
    const auto seed = static_cast<std::uint32_t>(r >> 32);
    const int k = i % 32;
    const std::uint32_t y = x ^ (1u << k);
    const std::uint32_t difference = owen_scramble_reversed(x, seed) ^ owen_scramble_reversed(y, seed);
    const std::uint32_t low = (1u << k) - 1u;
    broken += (difference & low) != 0 || ((difference >> k) & 1u) == 0;
    for (int bit = 0; bit < 32; ++bit) ones[bit] += (owen_scramble_reversed(12345u, seed) >> bit) & 1u;
  }
  CHECK(broken == 0);
  // Each bit is flipped by half of the seeds.
  for (int bit = 0; bit < 32; ++bit) {
    INFO("bit " << bit);
    CHECK(std::abs(ones[bit] - 0.5 * trials) < kLimitZ * 0.5 * std::sqrt(trials));
  }
}
