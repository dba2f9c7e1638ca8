#pragma once
#include "core/simd/lanes.hpp"

namespace raylab {
namespace {

/// Right-handed orthonormal frame whose z axis is a given unit vector; over the number type F.
template <class F>
struct BasicFrame {
  Vec3<F> x, y, z;

  /// Frame around the unit vector n, continuous but for n.z = 0 (Duff et al. 2017, JCGT 6:1).
  explicit BasicFrame(const Vec3<F>& n) : z(n) {
    const F sign = copysign(F(1.0f), n.z);
    const F a = F(-1.0f) / (sign + n.z);
    const F b = n.x * n.y * a;
    x = Vec3<F>(F(1.0f) + sign * n.x * n.x * a, sign * b, -sign * n.x);
    y = Vec3<F>(b, sign + n.y * n.y * a, -n.y);
  }

  Vec3<F> to_local(const Vec3<F>& v) const { return {dot(v, x), dot(v, y), dot(v, z)}; }
  Vec3<F> to_world(const Vec3<F>& v) const { return v.x * x + v.y * y + v.z * z; }
};
using Frame = BasicFrame<float>;

}  // namespace
}  // namespace raylab
