#pragma once
// Hashes and low-discrepancy points: each number is a function of its indices alone.
#include "core/simd/lanes.hpp"

namespace raylab {
namespace {

/// Bijective mixing of 32 bits (Wellons 2018, "Prospecting for Hash Functions", lowbias32). U is std::uint32_t or a
/// vector of them, here and below.
template <class U>
U mix_bits_32(U x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  x ^= x >> 16;
  return x;
}

/// The upper 24 bits as a float in [0, 1): 0xffffffff gives 1 - 2^-24, never 1.
template <class U>
auto bits_to_unit(const U& bits) {
  return to_float(bits >> 8) * 0x1p-24f;
}

template <class U>
U reverse_bits(U x) {
  x = (x >> 16) | (x << 16);
  x = ((x & 0x00ff00ffu) << 8) | ((x >> 8) & 0x00ff00ffu);
  x = ((x & 0x0f0f0f0fu) << 4) | ((x >> 4) & 0x0f0f0f0fu);
  x = ((x & 0x33333333u) << 2) | ((x >> 2) & 0x33333333u);
  x = ((x & 0x55555555u) << 1) | ((x >> 1) & 0x55555555u);
  return x;
}

/// Owen scrambling of a number whose bits stand in reverse order, least significant digit of the fraction first:
/// each bit is flipped or not as a hash of the bits below it says. Laine and Karras 2011 found the form; Burley
/// 2020, "Practical Hash-based Owen Scrambling" (JCGT 9:4), its use; the constants are Vegdahl's.
template <class U>
U owen_scramble_reversed(U x, const U& seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

/// Bits of the second Sobol coordinate of point `index`, in reverse order. Direction k is (1 + x)^k over GF(2), so
/// the sum over the bits of the index is its polynomial shifted by one, which halves into five steps because
/// (1 + x)^16 = 1 + x^16, and so on.
template <class U>
U sobol_second_reversed(const U& index) {
  U v = index;
  v ^= (v >> 16) & 0x0000ffffu;
  v ^= (v >> 8) & 0x00ff00ffu;
  v ^= (v >> 4) & 0x0f0f0f0fu;
  v ^= (v >> 2) & 0x33333333u;
  v ^= (v >> 1) & 0x55555555u;
  return v;
}

}  // namespace
}  // namespace raylab
