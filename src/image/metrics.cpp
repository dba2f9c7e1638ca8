#include "raylab/image/metrics.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

#include "raylab/core/check.hpp"
#include "raylab/core/error.hpp"

namespace raylab {

namespace {

constexpr double kInfiniteError = std::numeric_limits<double>::infinity();

void check_comparable(const Image& image, const Image& reference) {
  const auto size = [](const Image& i) { return std::to_string(i.width) + " x " + std::to_string(i.height); };
  if (image.width != reference.width || image.height != reference.height) {
    throw Error(ErrorKind::usage, "", "the picture has " + size(image) + " pixels, the reference " + size(reference));
  }
  if (image.pixels.empty()) throw Error(ErrorKind::input, "", "pictures without pixels cannot be compared");
}

/// A pixel's errors, means over its channels.
struct PixelError {
  double relative_squared;
  double squared;
};

PixelError pixel_error(const Rgb& pixel, const Rgb& reference) {
  if (!is_finite(pixel) || !is_finite(reference)) return {kInfiniteError, kInfiniteError};
  PixelError error{0.0, 0.0};
  for (int c = 0; c < 3; ++c) {
    const double r = reference[c];
    const double squared = (pixel[c] - r) * (pixel[c] - r);
    error.squared += squared / 3.0;
    error.relative_squared += squared / (r * r + 0.01) / 3.0;
  }
  return error;
}

double sum_of_channels(const Rgb& pixel) {
  return static_cast<double>(pixel.r) + static_cast<double>(pixel.g) + static_cast<double>(pixel.b);
}

void set_mean_ratio(const Image& image, const Image& reference, ImageError& error) {
  const std::size_t count = image.pixels.size();
  double image_sum = 0.0;
  double reference_sum = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    image_sum += sum_of_channels(image.pixels[i]);
    reference_sum += sum_of_channels(reference.pixels[i]);
  }
  error.mean_ratio = image_sum == 0.0 && reference_sum == 0.0 ? 1.0 : image_sum / reference_sum;
  error.mean_ratio_error = kInfiniteError;
  if (!std::isfinite(image_sum) || !std::isfinite(reference_sum)) {
    error.mean_ratio = std::numeric_limits<double>::quiet_NaN();
  } else if (count >= 2 && std::isfinite(error.mean_ratio)) {
    // To first order the ratio's error is the mean of I - ratio R, whose expectation is 0, over the mean of R.
    double squares = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      const double residual =
          sum_of_channels(image.pixels[i]) - error.mean_ratio * sum_of_channels(reference.pixels[i]);
      squares += residual * residual;
    }
    const double n = static_cast<double>(count);
    const double deviation_of_mean = std::sqrt(squares / (n - 1.0) / n);
    error.mean_ratio_error = deviation_of_mean == 0.0 ? 0.0 : deviation_of_mean / std::abs(reference_sum / n);
  }
}

}  // namespace

ImageError image_error(const Image& image, const Image& reference) {
  check_comparable(image, reference);
  const std::size_t count = image.pixels.size();
  ImageError error;
  std::vector<double> relative(count);
  for (std::size_t i = 0; i < count; ++i) {
    const PixelError pixel = pixel_error(image.pixels[i], reference.pixels[i]);
    relative[i] = pixel.relative_squared;
    error.mse += pixel.squared;
    // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison): bits are compared, NaN's and those of zeros too
    if (std::memcmp(&image.pixels[i], &reference.pixels[i], sizeof(Rgb)) != 0) ++error.different_pixels;
  }
  error.mse /= static_cast<double>(count);
  error.relmse = std::accumulate(relative.begin(), relative.end(), 0.0) / static_cast<double>(count);

  const std::size_t kept = count - count / 1000;
  const auto end = relative.begin() + static_cast<std::ptrdiff_t>(kept);
  if (kept < count) std::nth_element(relative.begin(), end, relative.end());
  error.relmse_trimmed = std::accumulate(relative.begin(), end, 0.0) / static_cast<double>(kept);

  set_mean_ratio(image, reference, error);
  return error;
}

Image error_picture(const Image& image, const Image& reference, double full_scale) {
  check_comparable(image, reference);
  RAYLAB_CHECK(full_scale > 0.0);
  Image picture(image.width, image.height);
  for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
    const double relative = std::sqrt(pixel_error(image.pixels[i], reference.pixels[i]).relative_squared);
    if (!std::isfinite(relative)) {
      picture.pixels[i] = Rgb(1.0f, 0.0f, 1.0f);
      continue;
    }
    // A third of the ramp for each of red, green and blue; srgb_to_linear clamps to [0, 1].
    const auto ramp = static_cast<float>(3.0 * std::min(relative / full_scale, 1.0));
    picture.pixels[i] = Rgb(srgb_to_linear(ramp), srgb_to_linear(ramp - 1.0f), srgb_to_linear(ramp - 2.0f));
  }
  return picture;
}

}  // namespace raylab
