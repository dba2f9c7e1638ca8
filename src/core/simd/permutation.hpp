#pragma once
// What moves numbers between lanes by index or mask: gathering, small tables, permutations and compression.
#include "vector.hpp"

namespace raylab {
namespace {

/// Of a table, the numbers with these indices. Lanes that are not in the mask are 0 and read nothing.
inline Wide gather(const float* table, WideUInt index, WideMask m) {
#if defined(__AVX512F__)
  return _mm512_mask_i32gather_ps(_mm512_setzero_ps(), m.v, reinterpret_cast<__m512i>(index.v), table, 4);
#elif defined(__AVX2__)
  return _mm256_mask_i32gather_ps(_mm256_setzero_ps(), table, reinterpret_cast<__m256i>(index.v),
                                  reinterpret_cast<__m256>(m.v), 4);
#else
  Wide::Lanes found{};
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
  Wide::Lanes found;
  for (int i = 0; i < kLanes; ++i) found[i] = table[index.v[i]];
  return found;
#endif
}
inline WideUInt look_up16(const std::uint8_t* table, WideUInt index) {
#if defined(__AVX512F__)
  const __m512i all = _mm512_cvtepu8_epi32(_mm_load_si128(reinterpret_cast<const __m128i*>(table)));
  return reinterpret_cast<WideUInt::Lanes>(_mm512_permutexvar_epi32(reinterpret_cast<__m512i>(index.v), all));
#else
  WideUInt::Lanes found;
  for (int i = 0; i < kLanes; ++i) found[i] = table[index.v[i]];
  return found;
#endif
}

/// Writes the lanes of the mask side by side from p on. Up to kLanes numbers there are overwritten.
inline void compress(Wide x, WideMask m, float* p) {
#if defined(__AVX512F__)
  _mm512_storeu_ps(p, _mm512_maskz_compress_ps(m.v, x.v));
#else
  for (std::uint32_t bits = m.bits(); bits != 0; bits &= bits - 1) *p++ = x.v[__builtin_ctz(bits)];
#endif
}
inline void compress(WideUInt x, WideMask m, std::uint32_t* p) {
#if defined(__AVX512F__)
  _mm512_storeu_si512(p, _mm512_maskz_compress_epi32(m.v, reinterpret_cast<__m512i>(x.v)));
#else
  for (std::uint32_t bits = m.bits(); bits != 0; bits &= bits - 1) *p++ = x.v[__builtin_ctz(bits)];
#endif
}

/// Four masks of sixteen, and sixteen triples of indices into them: the triples for which one of the masks, whichever,
/// holds at all three, a bit each. The indices are aligned to 16 bytes.
inline std::uint32_t common_to_all(const std::uint32_t (&masks)[4], const std::uint8_t* a, const std::uint8_t* b,
                                   const std::uint8_t* c) {
  using Bytes = Register<4>::Bytes;
  using Longs = std::uint64_t __attribute__((vector_size(16)));
  constexpr Bytes weights = {1, 2, 4, 8, 16, 32, 64, 128, 1, 2, 4, 8, 16, 32, 64, 128};
  Bytes codes{}, bit = Bytes{} + 1;  // codes: of each index its masks, a bit each
  for (int i = 0; i < 4; ++i, bit += bit) {
    const auto spread = [](std::uint32_t eight) { return (eight & 0xffu) * std::uint64_t{0x0101010101010101}; };
    const Bytes of_mask = Bytes(Longs{spread(masks[i]), spread(masks[i] >> 8)}) & weights;
    codes |= Bytes(of_mask != 0) & bit;
  }
  const auto look_up = [&](const std::uint8_t* index) {
    Bytes at;
    __builtin_memcpy(&at, __builtin_assume_aligned(index, 16), sizeof at);
#if defined(__x86_64__)
    return Bytes(native::shuffle_bytes(reinterpret_cast<__m128i>(codes), reinterpret_cast<__m128i>(at)));
#else
    return Bytes(vqtbl1q_u8(uint8x16_t(codes), uint8x16_t(at)));
#endif
  };
  const Bytes common = Bytes((look_up(a) & look_up(b) & look_up(c)) != 0);
#if defined(__x86_64__)
  return static_cast<std::uint32_t>(_mm_movemask_epi8(reinterpret_cast<__m128i>(common)));
#else
  const uint8x16_t weighted = uint8x16_t(common & weights);
  return vaddv_u8(vget_low_u8(weighted)) | static_cast<std::uint32_t>(vaddv_u8(vget_high_u8(weighted))) << 8;
#endif
}

/// Puts sixteen numbers in the order of a table of sixteen indices, many times.
class Permutation16 {
 public:
#if defined(__AVX512F__)
  explicit Permutation16(const std::uint8_t* index)
      : index_(_mm512_cvtepu8_epi32(_mm_load_si128(reinterpret_cast<const __m128i*>(index)))) {}
  Float<16> operator()(Float<16> x) const { return Float<16>(_mm512_permutexvar_ps(index_, x.v)); }

 private:
  __m512i index_;
#elif defined(__AVX2__)
  explicit Permutation16(const std::uint8_t* index) {
    for (int half = 0; half < 2; ++half) {
      index_[half] = _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(index + 8 * half)));
    }
  }
  Float<16> operator()(const Float<16>& x) const { return {pick(x, index_[0]), pick(x, index_[1])}; }

 private:
  static Float<8> pick(const Float<16>& x, __m256i i) {
    // The permutation looks at three bits of the index, the fourth chooses the half.
    const __m256 from_high = _mm256_castsi256_ps(_mm256_slli_epi32(i, 28));
    return Float<8>(_mm256_blendv_ps(native::permute(x.low.v, i), native::permute(x.high.v, i), from_high));
  }
  __m256i index_[2];
#elif defined(__aarch64__)
  explicit Permutation16(const std::uint8_t* index) {
    // From the number of a float to those of its four bytes.
    const uint8x16_t numbers = vld1q_u8(index);
    const uint8x16_t each = {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};
    const uint8x16_t byte = {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
    for (int i = 0; i < 4; ++i) {
      const uint8x16_t four = vqtbl1q_u8(numbers, vaddq_u8(each, vdupq_n_u8(static_cast<std::uint8_t>(4 * i))));
      bytes_[i] = vaddq_u8(vshlq_n_u8(four, 2), byte);
    }
  }
  Float<16> operator()(const Float<16>& x) const {
    const auto bytes = [](const Float<4>& f) { return vreinterpretq_u8_f32(f.v); };
    const uint8x16x4_t table = {{bytes(x.low.low), bytes(x.low.high), bytes(x.high.low), bytes(x.high.high)}};
    const auto pick = [&](int i) { return Float<4>(vreinterpretq_f32_u8(vqtbl4q_u8(table, bytes_[i]))); };
    return {{pick(0), pick(1)}, {pick(2), pick(3)}};
  }

 private:
  uint8x16_t bytes_[4];
#else
  // There is no permutation across so many lanes: it goes through memory.
  explicit Permutation16(const std::uint8_t* index) : index_(index) {}
  Float<16> operator()(const Float<16>& x) const {
    alignas(16) float from[16], to[16];
    x.store(from);
    for (int i = 0; i < 16; ++i) to[i] = from[index_[i]];
    return Float<16>::load(to);
  }

 private:
  const std::uint8_t* index_;
#endif
};

#if defined(__AVX2__)
/// Eight indices of lanes, packed into four bits each, the first in the lowest; and with the first in the highest.
inline UInt<8> unpack_indices(std::uint32_t packed) {
  return UInt<8>::Lanes(
      _mm256_srlv_epi32(_mm256_set1_epi32(static_cast<int>(packed)), _mm256_setr_epi32(0, 4, 8, 12, 16, 20, 24, 28)));
}
inline UInt<8> unpack_indices_backwards(std::uint32_t packed) {
  return UInt<8>::Lanes(
      _mm256_srlv_epi32(_mm256_set1_epi32(static_cast<int>(packed)), _mm256_setr_epi32(28, 24, 20, 16, 12, 8, 4, 0)));
}
/// The lanes with these indices.
inline Float<8> permute(Float<8> x, UInt<8> index) {
  return Float<8>(native::permute(x.v, reinterpret_cast<__m256i>(index.v)));
}
inline UInt<8> permute(UInt<8> x, UInt<8> index) {
  return UInt<8>::Lanes(
      _mm256_permutevar8x32_epi32(reinterpret_cast<__m256i>(x.v), reinterpret_cast<__m256i>(index.v)));
}

#if !defined(__AVX512F__)
/// For each mask of eight its set bits, ascending, packed.
struct SetBits {
  std::uint32_t of[256];
};
constexpr SetBits make_set_bits() {
  SetBits table{};
  for (std::uint32_t mask = 0; mask < 256; ++mask) {
    std::uint32_t packed = 0, count = 0;
    for (std::uint32_t bit = 0; bit < 8; ++bit) {
      if ((mask >> bit & 1u) != 0) packed |= bit << (4 * count++);
    }
    table.of[mask] = packed;
  }
  return table;
}
constexpr SetBits kSetBits = make_set_bits();
#endif

/// Puts the lanes of a mask side by side, the same ones of several vectors.
class Compression8 {
 public:
#if defined(__AVX512F__)
  explicit Compression8(Mask<8> kept) : kept_(kept) {}
  void store(Float<8> x, float* p) const { _mm256_storeu_ps(p, _mm256_maskz_compress_ps(kept_.v, x.v)); }
  void store(UInt<8> x, std::uint32_t* p) const {
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(p),
                        _mm256_maskz_compress_epi32(kept_.v, reinterpret_cast<__m256i>(x.v)));
  }

 private:
  Mask<8> kept_;
#else
  explicit Compression8(Mask<8> kept) : index_(unpack_indices(kSetBits.of[kept.bits()])) {}
  void store(Float<8> x, float* p) const { permute(x, index_).store(p); }
  void store(UInt<8> x, std::uint32_t* p) const { permute(x, index_).store(p); }

 private:
  UInt<8> index_;
#endif
};
#endif

}  // namespace
}  // namespace raylab
