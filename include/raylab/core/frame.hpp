#pragma once
#include "raylab/core/lanes.hpp"

namespace raylab {

/// Right-handed orthonormal frame whose z axis is a given unit vector; of lanes of type F (core/lanes.hpp).
template <class F>
struct BasicFrame {
  using Vec3 = Vec3Of<F>;
  Vec3 x, y, z;

  /// Frame around the unit vector n, continuous but for n.z = 0 (Duff et al. 2017, JCGT 6:1).
  explicit BasicFrame(const Vec3& n) : z(n) {
    const F sign = with_sign_of(F(1.0f), n.z);
    const F a = F(-1.0f) / (sign + n.z);
    const F b = n.x * n.y * a;
    x = Vec3(F(1.0f) + sign * n.x * n.x * a, sign * b, -sign * n.x);
    y = Vec3(b, sign + n.y * n.y * a, -n.y);
  }

  Vec3 to_local(const Vec3& v) const { return {dot(v, x), dot(v, y), dot(v, z)}; }
  Vec3 to_world(const Vec3& v) const { return v.x * x + v.y * y + v.z * z; }
};
using Frame = BasicFrame<float>;

}  // namespace raylab
