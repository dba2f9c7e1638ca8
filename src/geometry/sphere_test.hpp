#pragma once
// Ray against spheres, over the number type D: double, or a vector of doubles. In double, since squares of tiny radii,
// of long and of short directions leave the range of float; it costs little.
#include "core/simd/lanes.hpp"

namespace raylab {
namespace {

/// The quadratic equation of a line and a sphere; its roots are the distances c / q and q / a. They are stable where
/// the quadratic formula cancels, which is for a distant or a large sphere (Haines, Günther and Akenine-Möller 2019,
/// Ray Tracing Gems, ch. 7).
template <class D>
struct SphereQuadratic {
  D a, b, c;
  D discriminant;  ///< negative where the line passes the sphere by

  SphereQuadratic(const Vec3<D>& from_center, const Vec3<D>& direction, const D& radius) {
    a = dot(direction, direction);
    b = -dot(from_center, direction);
    // The distance of the centre from the line, squared and times a, from the vectors and not from b² - a c.
    const Vec3<D> moment = cross(from_center, direction);
    discriminant = radius * radius * a - dot(moment, moment);
    c = dot(from_center, from_center) - radius * radius;
  }
  D q() const { return b + copysign(sqrt(discriminant), b); }
};

}  // namespace
}  // namespace raylab
