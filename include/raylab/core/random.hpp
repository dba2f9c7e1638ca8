#pragma once
#include <cstdint>

namespace raylab {

/// Bijective mixing of 64 bits (the finaliser of SplitMix64, Steele et al. 2014, with Stafford's "variant 13").
inline std::uint64_t mix_bits(std::uint64_t x) {
  x ^= x >> 30;
  x *= 0xbf58476d1ce4e5b9ull;
  x ^= x >> 27;
  x *= 0x94d049bb133111ebull;
  x ^= x >> 31;
  return x;
}

}  // namespace raylab
