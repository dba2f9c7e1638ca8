#pragma once
#include <cstdint>
#include <string_view>

#include "raylab/core/random.hpp"
#include "raylab/core/vec.hpp"

namespace raylab {

enum class SamplerKind : std::uint8_t {
  independent,  ///< uniform random numbers
  sobol,        ///< padded two-dimensional Sobol points, Owen-scrambled and shuffled for each pixel and dimension
};

/// Throws Error (usage) for an unknown name.
SamplerKind parse_sampler(std::string_view name);
std::string_view sampler_name(SamplerKind kind);

/// What the numbers of all samples of a pixel start from.
struct PixelSeed {
  std::uint32_t low, high;

  PixelSeed(std::uint32_t seed, std::uint32_t x, std::uint32_t y) {
    const std::uint64_t bits =
        mix_bits((static_cast<std::uint64_t>(y) << 32 | x) ^ mix_bits(seed + 0x9e3779b97f4a7c15ull));
    low = static_cast<std::uint32_t>(bits);
    high = static_cast<std::uint32_t>(bits >> 32);
  }
};

/// The numbers of one sample of one pixel. All lie in [0, 1). Each is a function of (seed, pixel, sample index,
/// dimension), so any sample can be made again by itself.
class Sampler {
 public:
  Sampler(SamplerKind kind, const PixelSeed& pixel, std::uint32_t sample)
      : kind_(kind), pixel_(pixel), sample_(sample) {}
  Sampler(SamplerKind kind, std::uint32_t seed, std::uint32_t x, std::uint32_t y, std::uint32_t sample)
      : Sampler(kind, PixelSeed(seed, x, y), sample) {}

  /// Number of dimension d. Dimensions number the one- and two-dimensional draws of a sample alike.
  float get1(std::uint32_t d) const;
  /// Point in the unit square of dimension d, its x that of get1().
  vec2 get2(std::uint32_t d) const;

 private:
  SamplerKind kind_;
  PixelSeed pixel_;
  std::uint32_t sample_;
};

}  // namespace raylab
