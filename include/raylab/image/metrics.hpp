#pragma once
#include <cstddef>

#include "raylab/image/image.hpp"

namespace raylab {

/// Errors of a picture against a reference, over all pixels and channels. Where either is NaN or infinite the
/// error counts as infinite: it is not dropped.
struct ImageError {
  /// Mean of (I-R)² / (R² + 0.01).
  double relmse = 0.0;
  /// The same without the worst 0.1% of the pixels, rounded down, a pixel being judged by its mean over channels.
  double relmse_trimmed = 0.0;
  /// Mean of (I-R)².
  double mse = 0.0;
  /// Mean of I / mean of R: the bias. 1 when both are black, NaN with a non-finite value.
  double mean_ratio = 1.0;
  /// Standard error of mean_ratio by the delta method for a ratio of means, pixels taken as independent; infinity
  /// when it is unknown: fewer than two pixels, a black reference alone, or a non-finite value.
  double mean_ratio_error = 0.0;
  /// Pixels that are not equal to the bit.
  std::size_t different_pixels = 0;
};

/// Throws Error (usage) when the sizes differ, and Error (input) for an empty picture.
ImageError image_error(const Image& image, const Image& reference);

/// Picture of where the error is: a pixel's relative error, the root of its mean of (I-R)² / (R² + 0.01) over the
/// channels, goes from black (0) through red and yellow to white (full_scale and above), each colour lighter than
/// the one before; magenta marks non-finite values. Linear values: sRGB-encoded, the ramp is even.
/// Throws as image_error. full_scale must be positive.
Image error_picture(const Image& image, const Image& reference, double full_scale = 1.0);

}  // namespace raylab
