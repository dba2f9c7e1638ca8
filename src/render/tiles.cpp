#include <algorithm>
#include <cmath>
#include <tuple>

#include "raylab/render/render_session.hpp"

namespace raylab {

std::vector<PixelRect> centre_out_tiles(const PixelRect& region, int tile_size) {
  std::vector<PixelRect> tiles;
  for (int y = 0; y < region.height; y += tile_size) {
    for (int x = 0; x < region.width; x += tile_size) {
      tiles.push_back(
          {region.x + x, region.y + y, std::min(tile_size, region.width - x), std::min(tile_size, region.height - y)});
    }
  }
  // Ring by ring around the middle, each ring by angle: neighbours in time are neighbours in space.
  const double cx = region.x + 0.5 * region.width;
  const double cy = region.y + 0.5 * region.height;
  const auto key = [&](const PixelRect& t) {
    const double dx = t.x + 0.5 * tile_size - cx;
    const double dy = t.y + 0.5 * tile_size - cy;
    const int ring = static_cast<int>(std::max(std::abs(dx), std::abs(dy)) / tile_size);
    return std::tuple(ring, std::atan2(dy, dx), t.y, t.x);
  };
  std::sort(tiles.begin(), tiles.end(), [&](const PixelRect& a, const PixelRect& b) { return key(a) < key(b); });
  return tiles;
}

}  // namespace raylab
