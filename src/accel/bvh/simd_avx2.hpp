#pragma once
// Vectors of AVX2. Comparisons give one bit a lane and are false for NaN; min and max give the second operand
// where either is NaN.
#include <immintrin.h>

#include "layout.hpp"
#include "simd_pair.hpp"

namespace raylab::bvh {
namespace {

struct Float8 {
  static constexpr int lanes = 8;
  __m256 v;
  static Float8 load(const float* p) { return {_mm256_load_ps(p)}; }
  static Float8 splat(float x) { return {_mm256_set1_ps(x)}; }
  void store(float* p) const { _mm256_store_ps(p, v); }
  friend Float8 operator+(Float8 a, Float8 b) { return {_mm256_add_ps(a.v, b.v)}; }
  friend Float8 operator-(Float8 a, Float8 b) { return {_mm256_sub_ps(a.v, b.v)}; }
  friend Float8 operator*(Float8 a, Float8 b) { return {_mm256_mul_ps(a.v, b.v)}; }
  friend Float8 operator/(Float8 a, Float8 b) { return {_mm256_div_ps(a.v, b.v)}; }
  friend Float8 min(Float8 a, Float8 b) { return {_mm256_min_ps(a.v, b.v)}; }
  friend Float8 max(Float8 a, Float8 b) { return {_mm256_max_ps(a.v, b.v)}; }
  friend Float8 abs(Float8 a) { return {_mm256_andnot_ps(_mm256_set1_ps(-0.0f), a.v)}; }
  friend std::uint32_t less(Float8 a, Float8 b) { return bits(_mm256_cmp_ps(a.v, b.v, _CMP_LT_OQ)); }
  friend std::uint32_t less_equal(Float8 a, Float8 b) { return bits(_mm256_cmp_ps(a.v, b.v, _CMP_LE_OQ)); }
  friend std::uint32_t equal(Float8 a, Float8 b) { return bits(_mm256_cmp_ps(a.v, b.v, _CMP_EQ_OQ)); }
  static std::uint32_t bits(__m256 mask) { return static_cast<std::uint32_t>(_mm256_movemask_ps(mask)); }
};

using Float16 = Pair<Float8>;

/// Whether the distances of all lanes of a block cost no more than that of one or two.
constexpr bool kDividesAllLanes = false;

/// Which vertex each lane takes.
struct Lookup16 {
  __m256i index[2];
  explicit Lookup16(const std::uint8_t* corner) {
    for (int half = 0; half < 2; ++half) {
      index[half] = _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(corner + 8 * half)));
    }
  }
  Float16 operator()(Float16 table) const { return {{pick(table, index[0])}, {pick(table, index[1])}}; }
  static __m256 pick(const Float16& table, __m256i i) {
    // The permutation looks at three bits of the index, the fourth chooses the half.
    const __m256 from_high = _mm256_castsi256_ps(_mm256_slli_epi32(i, 28));
    return _mm256_blendv_ps(_mm256_permutevar8x32_ps(table.low.v, i), _mm256_permutevar8x32_ps(table.high.v, i),
                            from_high);
  }
};

/// For each mask its set bits, descending, four bits each.
struct CompressTable {
  std::uint32_t packed[256];
};
constexpr CompressTable make_compress_table() {
  CompressTable table{};
  for (std::uint32_t mask = 0; mask < 256; ++mask) {
    std::uint32_t packed = 0, count = 0;
    for (std::uint32_t bit = 8; bit-- > 0;) {
      if (mask >> bit & 1u) packed |= bit << (4 * count++);
    }
    table.packed[mask] = packed;
  }
  return table;
}
constexpr CompressTable kCompress = make_compress_table();

inline __m256i unpack_lanes(std::uint32_t packed) {
  return _mm256_srlv_epi32(_mm256_set1_epi32(static_cast<int>(packed)),
                           _mm256_setr_epi32(0, 4, 8, 12, 16, 20, 24, 28));
}

/// Puts the children with near <= far on the stack, the nearest on top. Returns which they are, by place in the order.
inline std::uint32_t push_hits(Float8 near, Float8 far, const Ref* child, std::uint32_t order, float* distances,
                               Ref* refs) {
  const __m256i lane = unpack_lanes(order);
  const __m256 sorted_near = _mm256_permutevar8x32_ps(near.v, lane);
  const __m256 sorted_far = _mm256_permutevar8x32_ps(far.v, lane);
  const std::uint32_t hit = Float8::bits(_mm256_cmp_ps(sorted_near, sorted_far, _CMP_LE_OQ));
  const __m256i kept = unpack_lanes(kCompress.packed[hit]);
  const __m256i all = _mm256_load_si256(reinterpret_cast<const __m256i*>(child));
  _mm256_storeu_ps(distances, _mm256_permutevar8x32_ps(sorted_near, kept));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(refs),
                      _mm256_permutevar8x32_epi32(_mm256_permutevar8x32_epi32(all, lane), kept));
  return hit;
}
/// The same without an order and distances; the first child is on top.
inline std::uint32_t push_hits(Float8 near, Float8 far, const Ref* child, Ref* refs) {
  const std::uint32_t hit = Float8::bits(_mm256_cmp_ps(near.v, far.v, _CMP_LE_OQ));
  const __m256i all = _mm256_load_si256(reinterpret_cast<const __m256i*>(child));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(refs),
                      _mm256_permutevar8x32_epi32(all, unpack_lanes(kCompress.packed[hit])));
  return hit;
}

/// How many children push_hits() puts on the stack.
inline int push_all(Float8 near, Float8 far, const Ref* child, const std::uint32_t* order, float* distances,
                    Ref* refs) {
  return __builtin_popcount(push_hits(near, far, child, *order, distances, refs));
}
inline int push_all(Float8 near, Float8 far, const Ref* child, Ref* refs) {
  return __builtin_popcount(push_hits(near, far, child, refs));
}
/// The same, and gives the one on top as `next`, if there is one.
inline int push_ordered(Float8 near, Float8 far, const Ref* child, const std::uint32_t* order, float* distances,
                        Ref* refs, Ref& next) {
  const std::uint32_t hit = push_hits(near, far, child, *order, distances, refs);
  next = child[*order >> 4 * __builtin_ctz(hit | 0x80u) & 7u];
  return __builtin_popcount(hit);
}
inline int push_any(Float8 near, Float8 far, const Ref* child, Ref* refs, Ref& next) {
  const std::uint32_t hit = push_hits(near, far, child, refs);
  next = child[__builtin_ctz(hit | 0x80u)];
  return __builtin_popcount(hit);
}

}  // namespace
}  // namespace raylab::bvh
