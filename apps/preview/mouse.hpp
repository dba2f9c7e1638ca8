#pragma once
#include "explorer.hpp"

namespace raylab {

/// Makes of where the pointer goes and of its buttons what an explorer hears: where it points, looking, clicks.
/// Knows no window.
class Mouse {
 public:
  /// The explorer must outlive it.
  explicit Mouse(Explorer& explorer) : explorer_(explorer) {}

  void press();
  void release(bool left);

  /// The pointer went to (x, y), in pixels of the picture. Looks where a button is held or the mouse captured.
  void move_to(double x, double y);

  /// The same, from where it is.
  void move_by(double dx, double dy) { move_to(x_ + dx, y_ + dy); }

  /// The pointer is at (x, y) without having moved there, as when capturing changes.
  void put(double x, double y);

 private:
  Explorer& explorer_;
  int held_ = 0;  // buttons
  double x_ = 0.0, y_ = 0.0;
  double dragged_ = 0.0;  // pixels since a button went down
};

}  // namespace raylab
