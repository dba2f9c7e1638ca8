#pragma once
// Vectors of AVX-512 (F, BW, DQ, VL). Comparisons give one bit a lane and are false for NaN; min and max give the
// second operand where either is NaN.
#include <immintrin.h>

#include "layout.hpp"

namespace raylab::bvh {
namespace {

struct Float8 {
  static constexpr int lanes = 8;
  __m256 v;
  static Float8 load(const float* p) { return {_mm256_load_ps(p)}; }
  static Float8 splat(float x) { return {_mm256_set1_ps(x)}; }
  friend Float8 operator-(Float8 a, Float8 b) { return {_mm256_sub_ps(a.v, b.v)}; }
  friend Float8 operator*(Float8 a, Float8 b) { return {_mm256_mul_ps(a.v, b.v)}; }
  friend Float8 min(Float8 a, Float8 b) { return {_mm256_min_ps(a.v, b.v)}; }
  friend Float8 max(Float8 a, Float8 b) { return {_mm256_max_ps(a.v, b.v)}; }
};

struct Float16 {
  static constexpr int lanes = 16;
  __m512 v;
  static Float16 load(const float* p) { return {_mm512_load_ps(p)}; }
  static Float16 splat(float x) { return {_mm512_set1_ps(x)}; }
  void store(float* p) const { _mm512_store_ps(p, v); }
  friend Float16 operator+(Float16 a, Float16 b) { return {_mm512_add_ps(a.v, b.v)}; }
  friend Float16 operator-(Float16 a, Float16 b) { return {_mm512_sub_ps(a.v, b.v)}; }
  friend Float16 operator*(Float16 a, Float16 b) { return {_mm512_mul_ps(a.v, b.v)}; }
  friend Float16 operator/(Float16 a, Float16 b) { return {_mm512_div_ps(a.v, b.v)}; }
  friend Float16 min(Float16 a, Float16 b) { return {_mm512_min_ps(a.v, b.v)}; }
  friend Float16 max(Float16 a, Float16 b) { return {_mm512_max_ps(a.v, b.v)}; }
  friend Float16 abs(Float16 a) { return {_mm512_abs_ps(a.v)}; }
  friend std::uint32_t less(Float16 a, Float16 b) { return _mm512_cmp_ps_mask(a.v, b.v, _CMP_LT_OQ); }
  friend std::uint32_t less_equal(Float16 a, Float16 b) { return _mm512_cmp_ps_mask(a.v, b.v, _CMP_LE_OQ); }
  friend std::uint32_t equal(Float16 a, Float16 b) { return _mm512_cmp_ps_mask(a.v, b.v, _CMP_EQ_OQ); }
};

/// Whether the distances of all lanes of a block cost no more than that of one or two.
constexpr bool kDividesAllLanes = true;

/// Which vertex each lane takes.
struct Lookup16 {
  __m512i index;
  explicit Lookup16(const std::uint8_t* corner)
      : index(_mm512_cvtepu8_epi32(_mm_load_si128(reinterpret_cast<const __m128i*>(corner)))) {}
  Float16 operator()(Float16 table) const { return {_mm512_permutexvar_ps(index, table.v)}; }
};

/// Finds the lanes with near <= far. Gives the first of them in the order as `next`, and puts the others on the
/// stack, the last one at the bottom; returns how many lanes there are, of which `next` is one.
inline int push_ordered(Float8 near, Float8 far, const Ref* child, const std::uint32_t* order, float* distances,
                        Ref* refs, Ref& next) {
  const __m256i iota = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
  const __m256i lane = _mm256_srlv_epi32(_mm256_set1_epi32(static_cast<int>(*order)), _mm256_slli_epi32(iota, 2));
  const __m256i all = _mm256_permutexvar_epi32(lane, _mm256_load_si256(reinterpret_cast<const __m256i*>(child)));
  const __m256 sorted_near = _mm256_permutexvar_ps(lane, near.v);
  const __m256 sorted_far = _mm256_permutexvar_ps(lane, far.v);
  const __mmask8 hit = _mm256_cmp_ps_mask(sorted_near, sorted_far, _CMP_LE_OQ);
  const __m256i kept = _mm256_maskz_compress_epi32(hit, all);
  next = static_cast<Ref>(_mm256_cvtsi256_si32(kept));
  const int count = __builtin_popcount(hit);
  const __m256i reversed = _mm256_sub_epi32(_mm256_set1_epi32(count - 1), iota);
  _mm256_storeu_ps(distances, _mm256_permutexvar_ps(reversed, _mm256_maskz_compress_ps(hit, sorted_near)));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(refs), _mm256_permutexvar_epi32(reversed, kept));
  return count;
}
/// Puts the children with near <= far on the stack, the nearest on top; returns how many there are.
inline int push_all(Float8 near, Float8 far, const Ref* child, const std::uint32_t* order, float* distances,
                    Ref* refs) {
  const __m256i shifts = _mm256_setr_epi32(28, 24, 20, 16, 12, 8, 4, 0);
  const __m256i lane = _mm256_srlv_epi32(_mm256_set1_epi32(static_cast<int>(*order)), shifts);
  const __m256i all = _mm256_permutexvar_epi32(lane, _mm256_load_si256(reinterpret_cast<const __m256i*>(child)));
  const __m256 sorted_near = _mm256_permutexvar_ps(lane, near.v);
  const __mmask8 hit = _mm256_cmp_ps_mask(sorted_near, _mm256_permutexvar_ps(lane, far.v), _CMP_LE_OQ);
  _mm256_storeu_ps(distances, _mm256_maskz_compress_ps(hit, sorted_near));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(refs), _mm256_maskz_compress_epi32(hit, all));
  return __builtin_popcount(hit);
}
/// The same without an order and distances.
inline int push_all(Float8 near, Float8 far, const Ref* child, Ref* refs) {
  const __mmask8 hit = _mm256_cmp_ps_mask(near.v, far.v, _CMP_LE_OQ);
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(refs),
                      _mm256_maskz_compress_epi32(hit, _mm256_load_si256(reinterpret_cast<const __m256i*>(child))));
  return __builtin_popcount(hit);
}
/// push_ordered() without an order.
inline int push_any(Float8 near, Float8 far, const Ref* child, Ref* refs, Ref& next) {
  const __mmask8 hit = _mm256_cmp_ps_mask(near.v, far.v, _CMP_LE_OQ);
  const __m256i kept =
      _mm256_maskz_compress_epi32(hit, _mm256_load_si256(reinterpret_cast<const __m256i*>(child)));
  next = static_cast<Ref>(_mm256_cvtsi256_si32(kept));
  // All but the first.
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(refs), _mm256_alignr_epi32(kept, kept, 1));
  return __builtin_popcount(hit);
}

}  // namespace
}  // namespace raylab::bvh
