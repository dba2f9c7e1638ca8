#pragma once
#include "raylab/core/numeric.hpp"
#include "raylab/core/vec.hpp"

namespace raylab {

/// Axis-aligned box, closed on all sides. Default-constructed it is empty: lower > upper.
struct Bounds {
  vec3 lower = vec3(kInfinity);
  vec3 upper = vec3(-kInfinity);

  bool empty() const { return !(lower.x <= upper.x && lower.y <= upper.y && lower.z <= upper.z); }

  void extend(const vec3& p) {
    lower = glm::min(lower, p);
    upper = glm::max(upper, p);
  }
  void extend(const Bounds& b) {
    lower = glm::min(lower, b.lower);
    upper = glm::max(upper, b.upper);
  }

  vec3 center() const { return 0.5f * lower + 0.5f * upper; }
  vec3 diagonal() const { return empty() ? vec3(0.0f) : upper - lower; }

  /// Half the surface area, which is all the surface area heuristic needs; 0 when empty.
  float half_area() const {
    const vec3 d = diagonal();
    return d.x * d.y + d.y * d.z + d.z * d.x;
  }

  /// 0, 1 or 2: the axis along which the box is longest; the first of equals.
  int longest_axis() const {
    const vec3 d = diagonal();
    if (d.x >= d.y && d.x >= d.z) return 0;
    return d.y >= d.z ? 1 : 2;
  }
};

}  // namespace raylab
