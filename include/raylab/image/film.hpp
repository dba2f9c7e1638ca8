#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
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

 private:
  static constexpr double kScale = static_cast<double>(std::int64_t{1} << kFractionBits);

  __int128 sum_ = 0;
};

/// What has been gathered for one pixel.
struct PixelSum {
  ExactSum rgb[3];
  ExactSum squares[3];
};

/// Sums of samples for each pixel of a width x height picture, of which a crop window is rendered.
/// Different pixels may be written from different threads at the same time.
class Film {
 public:
  /// Both sizes must be positive.
  Film(int width, int height);

  int width() const { return width_; }
  int height() const { return height_; }

  /// Adds one sample. Non-finite and negative ones must have been dropped by the caller.
  void add(int x, int y, const Rgb& radiance) { add(x, y, {&radiance.r, &radiance.g, &radiance.b}, 1); }
  /// Adds `count` samples of one pixel, given as their reds, greens and blues.
  void add(int x, int y, const std::array<const float*, 3>& radiance, std::size_t count);

  std::uint32_t samples(int x, int y) const { return samples_[index(x, y)]; }

  /// Mean radiance of the pixel's samples; black where there are none.
  Rgb mean(int x, int y) const;

  /// Estimated variance of each channel of mean(): sample variance / n. 0 with fewer than two samples.
  /// With stratified samplers it overestimates; with values above 2^20, whose squares are clamped, it
  /// underestimates.
  dvec3 variance_of_mean(int x, int y) const { return variance_of_mean(index(x, y)); }

  /// Mean of variance / (mean² + 0.01) over channels and the pixels with two samples or more: estimate of the
  /// picture's relMSE. Infinity where no pixel has two samples, since then nothing is known.
  double estimated_relmse() const;

  Image image() const;

  /// Copy of the rows from `first` on, `count` of them; all must be there.
  Film rows(int first, int count) const;

  /// Adds another film's samples to this one's, its upper left pixel to pixel (x, y), where all of it must fit.
  void add(const Film& other, int x = 0, int y = 0);

  void clear();

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }

  dvec3 mean(std::size_t pixel) const;
  dvec3 variance_of_mean(std::size_t pixel) const;
  dvec3 variance_of_mean(std::size_t pixel, const dvec3& mean) const;

  int width_, height_;
  std::vector<PixelSum> sums_;
  std::vector<std::uint32_t> samples_;
};

}  // namespace raylab
