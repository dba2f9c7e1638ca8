#pragma once
// Vectors of 4, 8 or 16 floats: the vocabulary of lanes.hpp, and what only vectors have. A vector that fits no register
// is a pair of halves. No operation rounds differently from its scalar namesake, and none contracts a product and a sum
// but multiply_add(), which says so.
#include <type_traits>

#include "lanes.hpp"
#include "registers.hpp"

namespace raylab {
namespace {

/// One truth value a lane. The primary templates here are pairs of halves; those of registers follow.
template <int N>
struct Mask {
  Mask<N / 2> low, high;
  static Mask of(std::uint32_t bits) { return {Mask<N / 2>::of(bits), Mask<N / 2>::of(bits >> (N / 2))}; }
  /// Bit i for lane i.
  std::uint32_t bits() const { return low.bits() | high.bits() << (N / 2); }
  friend Mask operator&(const Mask& a, const Mask& b) { return {a.low & b.low, a.high & b.high}; }
  friend Mask operator|(const Mask& a, const Mask& b) { return {a.low | b.low, a.high | b.high}; }
  friend Mask operator!(const Mask& a) { return {!a.low, !a.high}; }
  friend bool any(const Mask& a) { return any(a.low | a.high); }
};

#if defined(__AVX512F__)
template <int N>
requires(N <= kLanes) struct Mask<N> {
  using Bits = std::conditional_t<N == 16, __mmask16, __mmask8>;
  Bits v;
  static Mask of(std::uint32_t bits) { return {static_cast<Bits>(bits)}; }
  std::uint32_t bits() const { return v; }
  friend Mask operator&(Mask a, Mask b) { return {static_cast<Bits>(a.v & b.v)}; }
  friend Mask operator|(Mask a, Mask b) { return {static_cast<Bits>(a.v | b.v)}; }
  friend Mask operator^(Mask a, Mask b) { return {static_cast<Bits>(a.v ^ b.v)}; }
  friend Mask operator!(Mask a) { return {static_cast<Bits>(~a.v)}; }
  friend bool any(Mask a) { return a.v != 0; }
};
#else
template <int N>
requires(N <= kLanes) struct Mask<N> {
  using Int = typename Register<N>::Int;
  Int v;
  static Mask of(std::uint32_t bits) {
    Int lanes{};
    for (int i = 0; i < N; ++i) lanes[i] = -static_cast<std::int32_t>(bits >> i & 1u);
    return {lanes};
  }
  std::uint32_t bits() const { return native::bits(v); }
  friend Mask operator&(Mask a, Mask b) { return {a.v & b.v}; }
  friend Mask operator|(Mask a, Mask b) { return {a.v | b.v}; }
  friend Mask operator^(Mask a, Mask b) { return {a.v ^ b.v}; }
  friend Mask operator!(Mask a) { return {~a.v}; }
  friend bool any(Mask a) { return a.bits() != 0; }
};
#endif

template <int N>
struct UInt;
template <int N>
requires(N <= kLanes) struct UInt<N> {
  using Lanes = typename Register<N>::UInt;
  Lanes v;
  UInt() = default;
  UInt(Lanes x) : v(x) {}
  UInt(std::uint32_t x) : v(Lanes{} + x) {}
  static UInt load(const std::uint32_t* p) {
    UInt r;
    __builtin_memcpy(&r.v, p, sizeof r.v);
    return r;
  }
  void store(std::uint32_t* p) const { __builtin_memcpy(p, &v, sizeof v); }
  friend UInt operator+(UInt a, UInt b) { return a.v + b.v; }
  friend UInt operator*(UInt a, UInt b) { return a.v * b.v; }
  friend UInt operator^(UInt a, UInt b) { return a.v ^ b.v; }
  friend UInt operator|(UInt a, UInt b) { return a.v | b.v; }
  friend UInt operator&(UInt a, UInt b) { return a.v & b.v; }
  friend UInt operator>>(UInt a, int n) { return a.v >> n; }
  friend UInt operator<<(UInt a, int n) { return a.v << n; }
  UInt& operator^=(UInt b) { return *this = *this ^ b; }
  UInt& operator*=(UInt b) { return *this = *this * b; }
  UInt& operator+=(UInt b) { return *this = *this + b; }
  friend UInt select(Mask<N> m, UInt yes, UInt no) {
#if defined(__AVX512F__)
    using F = typename Register<N>::Float;
    return Lanes(native::blend(m.v, F(yes.v), F(no.v)));
#else
    return Lanes(m.v ? typename Register<N>::Int(yes.v) : typename Register<N>::Int(no.v));
#endif
  }
};

template <int N>
struct Double;

template <int N>
struct Float {
  using Mask = raylab::Mask<N>;
  using UInt = raylab::UInt<N>;
  using Double = raylab::Double<N>;
  using Half = Float<N / 2>;
  static constexpr int kSize = N;

  Half low, high;
  Float() = default;
  Float(const Half& l, const Half& h) : low(l), high(h) {}
  Float(float x) : low(x), high(x) {}
  static Float load(const float* p) { return {Half::load(p), Half::load(p + N / 2)}; }
  void store(float* p) const {
    low.store(p);
    high.store(p + N / 2);
  }
  friend Float operator+(const Float& a, const Float& b) { return {a.low + b.low, a.high + b.high}; }
  friend Float operator-(const Float& a, const Float& b) { return {a.low - b.low, a.high - b.high}; }
  friend Float operator*(const Float& a, const Float& b) { return {a.low * b.low, a.high * b.high}; }
  friend Float operator/(const Float& a, const Float& b) { return {a.low / b.low, a.high / b.high}; }
  friend Mask operator<(const Float& a, const Float& b) { return {a.low < b.low, a.high < b.high}; }
  friend Mask operator<=(const Float& a, const Float& b) { return {a.low <= b.low, a.high <= b.high}; }
  friend Mask operator!=(const Float& a, const Float& b) { return {a.low != b.low, a.high != b.high}; }
  friend Float min(const Float& a, const Float& b) { return {min(a.low, b.low), min(a.high, b.high)}; }
  friend Float max(const Float& a, const Float& b) { return {max(a.low, b.low), max(a.high, b.high)}; }
  friend Float abs(const Float& x) { return {abs(x.low), abs(x.high)}; }
};

template <int N>
requires(N <= kLanes) struct Float<N> {
  using Mask = raylab::Mask<N>;
  using UInt = raylab::UInt<N>;
  using Double = raylab::Double<N>;
  using Lanes = typename Register<N>::Float;
  using Int = typename Register<N>::Int;
  static constexpr int kSize = N;

  Lanes v;
  Float() = default;
  Float(Lanes x) : v(x) {}
  Float(float x) : v(x - Lanes{}) {}  // x - 0 is x, -0 too
  static Float of(float a, float b, float c, float d) requires(N == 4) { return Lanes{a, b, c, d}; }
  static Float load(const float* p) {
    Float r;
    __builtin_memcpy(&r.v, p, sizeof r.v);
    return r;
  }
  void store(float* p) const { __builtin_memcpy(p, &v, sizeof v); }
  friend Float operator+(Float a, Float b) { return a.v + b.v; }
  friend Float operator-(Float a, Float b) { return a.v - b.v; }
  friend Float operator*(Float a, Float b) { return a.v * b.v; }
  friend Float operator/(Float a, Float b) { return a.v / b.v; }
  friend Float operator-(Float a) { return -a.v; }
  Float& operator+=(Float b) { return *this = *this + b; }
  Float& operator*=(Float b) { return *this = *this * b; }
  Float& operator/=(Float b) { return *this = *this / b; }
#if defined(__AVX512F__)
  friend Mask operator<(Float a, Float b) { return {native::compare<_CMP_LT_OQ>(a.v, b.v)}; }
  friend Mask operator<=(Float a, Float b) { return {native::compare<_CMP_LE_OQ>(a.v, b.v)}; }
  friend Mask operator>(Float a, Float b) { return {native::compare<_CMP_GT_OQ>(a.v, b.v)}; }
  friend Mask operator>=(Float a, Float b) { return {native::compare<_CMP_GE_OQ>(a.v, b.v)}; }
  friend Mask operator==(Float a, Float b) { return {native::compare<_CMP_EQ_OQ>(a.v, b.v)}; }
  friend Mask operator!=(Float a, Float b) { return {native::compare<_CMP_NEQ_UQ>(a.v, b.v)}; }
  friend Float select(Mask m, Float yes, Float no) { return native::blend(m.v, yes.v, no.v); }
#else
  friend Mask operator<(Float a, Float b) { return {a.v < b.v}; }
  friend Mask operator<=(Float a, Float b) { return {a.v <= b.v}; }
  friend Mask operator>(Float a, Float b) { return {a.v > b.v}; }
  friend Mask operator>=(Float a, Float b) { return {a.v >= b.v}; }
  friend Mask operator==(Float a, Float b) { return {a.v == b.v}; }
  friend Mask operator!=(Float a, Float b) { return {a.v != b.v}; }
  friend Float select(Mask m, Float yes, Float no) { return m.v ? yes.v : no.v; }
#endif
  friend Float min(Float a, Float b) { return native::min(a.v, b.v); }
  friend Float max(Float a, Float b) { return native::max(a.v, b.v); }
  friend Float abs(Float x) { return Lanes(Int(x.v) & 0x7fffffff); }
  friend Float sqrt(Float x) { return native::sqrt(x.v); }
  friend Float floor(Float x) { return native::floor(x.v); }
  friend Float copysign(Float size, Float sign) {
    return Lanes((Int(size.v) & 0x7fffffff) | (Int(sign.v) & static_cast<std::int32_t>(0x80000000u)));
  }
  /// a b + c, rounded once or, where the instruction set has no such operation, twice: for bounds, not for results.
  friend Float multiply_add(Float a, Float b, Float c) {
#if defined(__AVX512F__)
    if constexpr (N == 16) return _mm512_fmadd_ps(a.v, b.v, c.v);
#endif
    return a * b + c;
  }
};
template <int N>
Float<N> to_float(const UInt<N>& x) {
  return __builtin_convertvector(typename Register<N>::Int(x.v), typename Register<N>::Float);
}
/// Bit i set: lane i has the sign of a negative number, as -0 has.
inline std::uint32_t sign_bits(Float<4> x) {
#if defined(__x86_64__)
  return native::bits(Register<4>::Int(x.v));
#else
  return native::bits(Register<4>::Int(x.v) >> 31);
#endif
}
/// The next float towards -infinity, of positive numbers.
template <int N>
Float<N> next_down_positive(Float<N> x) {
  return typename Register<N>::Float(typename Register<N>::Int(x.v) - 1);
}

/// The least and the greatest of all lanes, none of which is NaN.
inline float least(Float<4> x) {
  const Float<4> two = min(x, Float<4>(__builtin_shufflevector(x.v, x.v, 2, 3, 0, 1)));
  return min(two.v[0], two.v[1]);
}
inline float greatest(Float<4> x) {
  const Float<4> two = max(x, Float<4>(__builtin_shufflevector(x.v, x.v, 2, 3, 0, 1)));
  return max(two.v[0], two.v[1]);
}
#if defined(__AVX2__)
inline Float<4> low_half(Float<8> x) { return __builtin_shufflevector(x.v, x.v, 0, 1, 2, 3); }
inline Float<4> high_half(Float<8> x) { return __builtin_shufflevector(x.v, x.v, 4, 5, 6, 7); }
inline float least(Float<8> x) { return least(min(low_half(x), high_half(x))); }
inline float greatest(Float<8> x) { return greatest(max(low_half(x), high_half(x))); }
#endif
#if defined(__AVX512F__)
inline Float<8> low_half(Float<16> x) { return __builtin_shufflevector(x.v, x.v, 0, 1, 2, 3, 4, 5, 6, 7); }
inline Float<8> high_half(Float<16> x) { return __builtin_shufflevector(x.v, x.v, 8, 9, 10, 11, 12, 13, 14, 15); }
inline float least(Float<16> x) { return least(min(low_half(x), high_half(x))); }
inline float greatest(Float<16> x) { return greatest(max(low_half(x), high_half(x))); }
#endif

/// As many doubles as Float<N> has floats, in two registers.
template <int N>
requires(N <= kLanes) struct Double<N> {
  using Mask = raylab::Mask<N>;
  using Half = typename Register<N>::Double;
  using Long = typename Register<N>::Long;

  Half low, high;
  Double() = default;
  Double(Half l, Half h) : low(l), high(h) {}
  Double(double x) : low(x - Half{}), high(x - Half{}) {}
  explicit Double(Float<N> x) { native::widen(x.v, low, high); }
  /// Rounded to nearest.
  friend Float<N> to_float(const Double& x) { return native::narrow(x.low, x.high); }
  friend Double operator+(const Double& a, const Double& b) { return {a.low + b.low, a.high + b.high}; }
  friend Double operator-(const Double& a, const Double& b) { return {a.low - b.low, a.high - b.high}; }
  friend Double operator-(const Double& a) { return {-a.low, -a.high}; }
  friend Double operator*(const Double& a, const Double& b) { return {a.low * b.low, a.high * b.high}; }
  friend Double operator/(const Double& a, const Double& b) { return {a.low / b.low, a.high / b.high}; }
  friend Mask operator<(const Double& a, const Double& b) {
#if defined(__AVX512F__)
    return Mask::of(_mm512_cmp_pd_mask(a.low, b.low, _CMP_LT_OQ) |
                    static_cast<std::uint32_t>(_mm512_cmp_pd_mask(a.high, b.high, _CMP_LT_OQ)) << 8);
#else
    using HalfInt = typename Register<N>::HalfInt;
    const HalfInt halves[2] = {__builtin_convertvector(a.low < b.low, HalfInt),
                               __builtin_convertvector(a.high < b.high, HalfInt)};
    Mask m;
    __builtin_memcpy(&m.v, halves, sizeof m.v);
    return m;
#endif
  }
  friend Double abs(const Double& x) {
    constexpr std::int64_t all_but_sign = 0x7fffffffffffffff;
    return {Half(Long(x.low) & all_but_sign), Half(Long(x.high) & all_but_sign)};
  }
  friend Double sqrt(const Double& x) { return {native::sqrt(x.low), native::sqrt(x.high)}; }
  friend Double copysign(const Double& size, const Double& sign) {
    constexpr std::int64_t bit = std::int64_t{1} << 63;
    return {Half((Long(size.low) & ~bit) | (Long(sign.low) & bit)),
            Half((Long(size.high) & ~bit) | (Long(sign.high) & bit))};
  }
  friend Double min(const Double& a, const Double& b) {
    return {a.low < b.low ? a.low : b.low, a.high < b.high ? a.high : b.high};
  }
  friend Double max(const Double& a, const Double& b) {
    return {a.low > b.low ? a.low : b.low, a.high > b.high ? a.high : b.high};
  }
};

/// The vectors that fill a register of this instruction set: what a batch of paths or rays is handled in.
using Wide = Float<kLanes>;
using WideUInt = UInt<kLanes>;
using WideMask = Mask<kLanes>;
using WideDouble = Double<kLanes>;
using WideVec2 = Vec2<Wide>;
using WideVec3 = Vec3<Wide>;

/// Whether an operation on sixteen floats costs about as much as one on a single float.
constexpr bool kSixteenAtOnce = kLanes == 16;

/// The first `count` lanes.
inline WideMask first_lanes(std::size_t count) { return WideMask::of((1u << (count < kLanes ? count : kLanes)) - 1u); }
/// From arrays of x, y and z.
inline WideVec3 load3(const float* x, const float* y, const float* z) {
  return {Wide::load(x), Wide::load(y), Wide::load(z)};
}

/// As the function of the same name in random.hpp. The halves of each byte are looked up in a table of sixteen, and the
/// bytes change places.
inline WideUInt reverse_bits(WideUInt x) {
#if defined(__x86_64__)
  const Wide size(0.0f);
  const auto swapped_bytes =
      native::repeat(_mm_setr_epi8(3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12), size.v);
  const auto to_high = native::repeat(_mm_setr_epi8(0x00, -0x80, 0x40, -0x40, 0x20, -0x60, 0x60, -0x20, 0x10, -0x70,
                                                    0x50, -0x30, 0x30, -0x50, 0x70, -0x10),
                                      size.v);
  const auto to_low = native::repeat(_mm_setr_epi8(0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15), size.v);
  using Bytes = std::remove_const_t<decltype(swapped_bytes)>;
  const auto bytes = [](WideUInt u) { return reinterpret_cast<Bytes>(u.v); };
  const WideUInt high = reinterpret_cast<WideUInt::Lanes>(native::shuffle_bytes(to_high, bytes(x & 0x0f0f0f0fu)));
  const WideUInt low = reinterpret_cast<WideUInt::Lanes>(native::shuffle_bytes(to_low, bytes(x >> 4 & 0x0f0f0f0fu)));
  return reinterpret_cast<WideUInt::Lanes>(native::shuffle_bytes(bytes(high | low), swapped_bytes));
#else
  return WideUInt::Lanes(vrev32q_u8(vrbitq_u8(Register<4>::Bytes(x.v))));
#endif
}

}  // namespace
}  // namespace raylab
