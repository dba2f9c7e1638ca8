#pragma once
// Points of surfaces, their offsets and normals, over the number type F.
#include "core/simd/lanes.hpp"
#include "raylab/core/numeric.hpp"

namespace raylab {
namespace {

/// SurfacePoint, as far as formulas need it.
template <class F>
struct PointLanes {
  Vec3<F> position;
  F offset;
  Vec3<F> ng;
};

/// Point (1-u-v) p0 + u p1 + v p2 of a triangle, its geometric normal and its offset.
///
/// The offset covers, along ng,
///  - the rounding of the position itself and of adding the offset: gamma(8) of the corners' coordinates
///    (pbrt-v4 §6.8.4 has gamma(7) for the barycentric sum);
///  - the error with which the next ray's query finds this very triangle: a test that takes the distance to the
///    plane as dot(p0 - o, e1 x e2) errs by a few roundings of |extent| |e1| |e2|, which for a needle is far more
///    than its |e1 x e2|;
///  - 2^-40 of the extent, so that a query that decides in double still sees the point off the plane.
/// In the planes x = 0, y = 0 and z = 0 the first two vanish, as do the errors they bound.
template <class F>
void place_on_triangle(const Vec3<F>& p0, const Vec3<F>& p1, const Vec3<F>& p2, const F& u, const F& v,
                       PointLanes<F>& point) {
  const Vec3<F> e1 = p1 - p0;
  const Vec3<F> e2 = p2 - p0;
  point.position = p0 * (F(1.0f) - u - v) + p1 * u + p2 * v;
  const Vec3<F> a(e1.y * e2.z, e1.z * e2.x, e1.x * e2.y);
  const Vec3<F> b(e1.z * e2.y, e1.x * e2.z, e1.y * e2.x);
  const Vec3<F> n = a - b;
  const F length2 = dot(n, n);
  F inv_length = F(1.0f) / sqrt(length2);
  // The square of a small needle's product, or of a huge triangle's, leaves the range of float.
  const MaskOf<F> out_of_range = !((length2 > F(0x1p-100f)) & (length2 < F(0x1p120f)));
  if (any(out_of_range)) [[unlikely]] {
    const F largest = max(abs(n.x), max(abs(n.y), abs(n.z)));
    const Vec3<F> scaled = n / largest;
    inv_length = select(out_of_range, F(1.0f) / (largest * sqrt(dot(scaled, scaled))), inv_length);
  }
  point.ng = n * inv_length;
  const Vec3<F> extent = abs(e1) + abs(e2);
  const Vec3<F> coordinates = abs(p0) + abs(p1) + abs(p2);
  const Vec3<F> error = abs(point.ng) * coordinates + extent * ((abs(a) + abs(b)) * inv_length);
  const Vec3<F> bound = error * F(gamma_bound(8)) + extent * F(0x1p-40f);
  point.offset = bound.x + bound.y + bound.z;
}

/// The point of the sphere closest to p, the outward normal there and the offset. A query's distance to the sphere
/// errs by roundings of the radius and of the centre's coordinates.
template <class F>
void place_on_sphere(const Vec3<F>& center, const F& radius, const Vec3<F>& p, PointLanes<F>& point) {
  const Vec3<F> from_center = p - center;
  point.ng = from_center * (F(1.0f) / sqrt(dot(from_center, from_center)));
  point.position = center + radius * point.ng;
  point.offset = F(gamma_bound(16)) * (abs(center.x) + abs(center.y) + abs(center.z) + radius);
}

/// The shading normal from the sum of a mesh's normals weighted by (1-u-v, u, v): unit and on the side of ng, and ng
/// itself where the sum vanishes.
template <class F>
Vec3<F> shading_normal(const Vec3<F>& sum, const Vec3<F>& ng) {
  const F length2 = dot(sum, sum);
  const F scale = copysign(F(1.0f), dot(sum, ng)) / sqrt(length2);
  return select(length2 > F(0.0f), scale * sum, ng);
}
/// Start of a ray that leaves the point towards `direction`, on that direction's side of the surface.
template <class F>
Vec3<F> offset_origin(const PointLanes<F>& point, const Vec3<F>& direction) {
  return point.position + copysign(point.offset, dot(direction, point.ng)) * point.ng;
}

}  // namespace
}  // namespace raylab
