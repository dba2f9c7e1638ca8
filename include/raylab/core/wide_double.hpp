#pragma once
// Vectors of doubles beside those of wide.hpp, for what floats cannot decide; as local to the including file.
#include "raylab/core/wide.hpp"

namespace raylab {
namespace {

/// As many doubles as there are lanes.
struct WideDouble {
  using Half = double __attribute__((vector_size(kLanes * 4)));
  Half low, high;
  WideDouble(Half l, Half h) : low(l), high(h) {}
  WideDouble(double x) : low(x - Half{}), high(x - Half{}) {}
  explicit WideDouble(Wide x) {
#if defined(__AVX512F__)
    low = _mm512_cvtps_pd(_mm512_castps512_ps256(x.v));
    high = _mm512_cvtps_pd(_mm512_extractf32x8_ps(x.v, 1));
#elif defined(__AVX2__)
    low = _mm256_cvtps_pd(_mm256_castps256_ps128(x.v));
    high = _mm256_cvtps_pd(_mm256_extractf128_ps(x.v, 1));
#else
    low = _mm_cvtps_pd(x.v);
    high = _mm_cvtps_pd(_mm_movehl_ps(x.v, x.v));
#endif
  }
  /// Rounded to nearest.
  Wide to_float() const {
#if defined(__AVX512F__)
    return _mm512_insertf32x8(_mm512_castps256_ps512(_mm512_cvtpd_ps(low)), _mm512_cvtpd_ps(high), 1);
#elif defined(__AVX2__)
    return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm256_cvtpd_ps(low)), _mm256_cvtpd_ps(high), 1);
#else
    return _mm_movelh_ps(_mm_cvtpd_ps(low), _mm_cvtpd_ps(high));
#endif
  }
  friend WideDouble operator+(const WideDouble& a, const WideDouble& b) {
    return {a.low + b.low, a.high + b.high};
  }
  friend WideDouble operator-(const WideDouble& a, const WideDouble& b) {
    return {a.low - b.low, a.high - b.high};
  }
  friend WideDouble operator-(const WideDouble& a) { return {-a.low, -a.high}; }
  friend WideDouble operator*(const WideDouble& a, const WideDouble& b) {
    return {a.low * b.low, a.high * b.high};
  }
  friend WideDouble operator/(const WideDouble& a, const WideDouble& b) {
    return {a.low / b.low, a.high / b.high};
  }
  friend WideMask operator<(const WideDouble& a, const WideDouble& b) {
#if defined(__AVX512F__)
    return WideMask::of(_mm512_cmp_pd_mask(a.low, b.low, _CMP_LT_OQ) |
                        static_cast<std::uint32_t>(_mm512_cmp_pd_mask(a.high, b.high, _CMP_LT_OQ)) << 8);
#else
    using HalfInts = std::int32_t __attribute__((vector_size(kLanes * 2)));
    const HalfInts halves[2] = {__builtin_convertvector(a.low < b.low, HalfInts),
                                __builtin_convertvector(a.high < b.high, HalfInts)};
    WideMask m;
    __builtin_memcpy(&m.v, halves, sizeof m.v);
    return m;
#endif
  }
  friend WideDouble magnitude(const WideDouble& x) {
    using Bits = std::int64_t __attribute__((vector_size(kLanes * 4)));
    constexpr std::int64_t all_but_sign = 0x7fffffffffffffff;
    return {Half(Bits(x.low) & all_but_sign), Half(Bits(x.high) & all_but_sign)};
  }
  friend WideDouble square_root(const WideDouble& x) {
#if defined(__AVX512F__)
    return {_mm512_sqrt_pd(x.low), _mm512_sqrt_pd(x.high)};
#elif defined(__AVX2__)
    return {_mm256_sqrt_pd(x.low), _mm256_sqrt_pd(x.high)};
#else
    return {_mm_sqrt_pd(x.low), _mm_sqrt_pd(x.high)};
#endif
  }
  /// x, or where b is negative -x.
  friend WideDouble flipped_with(const WideDouble& x, const WideDouble& b) {
    using Bits = std::int64_t __attribute__((vector_size(kLanes * 4)));
    constexpr std::int64_t sign = std::int64_t{1} << 63;
    return {Half(Bits(x.low) ^ (Bits(b.low) & sign)), Half(Bits(x.high) ^ (Bits(b.high) & sign))};
  }
  /// a, but no less than b; and no more.
  friend WideDouble at_least(const WideDouble& a, const WideDouble& b) {
    return {a.low < b.low ? b.low : a.low, a.high < b.high ? b.high : a.high};
  }
  friend WideDouble at_most(const WideDouble& a, const WideDouble& b) {
    return {b.low < a.low ? b.low : a.low, b.high < a.high ? b.high : a.high};
  }
};

}  // namespace
}  // namespace raylab
