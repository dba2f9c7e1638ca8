#pragma once
// Floating-point facts: rounding bounds and neighbouring floats.
#include <bit>
#include <cstdint>
#include <limits>

namespace raylab {

inline constexpr float kPi = 3.14159265358979323846f;
inline constexpr float kInvPi = 0.31830988618379067154f;
inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Half the spacing of floats at 1: the relative error of one rounded operation is at most this.
inline constexpr float kUnitRoundoff = std::numeric_limits<float>::epsilon() * 0.5f;

/// Largest float below 1; the end of the half-open interval random numbers live in.
inline constexpr float kOneMinusEpsilon = 1.0f - kUnitRoundoff;

/// Bound of the relative error after n rounded operations (Higham 2002, §3.1; pbrt-v4 §6.8).
constexpr float gamma_bound(int n) {
  const float nu = static_cast<float>(n) * kUnitRoundoff;
  return nu / (1.0f - nu);
}

/// The next float towards +infinity. +infinity and NaN are returned as they are.
inline float next_float_up(float x) {
  if (!(x < kInfinity)) return x;
  if (x == 0.0f) return std::numeric_limits<float>::denorm_min();
  const auto bits = std::bit_cast<std::uint32_t>(x);
  return std::bit_cast<float>(x > 0.0f ? bits + 1 : bits - 1);
}

/// The next float towards -infinity. -infinity and NaN are returned as they are.
inline float next_float_down(float x) { return -next_float_up(-x); }

/// x, or 0 in place of a denormal, whatever the flags of the thread.
inline float without_denormal(float x) {
  constexpr std::uint32_t exponent_bits = 0x7f800000u;
  return (std::bit_cast<std::uint32_t>(x) & exponent_bits) == 0 ? 0.0f : x;
}

}  // namespace raylab
