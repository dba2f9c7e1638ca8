#pragma once
// The one vocabulary of arithmetic that formulas are written in, for one float or double here and for vectors of them
// in vector.hpp. Code templated on a number type F reads like scalar code with two differences: a condition is a mask,
// and choosing is select(). Lane by lane every model gives the same bits.
//
// All of it is local to the including file: files are compiled for different instruction sets, and an inline function
// that two of them shared could end up in the program as compiled for the newer one.
#include <cstdint>
#include <type_traits>

#include "raylab/core/vec.hpp"

namespace raylab {
namespace {

/// The types that go with a number type.
template <class F>
struct LaneTypes {
  using Mask = typename F::Mask;
  using UInt = typename F::UInt;
};
template <>
struct LaneTypes<float> {
  using Mask = bool;
  using UInt = std::uint32_t;
};
template <>
struct LaneTypes<double> {
  using Mask = bool;
};
template <class F>
using MaskOf = typename LaneTypes<F>::Mask;
template <class F>
using UIntOf = typename LaneTypes<F>::UInt;

/// Whether the mask holds in some lane.
inline bool any(bool mask) { return mask; }

/// Where the mask holds the first, elsewhere the second.
inline float select(bool mask, float yes, float no) { return mask ? yes : no; }
inline double select(bool mask, double yes, double no) { return mask ? yes : no; }
inline std::uint32_t select(bool mask, std::uint32_t yes, std::uint32_t no) { return mask ? yes : no; }
inline bool select(bool mask, bool yes, bool no) { return mask ? yes : no; }

/// Where either number is NaN these give the second, as the instructions of x86 do.
inline float min(float a, float b) { return a < b ? a : b; }
inline float max(float a, float b) { return a > b ? a : b; }
inline double min(double a, double b) { return a < b ? a : b; }
inline double max(double a, double b) { return a > b ? a : b; }
inline float abs(float x) { return __builtin_fabsf(x); }
inline double abs(double x) { return __builtin_fabs(x); }
inline float sqrt(float x) { return __builtin_sqrtf(x); }
inline double sqrt(double x) { return __builtin_sqrt(x); }
inline float floor(float x) { return __builtin_floorf(x); }
inline float copysign(float size, float sign) { return __builtin_copysignf(size, sign); }
inline double copysign(double size, double sign) { return __builtin_copysign(size, sign); }
/// Of the integers below 2^31.
inline float to_float(std::uint32_t x) { return static_cast<float>(static_cast<std::int32_t>(x)); }
inline float to_float(double x) { return static_cast<float>(x); }

/// The double of as many lanes as F has.
template <class F>
struct DoubleLanes {
  using type = typename F::Double;
};
template <>
struct DoubleLanes<float> {
  using type = double;
};
template <>
struct DoubleLanes<double> {
  using type = double;
};
template <class F>
using DoubleOf = typename DoubleLanes<F>::type;

template <class F>
struct Vec2 {
  F x, y;
};

template <class F>
struct Vec3 {
  F x, y, z;
  Vec3() = default;
  Vec3(const F& x_, const F& y_, const F& z_) : x(x_), y(y_), z(z_) {}
  explicit Vec3(const F& all) : x(all), y(all), z(all) {}
  explicit Vec3(const vec3& v) requires(!std::is_same_v<F, float>) : x(v.x), y(v.y), z(v.z) {}
  Vec3(const vec3& v) requires std::is_same_v<F, float> : x(v.x), y(v.y), z(v.z) {}
  /// Each component converted, as from float to double.
  template <class G>
  explicit Vec3(const Vec3<G>& v) : x(F(v.x)), y(F(v.y)), z(F(v.z)) {}
  operator vec3() const requires std::is_same_v<F, float> { return {x, y, z}; }

  friend Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vec3 operator*(const Vec3& a, const Vec3& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
  friend Vec3 operator*(const Vec3& a, const F& b) { return {a.x * b, a.y * b, a.z * b}; }
  friend Vec3 operator*(const F& a, const Vec3& b) { return {a * b.x, a * b.y, a * b.z}; }
  friend Vec3 operator/(const Vec3& a, const F& b) { return {a.x / b, a.y / b, a.z / b}; }
  friend Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
  Vec3& operator+=(const Vec3& b) { return *this = *this + b; }
  Vec3& operator*=(const Vec3& b) { return *this = *this * b; }
};

// Those of GLM's vectors, which the names below would hide.
using raylab::is_black;
using raylab::max_component;

template <class F>
F dot(const Vec3<F>& a, const Vec3<F>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class F>
Vec3<F> cross(const Vec3<F>& a, const Vec3<F>& b) {
  return {a.y * b.z - b.y * a.z, a.z * b.x - b.z * a.x, a.x * b.y - b.x * a.y};
}
template <class F>
Vec3<F> abs(const Vec3<F>& a) {
  return {abs(a.x), abs(a.y), abs(a.z)};
}
template <class F>
F max_component(const Vec3<F>& v) {
  return max(v.x, max(v.y, v.z));
}
template <class F>
Vec3<F> select(const MaskOf<F>& mask, const Vec3<F>& yes, const Vec3<F>& no) {
  return {select(mask, yes.x, no.x), select(mask, yes.y, no.y), select(mask, yes.z, no.z)};
}
/// Of doubles, each rounded to float.
template <class D>
auto to_float(const Vec3<D>& v) {
  return Vec3<decltype(to_float(v.x))>(to_float(v.x), to_float(v.y), to_float(v.z));
}
template <class F>
MaskOf<F> is_black(const Vec3<F>& c) {
  return (c.x == F(0.0f)) & (c.y == F(0.0f)) & (c.z == F(0.0f));
}

}  // namespace
}  // namespace raylab
