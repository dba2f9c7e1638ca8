#pragma once
// The numbers of samples, over the number type F.
#include "core/low_discrepancy.hpp"
#include "raylab/render/sampler.hpp"

namespace raylab {
namespace {

/// The numbers of one sample of one pixel, or of a vector of them. All lie in [0, 1). Each is a function of (seed,
/// pixel, sample index, dimension), so any sample can be made again by itself.
template <class F>
class BasicSampler {
 public:
  using UInt = UIntOf<F>;

  BasicSampler(SamplerKind kind, const UInt& seed_low, const UInt& seed_high, const UInt& sample)
      : kind_(kind),
        seed_low_(seed_low),
        seed_high_(seed_high),
        sample_(sample),
        reversed_sample_(reverse_bits(sample)) {}

  /// Number of dimension d. Dimensions number the one- and two-dimensional draws of a sample alike.
  F get1(std::uint32_t d) const {
    const Pair h = dimension_seeds(d);
    if (kind_ == SamplerKind::independent) return bits_to_unit(h.first);
    return bits_to_unit(reverse_bits(owen_scramble_reversed(shuffled_index(h), h.first)));
  }

  /// Point in the unit square of dimension d, its x that of get1().
  Vec2<F> get2(std::uint32_t d) const {
    const Pair bits = bits2(d);
    return {bits_to_unit(bits.first), bits_to_unit(bits.second)};
  }

  struct Pair {
    UInt first, second;
  };
  /// The numbers of get2(d) in units of 2^-32, of which those keep the upper 24 bits.
  Pair bits2(std::uint32_t d) const {
    const Pair h = dimension_seeds(d);
    if (kind_ == SamplerKind::independent) return h;
    const UInt shuffled = shuffled_index(h);
    const UInt seed_y = h.first * 0x9e3779b9u + 0x7f4a7c15u;
    return {reverse_bits(owen_scramble_reversed(shuffled, h.first)),
            reverse_bits(owen_scramble_reversed(sobol_second_reversed(shuffled), seed_y))};
  }

 private:
  /// 32-bit mixing, which vectors have and 64-bit multiplication they do not: two rounds chained over the two halves
  /// of the pixel's seed.
  Pair dimension_seeds(std::uint32_t d) const {
    UInt first = mix_bits_32<UInt>(seed_high_ + d * 0x9e3779b9u);
    if (kind_ == SamplerKind::independent) first = mix_bits_32<UInt>(first ^ mix_bits_32<UInt>(sample_ + 0xd1b54a33u));
    const UInt second = mix_bits_32<UInt>(seed_low_ + first);
    return {second, mix_bits_32<UInt>(second ^ seed_high_)};
  }
  /// The sample index in Owen-scrambled order: dimensions padded side by side must not visit their points in the
  /// same order, or they would be correlated (pbrt-v4 §8.6.5).
  UInt shuffled_index(const Pair& h) const { return reverse_bits(owen_scramble_reversed(reversed_sample_, h.second)); }

  SamplerKind kind_;
  UInt seed_low_, seed_high_, sample_, reversed_sample_;
};

}  // namespace
}  // namespace raylab
