#include "raylab/image/image.hpp"

#include <cmath>

namespace raylab {

namespace {

double clamp_to_unit(float x) {
  // Written so that NaN gives 0.
  if (!(x > 0.0f)) return 0.0;
  return x < 1.0f ? static_cast<double>(x) : 1.0;
}

}  // namespace

float linear_to_srgb(float linear) {
  const double x = clamp_to_unit(linear);
  return static_cast<float>(x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1.0 / 2.4) - 0.055);
}

float srgb_to_linear(float encoded) {
  const double x = clamp_to_unit(encoded);
  return static_cast<float>(x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4));
}

}  // namespace raylab
