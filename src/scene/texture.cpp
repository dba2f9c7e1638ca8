#include "raylab/scene/texture.hpp"

#include <algorithm>
#include <cmath>

namespace raylab {

Rgb sample_image(const TextureImage& image, const vec2& uv, AddressMode mode_of_v) {
  const bool repeats = mode_of_v == AddressMode::repeat;
  // floor keeps negative coordinates right; a texture coordinate that is not finite reads texel (0, 0).
  const float u = uv.x - std::floor(uv.x);
  const float v = repeats ? uv.y - std::floor(uv.y) : uv.y;
  const float x = u * static_cast<float>(image.width) - 0.5f;
  const float y = (1.0f - v) * static_cast<float>(image.height) - 0.5f;
  if (!(std::abs(x) < 1e9f && std::abs(y) < 1e9f)) return image.texels[0];
  const float fx = std::floor(x);
  const float fy = std::floor(y);
  const auto wrap = [](int i, int n) { return i < 0 ? i + n : (i >= n ? i - n : i); };
  const int x0 = wrap(static_cast<int>(fx), image.width);
  const auto row = [&](int i) { return repeats ? wrap(i, image.height) : std::clamp(i, 0, image.height - 1); };
  const int y0 = row(static_cast<int>(fy));
  const int x1 = wrap(x0 + 1, image.width);
  const int y1 = row(static_cast<int>(fy) + 1);
  const float wx = x - fx;
  const float wy = y - fy;
  const auto texel = [&](int i, int j) -> const Rgb& {
    return image.texels[static_cast<std::size_t>(j) * image.width + i];
  };
  return (1.0f - wy) * ((1.0f - wx) * texel(x0, y0) + wx * texel(x1, y0)) +
         wy * ((1.0f - wx) * texel(x0, y1) + wx * texel(x1, y1));
}

}  // namespace raylab
