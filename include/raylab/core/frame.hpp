#pragma once
#include <cmath>

#include "raylab/core/vec.hpp"

namespace raylab {

/// Right-handed orthonormal frame whose z axis is a given unit vector.
struct Frame {
  vec3 x, y, z;

  /// Frame around the unit vector n, continuous but for n.z = 0 (Duff et al. 2017, JCGT 6:1).
  explicit Frame(const vec3& n) : z(n) {
    const float sign = std::copysign(1.0f, n.z);
    const float a = -1.0f / (sign + n.z);
    const float b = n.x * n.y * a;
    x = vec3(1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x);
    y = vec3(b, sign + n.y * n.y * a, -n.y);
  }

  vec3 to_local(const vec3& v) const { return {glm::dot(v, x), glm::dot(v, y), glm::dot(v, z)}; }
  vec3 to_world(const vec3& v) const { return v.x * x + v.y * y + v.z * z; }
};

}  // namespace raylab
