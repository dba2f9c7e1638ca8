#pragma once
// Arithmetic written once for one float and for a vector of floats (core/wide.hpp), lane by lane the same to the bit.
// Code templated on F reads like scalar code with two differences: a condition is a mask, and choosing is select().
#include <cmath>
#include <cstdint>

#include "raylab/core/vec.hpp"

namespace raylab {

/// The types that go with lanes of type F.
template <class F>
struct LaneTypes {
  using Mask = typename F::Mask;
  using UInt = typename F::UInt;
  using Vec2 = typename F::Vec2;
  using Vec3 = typename F::Vec3;
};
template <>
struct LaneTypes<float> {
  using Mask = bool;
  using UInt = std::uint32_t;
  using Vec2 = vec2;
  using Vec3 = vec3;
};
template <class F>
using MaskOf = typename LaneTypes<F>::Mask;
template <class F>
using UIntOf = typename LaneTypes<F>::UInt;
template <class F>
using Vec2Of = typename LaneTypes<F>::Vec2;
template <class F>
using Vec3Of = typename LaneTypes<F>::Vec3;

/// Where the mask holds the first, elsewhere the second.
inline float select(bool mask, float yes, float no) { return mask ? yes : no; }
inline vec3 select(bool mask, const vec3& yes, const vec3& no) { return mask ? yes : no; }
/// Whether the mask holds in some lane.
inline bool any(bool mask) { return mask; }

/// The smaller, the larger; of NaN and a number the second.
inline float lesser(float a, float b) { return a < b ? a : b; }
inline float greater(float a, float b) { return a > b ? a : b; }
inline float square_root(float x) { return std::sqrt(x); }
inline float magnitude(float x) { return std::abs(x); }
inline float round_down(float x) { return std::floor(x); }
inline float with_sign_of(float size, float sign) { return std::copysign(size, sign); }
/// Of the integers below 2^31.
inline float to_float(std::uint32_t x) { return static_cast<float>(static_cast<std::int32_t>(x)); }

}  // namespace raylab
