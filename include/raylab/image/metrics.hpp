#pragma once
#include "raylab/image/image.hpp"

namespace raylab {

/// Errors of a picture against a reference, over all pixels and channels.
struct ImageError {
  double relmse = 0.0;          ///< mean of (I-R)² / (R² + 0.01)
  double relmse_trimmed = 0.0;  ///< the same without the worst 0.1% of the pixels (by a pixel's mean over channels)
  double mse = 0.0;
  double mean_ratio = 1.0;            ///< mean of I / mean of R: the bias; 1 when both are black
  double mean_ratio_error = 0.0;      ///< standard error of mean_ratio, pixels taken as independent
  std::size_t different_pixels = 0;   ///< pixels that are not equal to the bit
};

/// Throws Error (usage) when the sizes differ, and Error (input) for an empty picture.
ImageError image_error(const Image& image, const Image& reference);

}  // namespace raylab
