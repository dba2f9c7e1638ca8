#pragma once
// The registers of an instruction set as GCC's vector types, and the operations that need its own instructions. Only
// vector.hpp includes this; what GCC's operators give is not here.
#include <cstdint>

#if defined(__x86_64__)
#include <immintrin.h>
#elif defined(__aarch64__)
#include <arm_neon.h>
#else
#error "no vectors for this processor"
#endif

namespace raylab {
namespace {

/// Floats of the widest register.
#if defined(__AVX512F__)
constexpr int kLanes = 16;
#elif defined(__AVX2__)
constexpr int kLanes = 8;
#else
constexpr int kLanes = 4;
#endif

/// A register of N floats, and what has the same size.
template <int N>
struct Register;
#define RAYLAB_REGISTER(N)                                            \
  template <>                                                         \
  struct Register<N> {                                                \
    using Float = float __attribute__((vector_size(N * 4)));          \
    using Int = std::int32_t __attribute__((vector_size(N * 4)));     \
    using UInt = std::uint32_t __attribute__((vector_size(N * 4)));   \
    using Double = double __attribute__((vector_size(N * 4)));        \
    using Long = std::int64_t __attribute__((vector_size(N * 4)));    \
    using Bytes = std::uint8_t __attribute__((vector_size(N * 4)));   \
    using HalfInt = std::int32_t __attribute__((vector_size(N * 2))); \
  }
RAYLAB_REGISTER(4);
RAYLAB_REGISTER(8);
RAYLAB_REGISTER(16);
#undef RAYLAB_REGISTER
using Float4 = Register<4>::Float;
using Float8 = Register<8>::Float;
using Float16 = Register<16>::Float;
using Double2 = Register<4>::Double;
using Double4 = Register<8>::Double;
using Double8 = Register<16>::Double;

namespace native {

// --- x86: SSE4.2, AVX2, AVX-512 (F, BW, DQ, VL)
// -----------------------------------------------------------------------
#if defined(__x86_64__)

inline Float4 min(Float4 a, Float4 b) { return _mm_min_ps(a, b); }
inline Float4 max(Float4 a, Float4 b) { return _mm_max_ps(a, b); }
inline Float4 sqrt(Float4 x) { return _mm_sqrt_ps(x); }
inline Float4 floor(Float4 x) { return _mm_floor_ps(x); }
inline Double2 sqrt(Double2 x) { return _mm_sqrt_pd(x); }
inline std::uint32_t bits(Register<4>::Int mask) {
  return static_cast<std::uint32_t>(_mm_movemask_ps(reinterpret_cast<__m128>(mask)));
}
inline void widen(Float4 x, Double2& low, Double2& high) {
  low = _mm_cvtps_pd(x);
  high = _mm_cvtps_pd(_mm_movehl_ps(x, x));
}
inline Float4 narrow(Double2 low, Double2 high) { return _mm_movelh_ps(_mm_cvtpd_ps(low), _mm_cvtpd_ps(high)); }
inline __m128i shuffle_bytes(__m128i x, __m128i index) { return _mm_shuffle_epi8(x, index); }
inline __m128i repeat(__m128i x, Float4) { return x; }

#if defined(__AVX2__)
inline Float8 min(Float8 a, Float8 b) { return _mm256_min_ps(a, b); }
inline Float8 max(Float8 a, Float8 b) { return _mm256_max_ps(a, b); }
inline Float8 sqrt(Float8 x) { return _mm256_sqrt_ps(x); }
inline Float8 floor(Float8 x) { return _mm256_floor_ps(x); }
inline Double4 sqrt(Double4 x) { return _mm256_sqrt_pd(x); }
inline std::uint32_t bits(Register<8>::Int mask) {
  return static_cast<std::uint32_t>(_mm256_movemask_ps(reinterpret_cast<__m256>(mask)));
}
inline void widen(Float8 x, Double4& low, Double4& high) {
  low = _mm256_cvtps_pd(_mm256_castps256_ps128(x));
  high = _mm256_cvtps_pd(_mm256_extractf128_ps(x, 1));
}
inline Float8 narrow(Double4 low, Double4 high) {
  return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm256_cvtpd_ps(low)), _mm256_cvtpd_ps(high), 1);
}
inline __m256i shuffle_bytes(__m256i x, __m256i index) { return _mm256_shuffle_epi8(x, index); }
inline __m256i repeat(__m128i x, Float8) { return _mm256_broadcastsi128_si256(x); }
inline Float8 permute(Float8 x, __m256i index) { return _mm256_permutevar8x32_ps(x, index); }
#endif

#if defined(__AVX512F__)
inline Float16 min(Float16 a, Float16 b) { return _mm512_min_ps(a, b); }
inline Float16 max(Float16 a, Float16 b) { return _mm512_max_ps(a, b); }
inline Float16 sqrt(Float16 x) { return _mm512_sqrt_ps(x); }
inline Float16 floor(Float16 x) { return _mm512_roundscale_ps(x, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC); }
inline Double8 sqrt(Double8 x) { return _mm512_sqrt_pd(x); }
inline void widen(Float16 x, Double8& low, Double8& high) {
  low = _mm512_cvtps_pd(_mm512_castps512_ps256(x));
  high = _mm512_cvtps_pd(_mm512_extractf32x8_ps(x, 1));
}
inline Float16 narrow(Double8 low, Double8 high) {
  return _mm512_insertf32x8(_mm512_castps256_ps512(_mm512_cvtpd_ps(low)), _mm512_cvtpd_ps(high), 1);
}
inline __m512i shuffle_bytes(__m512i x, __m512i index) { return _mm512_shuffle_epi8(x, index); }
inline __m512i repeat(__m128i x, Float16) { return _mm512_broadcast_i32x4(x); }
template <int op>
__mmask8 compare(Float8 a, Float8 b) {
  return _mm256_cmp_ps_mask(a, b, op);
}
template <int op>
__mmask16 compare(Float16 a, Float16 b) {
  return _mm512_cmp_ps_mask(a, b, op);
}
inline Float8 blend(__mmask8 m, Float8 yes, Float8 no) { return _mm256_mask_blend_ps(m, no, yes); }
inline Float16 blend(__mmask16 m, Float16 yes, Float16 no) { return _mm512_mask_blend_ps(m, no, yes); }
#endif

// --- 64-bit Arm: NEON
// -------------------------------------------------------------------------------------------------
#else

// NEON's own minimum and maximum give NaN where either number is NaN.
inline Float4 min(Float4 a, Float4 b) { return a < b ? a : b; }
inline Float4 max(Float4 a, Float4 b) { return a > b ? a : b; }
inline Float4 sqrt(Float4 x) { return vsqrtq_f32(x); }
inline Float4 floor(Float4 x) { return vrndmq_f32(x); }
inline Double2 sqrt(Double2 x) { return vsqrtq_f64(x); }
inline std::uint32_t bits(Register<4>::Int mask) {
  const Register<4>::UInt weights = {1, 2, 4, 8};
  return vaddvq_u32(reinterpret_cast<Register<4>::UInt>(mask) & weights);
}
inline void widen(Float4 x, Double2& low, Double2& high) {
  low = vcvt_f64_f32(vget_low_f32(x));
  high = vcvt_high_f64_f32(x);
}
inline Float4 narrow(Double2 low, Double2 high) { return vcvt_high_f32_f64(vcvt_f32_f64(low), high); }

#endif

}  // namespace native
}  // namespace
}  // namespace raylab
