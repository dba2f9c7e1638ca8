#pragma once
// Vectors of SSE4.2. Comparisons give one bit a lane and are false for NaN; min and max give the second operand
// where either is NaN.
#include <nmmintrin.h>

#include "layout.hpp"
#include "simd_pair.hpp"

namespace raylab::bvh {
namespace {

struct Float4 {
  static constexpr int lanes = 4;
  __m128 v;
  static Float4 load(const float* p) { return {_mm_load_ps(p)}; }
  static Float4 splat(float x) { return {_mm_set1_ps(x)}; }
  void store(float* p) const { _mm_store_ps(p, v); }
  friend Float4 operator+(Float4 a, Float4 b) { return {_mm_add_ps(a.v, b.v)}; }
  friend Float4 operator-(Float4 a, Float4 b) { return {_mm_sub_ps(a.v, b.v)}; }
  friend Float4 operator*(Float4 a, Float4 b) { return {_mm_mul_ps(a.v, b.v)}; }
  friend Float4 operator/(Float4 a, Float4 b) { return {_mm_div_ps(a.v, b.v)}; }
  friend Float4 min(Float4 a, Float4 b) { return {_mm_min_ps(a.v, b.v)}; }
  friend Float4 max(Float4 a, Float4 b) { return {_mm_max_ps(a.v, b.v)}; }
  friend Float4 abs(Float4 a) { return {_mm_andnot_ps(_mm_set1_ps(-0.0f), a.v)}; }
  friend std::uint32_t less(Float4 a, Float4 b) { return bits(_mm_cmplt_ps(a.v, b.v)); }
  friend std::uint32_t less_equal(Float4 a, Float4 b) { return bits(_mm_cmple_ps(a.v, b.v)); }
  friend std::uint32_t equal(Float4 a, Float4 b) { return bits(_mm_cmpeq_ps(a.v, b.v)); }
  static std::uint32_t bits(__m128 mask) { return static_cast<std::uint32_t>(_mm_movemask_ps(mask)); }
};

using Float8 = Pair<Float4>;
using Float16 = Pair<Float8>;

/// Whether the distances of all lanes of a block cost no more than that of one or two.
constexpr bool kDividesAllLanes = false;

/// Which vertex each lane takes. There is no permutation across so many lanes: it goes through memory.
struct Lookup16 {
  const std::uint8_t* corner;
  explicit Lookup16(const std::uint8_t* corner) : corner(corner) {}
  Float16 operator()(const Float16& table) const {
    alignas(16) float from[16];
    alignas(16) float to[16];
    table.store(from);
    for (int i = 0; i < 16; ++i) to[i] = from[corner[i]];
    return Float16::load(to);
  }
};

/// Puts the children with near <= far on the stack, the nearest on top; returns how many there are.
inline int push_all(const Float8& near, const Float8& far, const Ref* child, const std::uint32_t* order,
                    float* distances, Ref* refs) {
  const std::uint32_t hit = less_equal(near, far);
  alignas(16) float distance[8];
  near.store(distance);
  int count = 0;
  for (int i = 7; i >= 0; --i) {  // written whether hit or not: cheaper than a wrong guess
    const std::uint32_t lane = *order >> (4 * i) & 7u;
    distances[count] = distance[lane];
    refs[count] = child[lane];
    count += static_cast<int>(hit >> lane & 1u);
  }
  return count;
}
/// The same without an order and distances.
inline int push_all(const Float8& near, const Float8& far, const Ref* child, Ref* refs) {
  std::uint32_t hit = less_equal(near, far);
  int count = 0;
  for (; hit != 0; hit &= hit - 1) refs[count++] = child[__builtin_ctz(hit)];
  return count;
}
/// Both, and they give the one on top as `next`, if there is one.
inline int push_ordered(const Float8& near, const Float8& far, const Ref* child, const std::uint32_t* order,
                        float* distances, Ref* refs, Ref& next) {
  const int count = push_all(near, far, child, order, distances, refs);
  if (count > 0) next = refs[count - 1];
  return count;
}
inline int push_any(const Float8& near, const Float8& far, const Ref* child, Ref* refs, Ref& next) {
  const int count = push_all(near, far, child, refs);
  if (count > 0) next = refs[count - 1];
  return count;
}

}  // namespace
}  // namespace raylab::bvh
