#pragma once
#include <cstdint>
#include <vector>

#include "raylab/core/vec.hpp"
#include "raylab/image/image.hpp"

namespace raylab {

/// Sum of floats in 128-bit fixed point with 80 fractional bits. Adding is exact but for what lies below
/// 2^-80 of each term, so a sum does not depend on the order or grouping of its terms: pictures are equal to
/// the bit however samples are split over threads, tiles, passes and machines.
class ExactSum {
 public:
  /// x must be finite; sizes above 2^40 are clamped to it.
  void add(float x);
  void add(const ExactSum& other) { sum_ += other.sum_; }
  double value() const;
  bool operator==(const ExactSum&) const = default;

 private:
  __int128 sum_ = 0;
};

/// What has been gathered for one pixel.
struct PixelSum {
  ExactSum rgb[3];
  ExactSum luminance_squared;
};

/// Sums of samples for each pixel of a width x height picture, of which a crop window is rendered.
/// Different pixels may be written from different threads at the same time.
class Film {
 public:
  Film(int width, int height);

  int width() const { return width_; }
  int height() const { return height_; }

  /// Adds one sample. Non-finite and negative ones must have been dropped by the caller.
  void add(int x, int y, const Rgb& radiance);

  /// Counts a sample that was taken but is not used: it lowers the pixel's sample count only.
  void skip(int x, int y);

  std::uint32_t samples(int x, int y) const { return samples_[index(x, y)]; }

  /// Mean radiance of the pixel's samples; black where there are none.
  Rgb mean(int x, int y) const;

  /// Estimated variance of mean luminance: sample variance / n. 0 with fewer than two samples.
  /// With stratified samplers it overestimates.
  double variance_of_mean(int x, int y) const;

  /// Mean over all sampled pixels of variance_of_mean / (luminance² + 0.01): estimate of the picture's relMSE.
  double estimated_relmse() const;

  Image image() const;

  /// Adds another film's samples to this one's. Both must have the same size.
  void add(const Film& other);

  void clear();

 private:
  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y) * width_ + x; }

  int width_, height_;
  std::vector<PixelSum> sums_;
  std::vector<std::uint32_t> samples_;
};

}  // namespace raylab
