#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "raylab/core/vec.hpp"

namespace raylab {

/// A picture of linear Rec. 709 radiance, row by row from the top left.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<Rgb> pixels;  ///< width * height

  Image() = default;
  Image(int w, int h) : width(w), height(h), pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}

  Rgb& at(int x, int y) { return pixels[static_cast<std::size_t>(y) * width + x]; }
  const Rgb& at(int x, int y) const { return pixels[static_cast<std::size_t>(y) * width + x]; }
};

/// The exact sRGB transfer curve (IEC 61966-2-1). Input and output in [0, 1]; input is clamped, NaN gives 0.
float linear_to_srgb(float linear);
float srgb_to_linear(float encoded);
/// The same of bytes, as 8-bit pictures hold them.
std::uint8_t linear_to_srgb_byte(float linear);
float srgb_byte_to_linear(std::uint8_t encoded);

}  // namespace raylab
