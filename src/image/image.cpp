#include "raylab/image/image.hpp"

#include <array>
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

std::uint8_t linear_to_srgb_byte(float linear) {
  return static_cast<std::uint8_t>(255.0f * linear_to_srgb(linear) + 0.5f);
}

float srgb_byte_to_linear(std::uint8_t encoded) {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> linear{};
    for (std::size_t i = 0; i < linear.size(); ++i) linear[i] = srgb_to_linear(static_cast<float>(i) / 255.0f);
    return linear;
  }();
  return table[encoded];
}

}  // namespace raylab
