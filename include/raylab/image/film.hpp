#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <vector>

#include "raylab/core/vec.hpp"
#include "raylab/image/image.hpp"

namespace raylab {

/// Sum of fewer than 2^32 numbers in 128-bit fixed point with 55 fractional bits. Each number is cut towards zero
/// to a multiple of 2^-55, which leaves a float of 2^-32 or more as it is; from there on the sum is exact and
/// cannot overflow. It does not depend on the order or grouping of its terms, nor on whether denormals are
/// flushed: pictures are equal to the bit however samples are split over threads, tiles, passes and machines.
class ExactSum {
 public:
  static constexpr double kLargest = 0x1p40;  ///< terms are clamped to this size
  static constexpr double kLeast = 0x1p-40;   ///< below, a term loses more than 2^-15 of itself, and vanishes at 2^-55
  static constexpr int kFractionBits = 55;

  /// x must not be NaN.
  void add(double x) {
    if (std::abs(x) < kSmall) return add_small(x);  // nearly always: one conversion does
    x = std::clamp(x, -kLargest, kLargest);
    const auto whole = static_cast<std::int64_t>(x);
    const auto fraction = static_cast<std::int64_t>((x - static_cast<double>(whole)) * kScale);
    sum_ += (static_cast<__int128>(whole) << kFractionBits) + fraction;
  }
  void add(const ExactSum& other) { sum_ += other.sum_; }

  static constexpr double kSmall = 0x1p8;
  /// add() where |x| < kSmall.
  void add_small(double x) { sum_ += static_cast<std::int64_t>(x * kScale); }

  /// The sum, rounded once to the nearest double.
  double value() const { return static_cast<double>(sum_) / kScale; }
  bool operator==(const ExactSum&) const = default;

  /// The sum in its two's complement, and back: for files.
  unsigned __int128 bits() const { return static_cast<unsigned __int128>(sum_); }
  static ExactSum from_bits(unsigned __int128 bits) {
    ExactSum sum;
    sum.sum_ = static_cast<__int128>(bits);
    return sum;
  }

 private:
  static constexpr double kScale = static_cast<double>(std::int64_t{1} << kFractionBits);

  __int128 sum_ = 0;
};

/// Sum of fewer than 2^32 squares in unsigned 96-bit fixed point with 36 fractional bits, in 12 bytes. Each square is
/// cut to a multiple of 2^-36, and the sum ends at the largest there is. As no term is negative, what is
/// held is the smaller of that and the true sum, whatever the order and grouping.
///
/// The squares serve the estimate of error alone. Cutting takes less than 2^-36 from the variance of a sample, which
/// relMSE holds against 0.01 and more: less than 2e-9 of the error of one sample. The bits that are left hold 2^20
/// samples of radiance 2^20, which is the most that any square counted for where each was cut off at 2^40.
class SquareSum {
 public:
  static constexpr int kFractionBits = 36;

  /// Adds the squares of numbers that are not negative nor NaN.
  void add(const float* numbers, std::size_t count);
  void add(const SquareSum& other) { set(bits() + other.bits()); }

  /// Whether the true sum may be larger than value().
  bool is_full() const { return (words_[0] & words_[1] & words_[2]) == 0xffffffffu; }
  double value() const { return static_cast<double>(bits()) / static_cast<double>(std::int64_t{1} << kFractionBits); }

  unsigned __int128 bits() const {
    return static_cast<unsigned __int128>(words_[2]) << 64 | std::uint64_t{words_[1]} << 32 | words_[0];
  }
  /// The bits that fit; all of them where they do not.
  void set(unsigned __int128 bits) {
    const bool full = bits >> 96 != 0;
    for (int i = 0; i < 3; ++i) words_[i] = full ? 0xffffffffu : static_cast<std::uint32_t>(bits >> (32 * i));
  }
  bool operator==(const SquareSum&) const = default;

 private:
  std::uint32_t words_[3] = {};
};

/// Sums of a pixel's samples of the highest octave of indices: index 0, or those with as many bits as the highest.
/// Owen-scrambled Sobol points err less than their variance says, and by how much less shows where the mean of an
/// octave, which is a net of points itself, stands against that of all before it. The sums are a function of the
/// samples alone, whatever their order and grouping: a higher octave takes the place of a lower one.
///
/// In 11 bytes: 27 bits of each channel, in units of 2^-9 that end at the largest there is, and the octave.
class OctaveSum {
 public:
  static constexpr double kUnit = 0x1p-9;
  static constexpr std::uint32_t kMost = (1u << 27) - 1;

  /// Adds `count` samples from index `first` on, which are not negative nor NaN.
  void add(const std::array<const float*, 3>& radiance, std::size_t count, std::uint32_t first);
  void add(const OctaveSum& other);

  /// Bits of the indices.
  std::uint32_t octave() const { return static_cast<std::uint32_t>(bits() >> 81); }
  /// Of a channel, in units; kMost where that may be too little.
  std::uint32_t units(std::size_t channel) const {
    return static_cast<std::uint32_t>(bits() >> (27 * channel)) & kMost;
  }

  unsigned __int128 bits() const {
    unsigned __int128 bits = 0;
    std::memcpy(&bits, bytes_.data(), bytes_.size());
    return bits;
  }
  static OctaveSum from_bits(unsigned __int128 bits) {
    OctaveSum sum;
    std::memcpy(sum.bytes_.data(), &bits, sum.bytes_.size());
    return sum;
  }
  bool operator==(const OctaveSum&) const = default;

 private:
  void set(std::uint32_t octave, const std::array<std::uint64_t, 3>& units);

  std::array<std::uint8_t, 11> bytes_ = {};
};

/// Sums of samples for each pixel of a width x height picture, of which a crop window is rendered: 99 bytes a pixel,
/// and 4 more once a sample was dropped. Samples may be added to different pixels from different threads at the same
/// time.
///
/// A pixel counts the samples that it keeps and those that were taken of it, which are more where some were dropped
/// as not finite: taken from the first of a range on, they say which sample is the next.
class Film {
 public:
  /// Both sizes must be positive.
  Film(int width, int height);

  int width() const { return width_; }
  int height() const { return height_; }

  /// Adds one sample, the next of the pixel. Non-finite and negative ones must have been dropped by the caller.
  void add(int x, int y, const Rgb& radiance) {
    add(x, y, {&radiance.r, &radiance.g, &radiance.b}, 1, taken_[index(x, y)]);
  }
  /// Adds `count` samples of one pixel from index `first` on, given as their reds, greens and blues.
  void add(int x, int y, const std::array<const float*, 3>& radiance, std::size_t count, std::uint32_t first);

  /// Counts samples that were taken and dropped.
  void drop(int x, int y, std::uint32_t count) { drop(index(x, y), count); }

  /// Samples kept, of which the mean is.
  std::uint32_t samples(int x, int y) const { return kept(index(x, y)); }
  /// Samples taken: those kept and those dropped.
  std::uint32_t taken(int x, int y) const { return taken_[index(x, y)]; }

  /// Mean radiance of the pixel's samples; black where there are none.
  Rgb mean(int x, int y) const;

  /// Estimated variance of each channel of mean(): sample variance / n. 0 with fewer than two samples.
  /// With stratified samplers it overestimates; where the squares are more than SquareSum holds, it is that of one
  /// bright sample among black ones, which is the most it can be.
  dvec3 variance_of_mean(int x, int y) const;

  /// Whether the squares of a channel are more than SquareSum holds.
  bool variance_is_bound(int x, int y) const;

  /// Where the pixel's samples are those of indices 0 to n - 1: the square of what the means of the highest octave
  /// and of the samples before it differ by, scaled to the variance of mean() that it would stand for if samples were
  /// independent. Absent where it is not known.
  std::optional<dvec3> octave_variance(int x, int y) const;

  /// estimate_relmse() of samples that are independent, or of which nothing is known: too large for Sobol points.
  double estimated_relmse() const;

  Image image() const;

  /// Copy of the rows from `first` on, `count` of them; all must be there.
  Film rows(int first, int count) const;

  /// Adds another film's samples to this one's, its upper left pixel to pixel (x, y), where all of it must fit.
  void add(const Film& other, int x = 0, int y = 0);

  void clear();

  bool operator==(const Film&) const = default;

  /// The words of 32 bits that a pixel is of in files: kept; the octave's sums in 3; of blue, green and red the sum of
  /// squares in 3, and the sum in 4, the least significant first; taken. Word k of pixel (x, y) goes to
  /// words[k * width() + x].
  static constexpr std::size_t kWords = 1 + 3 + 3 * 3 + 3 * 4 + 1;
  /// In memory.
  static constexpr std::size_t kBytes =
      sizeof(std::array<ExactSum, 3>) + sizeof(std::array<SquareSum, 3>) + sizeof(OctaveSum) + 4;
  void row_words(int y, std::uint32_t* words) const;
  /// Adds the samples of a row that row_words() wrote, of a film as wide.
  void add_row_words(int y, const std::uint32_t* words);

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }

  std::uint32_t kept(std::size_t pixel) const { return taken_[pixel] - (dropped_.empty() ? 0 : dropped_[pixel]); }
  void drop(std::size_t pixel, std::uint32_t count);
  dvec3 mean(std::size_t pixel) const;

  int width_, height_;
  // Apart, as together in one struct they would be padded to 112 bytes.
  std::vector<std::array<ExactSum, 3>> sums_;
  std::vector<std::array<SquareSum, 3>> squares_;
  std::vector<OctaveSum> octaves_;
  std::vector<std::uint32_t> taken_;
  std::vector<std::uint32_t> dropped_;  // of each pixel; empty while there are none
};

}  // namespace raylab
