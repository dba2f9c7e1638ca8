#include "mouse.hpp"

#include <cmath>

namespace raylab {

namespace {
constexpr double kClickPixels = 4.0;  // a button that comes up within this distance was a click
}  // namespace

void Mouse::press() {
  if (++held_ == 1) dragged_ = 0.0;
}

void Mouse::release(bool left) {
  if (held_ == 0) return;
  --held_;
  if (left && dragged_ < kClickPixels && !explorer_.captures_mouse()) explorer_.click(x_, y_);
}

void Mouse::move_to(double x, double y) {
  const double dx = x - x_, dy = y - y_;
  put(x, y);
  if (held_ > 0 || explorer_.captures_mouse()) explorer_.drag(dx, dy);
  dragged_ += std::abs(dx) + std::abs(dy);
}

void Mouse::put(double x, double y) {
  x_ = x;
  y_ = y;
  explorer_.point(x, y);
}

}  // namespace raylab
