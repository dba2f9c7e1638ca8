#pragma once

namespace raylab {

/// Pixels [x, x + width) x [y, y + height), from the top left.
struct PixelRect {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;

  bool operator==(const PixelRect&) const = default;
};

}  // namespace raylab
