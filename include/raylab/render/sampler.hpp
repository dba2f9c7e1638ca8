#pragma once
#include <cstdint>
#include <string_view>

#include "raylab/core/random.hpp"

namespace raylab {

enum class SamplerKind : std::uint8_t {
  independent,  ///< uniform random numbers
  sobol,        ///< padded two-dimensional Sobol points, Owen-scrambled and shuffled for each pixel and dimension
};

/// Throws Error (usage) for an unknown name.
SamplerKind parse_sampler(std::string_view name);
std::string_view sampler_name(SamplerKind kind);

/// The numbers of one sample of one pixel. All lie in [0, 1). Each is a function of (seed, pixel, sample index,
/// dimension), so any sample can be made again by itself.
class Sampler {
 public:
  Sampler(SamplerKind kind, std::uint32_t seed, std::uint32_t x, std::uint32_t y, std::uint32_t sample)
      : kind_(kind),
        sample_(sample),
        reversed_sample_(reverse_bits(sample)),
        pixel_seed_(mix_bits((static_cast<std::uint64_t>(y) << 32 | x) ^ mix_bits(seed + 0x9e3779b97f4a7c15ull))) {}

  /// Number of dimension d. Dimensions number the one- and two-dimensional draws of a sample alike.
  float get1(std::uint32_t d) const {
    const std::uint64_t h = dimension_seed(d);
    if (kind_ == SamplerKind::independent) return bits_to_unit(static_cast<std::uint32_t>(h >> 32));
    const std::uint32_t shuffled = shuffled_index(h);
    return bits_to_unit(reverse_bits(owen_scramble_reversed(shuffled, static_cast<std::uint32_t>(h >> 32))));
  }

  /// Point in the unit square of dimension d.
  vec2 get2(std::uint32_t d) const {
    const std::uint64_t h = dimension_seed(d);
    if (kind_ == SamplerKind::independent) {
      return {bits_to_unit(static_cast<std::uint32_t>(h)), bits_to_unit(static_cast<std::uint32_t>(h >> 32))};
    }
    const std::uint32_t shuffled = shuffled_index(h);
    const auto seed_x = static_cast<std::uint32_t>(h >> 32);
    const std::uint32_t seed_y = seed_x * 0x9e3779b9u + 0x7f4a7c15u;
    return {bits_to_unit(reverse_bits(owen_scramble_reversed(shuffled, seed_x))),
            bits_to_unit(reverse_bits(owen_scramble_reversed(sobol_second_reversed(shuffled), seed_y)))};
  }

 private:
  std::uint64_t dimension_seed(std::uint32_t d) const {
    const std::uint64_t key = pixel_seed_ + d * 0x9e3779b97f4a7c15ull;
    return kind_ == SamplerKind::independent ? mix_bits(key ^ mix_bits(sample_ + 0xd1b54a32d192ed03ull))
                                             : mix_bits(key);
  }
  /// The sample index in Owen-scrambled order: dimensions padded side by side must not visit their points in the
  /// same order, or they would be correlated (pbrt-v4 §8.6.5).
  std::uint32_t shuffled_index(std::uint64_t h) const {
    return reverse_bits(owen_scramble_reversed(reversed_sample_, static_cast<std::uint32_t>(h)));
  }

  SamplerKind kind_;
  std::uint32_t sample_;
  std::uint32_t reversed_sample_;
  std::uint64_t pixel_seed_;
};

}  // namespace raylab
