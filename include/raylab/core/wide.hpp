#pragma once
// Vectors of as many floats as the instruction set has, for files that are compiled once for each set. All of it
// is local to the including file: two files' versions have nothing to do with each other. No operation here rounds
// differently from its scalar namesake in lanes.hpp.
#include <immintrin.h>

#include <type_traits>

#include "raylab/core/lanes.hpp"

namespace raylab {
namespace {

#if defined(__AVX512F__)
constexpr int kLanes = 16;
#elif defined(__AVX2__)
constexpr int kLanes = 8;
#else
constexpr int kLanes = 4;
#endif

using FloatVector = float __attribute__((vector_size(kLanes * 4)));
using IntVector = std::int32_t __attribute__((vector_size(kLanes * 4)));
using UIntVector = std::uint32_t __attribute__((vector_size(kLanes * 4)));

/// One truth value a lane.
struct WideMask {
#if defined(__AVX512F__)
  __mmask16 v;
  static WideMask of(std::uint32_t bits) { return {static_cast<__mmask16>(bits)}; }
  std::uint32_t bits() const { return v; }
  friend WideMask operator&(WideMask a, WideMask b) { return {static_cast<__mmask16>(a.v & b.v)}; }
  friend WideMask operator|(WideMask a, WideMask b) { return {static_cast<__mmask16>(a.v | b.v)}; }
  friend WideMask operator^(WideMask a, WideMask b) { return {static_cast<__mmask16>(a.v ^ b.v)}; }
  friend WideMask operator!(WideMask a) { return {static_cast<__mmask16>(~a.v)}; }
#else
  IntVector v;
  static WideMask of(std::uint32_t bits) {
    IntVector one{};
    for (int i = 0; i < kLanes; ++i) one[i] = -static_cast<std::int32_t>(bits >> i & 1u);
    return {one};
  }
  std::uint32_t bits() const {
#if defined(__AVX2__)
    return static_cast<std::uint32_t>(_mm256_movemask_ps(reinterpret_cast<__m256>(v)));
#else
    return static_cast<std::uint32_t>(_mm_movemask_ps(reinterpret_cast<__m128>(v)));
#endif
  }
  friend WideMask operator&(WideMask a, WideMask b) { return {a.v & b.v}; }
  friend WideMask operator|(WideMask a, WideMask b) { return {a.v | b.v}; }
  friend WideMask operator^(WideMask a, WideMask b) { return {a.v ^ b.v}; }
  friend WideMask operator!(WideMask a) { return {~a.v}; }
#endif
};
inline bool any(WideMask m) { return m.bits() != 0; }
/// The first `count` lanes.
inline WideMask first_lanes(std::size_t count) {
  return WideMask::of((1u << (count < kLanes ? count : kLanes)) - 1u);
}

struct WideVec2;
struct WideVec3;

struct WideUInt {
  UIntVector v;
  WideUInt() = default;
  WideUInt(UIntVector x) : v(x) {}
  WideUInt(std::uint32_t x) : v(UIntVector{} + x) {}
  static WideUInt load(const std::uint32_t* p) {
    WideUInt r;
    __builtin_memcpy(&r.v, p, sizeof r.v);
    return r;
  }
  void store(std::uint32_t* p) const { __builtin_memcpy(p, &v, sizeof v); }
  friend WideUInt operator+(WideUInt a, WideUInt b) { return a.v + b.v; }
  friend WideUInt operator*(WideUInt a, WideUInt b) { return a.v * b.v; }
  friend WideUInt operator^(WideUInt a, WideUInt b) { return a.v ^ b.v; }
  friend WideUInt operator|(WideUInt a, WideUInt b) { return a.v | b.v; }
  friend WideUInt operator&(WideUInt a, WideUInt b) { return a.v & b.v; }
  friend WideUInt operator>>(WideUInt a, int n) { return a.v >> n; }
  friend WideUInt operator<<(WideUInt a, int n) { return a.v << n; }
  WideUInt& operator^=(WideUInt b) { return *this = *this ^ b; }
  WideUInt& operator*=(WideUInt b) { return *this = *this * b; }
  WideUInt& operator+=(WideUInt b) { return *this = *this + b; }
};

struct Wide {
  using Mask = WideMask;
  using UInt = WideUInt;
  using Vec2 = WideVec2;
  using Vec3 = WideVec3;

  FloatVector v;
  Wide() = default;
  Wide(FloatVector x) : v(x) {}
  Wide(float x) : v(x - FloatVector{}) {}  // x - 0 is x, -0 too
  static Wide load(const float* p) {
    Wide r;
    __builtin_memcpy(&r.v, p, sizeof r.v);
    return r;
  }
  void store(float* p) const { __builtin_memcpy(p, &v, sizeof v); }
  friend Wide operator+(Wide a, Wide b) { return a.v + b.v; }
  friend Wide operator-(Wide a, Wide b) { return a.v - b.v; }
  friend Wide operator*(Wide a, Wide b) { return a.v * b.v; }
  friend Wide operator/(Wide a, Wide b) { return a.v / b.v; }
  friend Wide operator-(Wide a) { return -a.v; }
  Wide& operator+=(Wide b) { return *this = *this + b; }
  Wide& operator*=(Wide b) { return *this = *this * b; }
  Wide& operator/=(Wide b) { return *this = *this / b; }
#if defined(__AVX512F__)
  template <int op>
  static WideMask compare(Wide a, Wide b) {
    return {_mm512_cmp_ps_mask(a.v, b.v, op)};
  }
  friend WideMask operator<(Wide a, Wide b) { return compare<_CMP_LT_OQ>(a, b); }
  friend WideMask operator<=(Wide a, Wide b) { return compare<_CMP_LE_OQ>(a, b); }
  friend WideMask operator>(Wide a, Wide b) { return compare<_CMP_GT_OQ>(a, b); }
  friend WideMask operator>=(Wide a, Wide b) { return compare<_CMP_GE_OQ>(a, b); }
  friend WideMask operator==(Wide a, Wide b) { return compare<_CMP_EQ_OQ>(a, b); }
  friend WideMask operator!=(Wide a, Wide b) { return compare<_CMP_NEQ_UQ>(a, b); }
#else
  friend WideMask operator<(Wide a, Wide b) { return {a.v < b.v}; }
  friend WideMask operator<=(Wide a, Wide b) { return {a.v <= b.v}; }
  friend WideMask operator>(Wide a, Wide b) { return {a.v > b.v}; }
  friend WideMask operator>=(Wide a, Wide b) { return {a.v >= b.v}; }
  friend WideMask operator==(Wide a, Wide b) { return {a.v == b.v}; }
  friend WideMask operator!=(Wide a, Wide b) { return {a.v != b.v}; }
#endif
};

inline Wide select(WideMask m, Wide yes, Wide no) {
#if defined(__AVX512F__)
  return _mm512_mask_blend_ps(m.v, no.v, yes.v);
#else
  return m.v ? yes.v : no.v;
#endif
}
inline WideUInt select(WideMask m, WideUInt yes, WideUInt no) {
#if defined(__AVX512F__)
  return reinterpret_cast<UIntVector>(_mm512_mask_blend_epi32(m.v, reinterpret_cast<__m512i>(no.v),
                                                              reinterpret_cast<__m512i>(yes.v)));
#else
  return m.v ? yes.v : no.v;
#endif
}
inline Wide lesser(Wide a, Wide b) {
#if defined(__AVX512F__)
  return _mm512_min_ps(a.v, b.v);
#elif defined(__AVX2__)
  return _mm256_min_ps(a.v, b.v);
#else
  return _mm_min_ps(a.v, b.v);
#endif
}
inline Wide greater(Wide a, Wide b) {
#if defined(__AVX512F__)
  return _mm512_max_ps(a.v, b.v);
#elif defined(__AVX2__)
  return _mm256_max_ps(a.v, b.v);
#else
  return _mm_max_ps(a.v, b.v);
#endif
}
/// a b + c, rounded once or, where the instruction set has no such operation, twice: for bounds, not for results.
inline Wide multiply_add(Wide a, Wide b, Wide c) {
#if defined(__AVX512F__)
  return _mm512_fmadd_ps(a.v, b.v, c.v);
#else
  return a * b + c;
#endif
}
inline Wide square_root(Wide x) {
#if defined(__AVX512F__)
  return _mm512_sqrt_ps(x.v);
#elif defined(__AVX2__)
  return _mm256_sqrt_ps(x.v);
#else
  return _mm_sqrt_ps(x.v);
#endif
}
inline Wide round_down(Wide x) {
#if defined(__AVX512F__)
  return _mm512_roundscale_ps(x.v, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC);
#elif defined(__AVX2__)
  return _mm256_floor_ps(x.v);
#else
  return _mm_floor_ps(x.v);
#endif
}
inline Wide magnitude(Wide x) { return FloatVector(IntVector(x.v) & 0x7fffffff); }
inline Wide with_sign_of(Wide size, Wide sign) {
  return FloatVector((IntVector(size.v) & 0x7fffffff) |
                     (IntVector(sign.v) & static_cast<std::int32_t>(0x80000000u)));
}
inline Wide to_float(WideUInt x) { return __builtin_convertvector(IntVector(x.v), FloatVector); }

/// As the function of the same name in random.hpp. The halves of each byte are looked up in a table of sixteen, and the
/// bytes change places.
inline WideUInt reverse_bits(WideUInt x) {
#if defined(__AVX512F__)
  const auto all = [](__m128i table) { return _mm512_broadcast_i32x4(table); };
  const auto pick = [](__m512i table, __m512i index) { return _mm512_shuffle_epi8(table, index); };
#elif defined(__AVX2__)
  const auto all = [](__m128i table) { return _mm256_broadcastsi128_si256(table); };
  const auto pick = [](__m256i table, __m256i index) { return _mm256_shuffle_epi8(table, index); };
#else
  const auto all = [](__m128i table) { return table; };
  const auto pick = [](__m128i table, __m128i index) { return _mm_shuffle_epi8(table, index); };
#endif
  const auto swapped_bytes = all(_mm_setr_epi8(3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12));
  const auto to_high = all(_mm_setr_epi8(0x00, -0x80, 0x40, -0x40, 0x20, -0x60, 0x60, -0x20, 0x10, -0x70, 0x50, -0x30,
                                         0x30, -0x50, 0x70, -0x10));
  const auto to_low = all(_mm_setr_epi8(0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15));
  using Bytes = decltype(swapped_bytes);
  const auto bytes = [](UIntVector v) { return reinterpret_cast<std::remove_const_t<Bytes>>(v); };
  const UIntVector high = reinterpret_cast<UIntVector>(pick(to_high, bytes(x.v & 0x0f0f0f0fu)));
  const UIntVector low = reinterpret_cast<UIntVector>(pick(to_low, bytes(x.v >> 4 & 0x0f0f0f0fu)));
  return reinterpret_cast<UIntVector>(pick(bytes(high | low), swapped_bytes));
}

/// Of a table, the numbers with these indices. Lanes that are not in the mask are 0 and read nothing.
inline Wide gather(const float* table, WideUInt index, WideMask m) {
#if defined(__AVX512F__)
  return _mm512_mask_i32gather_ps(_mm512_setzero_ps(), m.v, reinterpret_cast<__m512i>(index.v), table, 4);
#elif defined(__AVX2__)
  return _mm256_mask_i32gather_ps(_mm256_setzero_ps(), table, reinterpret_cast<__m256i>(index.v),
                                  reinterpret_cast<__m256>(m.v), 4);
#else
  FloatVector found{};
  for (std::uint32_t bits = m.bits(); bits != 0; bits &= bits - 1) {
    const int i = __builtin_ctz(bits);
    found[i] = table[index.v[i]];
  }
  return found;
#endif
}

/// Of a table of sixteen, aligned to its size, the entries with these indices.
inline Wide look_up16(const float* table, WideUInt index) {
#if defined(__AVX512F__)
  return _mm512_permutexvar_ps(reinterpret_cast<__m512i>(index.v), _mm512_load_ps(table));
#elif defined(__AVX2__)
  return _mm256_i32gather_ps(table, reinterpret_cast<__m256i>(index.v), 4);
#else
  FloatVector found;
  for (int i = 0; i < kLanes; ++i) found[i] = table[index.v[i]];
  return found;
#endif
}
inline WideUInt look_up16(const std::uint8_t* table, WideUInt index) {
#if defined(__AVX512F__)
  const __m512i all = _mm512_cvtepu8_epi32(_mm_load_si128(reinterpret_cast<const __m128i*>(table)));
  return reinterpret_cast<UIntVector>(_mm512_permutexvar_epi32(reinterpret_cast<__m512i>(index.v), all));
#else
  UIntVector found;
  for (int i = 0; i < kLanes; ++i) found[i] = table[index.v[i]];
  return found;
#endif
}

/// The next float towards -infinity, of positive numbers.
inline Wide next_down_positive(Wide x) { return FloatVector(IntVector(x.v) - 1); }

/// Writes the lanes of the mask side by side from p on. Up to kLanes floats there are overwritten.
inline void store_packed(Wide x, WideMask m, float* p) {
#if defined(__AVX512F__)
  _mm512_storeu_ps(p, _mm512_maskz_compress_ps(m.v, x.v));
#else
  for (std::uint32_t bits = m.bits(); bits != 0; bits &= bits - 1) *p++ = x.v[__builtin_ctz(bits)];
#endif
}
inline void store_packed(WideUInt x, WideMask m, std::uint32_t* p) {
#if defined(__AVX512F__)
  _mm512_storeu_si512(p, _mm512_maskz_compress_epi32(m.v, reinterpret_cast<__m512i>(x.v)));
#else
  for (std::uint32_t bits = m.bits(); bits != 0; bits &= bits - 1) *p++ = x.v[__builtin_ctz(bits)];
#endif
}

struct WideVec2 {
  Wide x, y;
};

struct WideVec3 {
  Wide x, y, z;
  WideVec3() = default;
  WideVec3(Wide x_, Wide y_, Wide z_) : x(x_), y(y_), z(z_) {}
  explicit WideVec3(Wide all) : x(all), y(all), z(all) {}
  explicit WideVec3(const vec3& one) : x(one.x), y(one.y), z(one.z) {}
  /// From arrays of x, y and z.
  static WideVec3 load(const float* px, const float* py, const float* pz) {
    return {Wide::load(px), Wide::load(py), Wide::load(pz)};
  }
  friend WideVec3 operator+(const WideVec3& a, const WideVec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend WideVec3 operator-(const WideVec3& a, const WideVec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend WideVec3 operator*(const WideVec3& a, const WideVec3& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
  friend WideVec3 operator*(const WideVec3& a, Wide b) { return {a.x * b, a.y * b, a.z * b}; }
  friend WideVec3 operator*(Wide a, const WideVec3& b) { return {a * b.x, a * b.y, a * b.z}; }
  friend WideVec3 operator/(const WideVec3& a, Wide b) { return {a.x / b, a.y / b, a.z / b}; }
  friend WideVec3 operator-(const WideVec3& a) { return {-a.x, -a.y, -a.z}; }
  WideVec3& operator+=(const WideVec3& b) { return *this = *this + b; }
  WideVec3& operator*=(const WideVec3& b) { return *this = *this * b; }
};
inline Wide dot(const WideVec3& a, const WideVec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline WideVec3 cross(const WideVec3& a, const WideVec3& b) {
  return {a.y * b.z - b.y * a.z, a.z * b.x - b.z * a.x, a.x * b.y - b.x * a.y};
}
inline WideVec3 abs(const WideVec3& a) { return {magnitude(a.x), magnitude(a.y), magnitude(a.z)}; }
inline WideVec3 select(WideMask m, const WideVec3& yes, const WideVec3& no) {
  return {select(m, yes.x, no.x), select(m, yes.y, no.y), select(m, yes.z, no.z)};
}

}  // namespace
}  // namespace raylab
