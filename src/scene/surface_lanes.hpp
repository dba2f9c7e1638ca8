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

/// Point p0 + u e1 + v e2 of a triangle with edges e1 and e2, its geometric normal and its offset.
///
/// The offset covers, along ng,
///  - the rounding of the position and of adding the offset: each one rounding of the coordinates, and three of the way
///    from p0, which for a small triangle far away count for nothing (Higham 2002, §3.1; gamma(3) and gamma(4) leave
///    one to spare);
///  - the error with which the next ray's query finds this very triangle: a test that takes the distance to the
///    plane as dot(p0 - o, e1 x e2) errs by a few roundings of |extent| |e1| |e2|, which for a needle is far more
///    than its |e1 x e2|; gamma(4) of them, as gamma(1) is not seen to fail;
///  - 2^-40 of the extent, so that a query that decides in double still sees the point off the plane.
/// In the planes x = 0, y = 0 and z = 0 the first two vanish, as do the errors they bound. Of lanes other than those
/// given nothing is to be read: what stands in them takes no branch.
template <class F>
void place_on_triangle(const MaskOf<F>& lanes, const Vec3<F>& p0, const Vec3<F>& p1, const Vec3<F>& p2, const F& u,
                       const F& v, PointLanes<F>& point) {
  const Vec3<F> e1 = p1 - p0;
  const Vec3<F> e2 = p2 - p0;
  point.position = p0 + (e1 * u + e2 * v);
  const Vec3<F> a(e1.y * e2.z, e1.z * e2.x, e1.x * e2.y);
  const Vec3<F> b(e1.z * e2.y, e1.x * e2.z, e1.y * e2.x);
  const Vec3<F> n = a - b;
  const F length2 = dot(n, n);
  const F inv_length = F(1.0f) / sqrt(length2);
  point.ng = n * inv_length;
  // The square of a small needle's product, or of a huge triangle's, leaves the range of float; the products of a
  // sliver cancel. In double they do neither.
  const Vec3<F> products = abs(a) + abs(b);
  Vec3<F> cancellation = products * inv_length;
  const MaskOf<F> in_float =
      (length2 > F(0x1p-100f)) & (length2 < F(0x1p120f)) & (max_component(cancellation) < F(0x1p12f));
  if (any(lanes & !in_float)) [[unlikely]] {
    using D = DoubleOf<F>;
    const Vec3<D> d1 = Vec3<D>(p1) - Vec3<D>(p0), d2 = Vec3<D>(p2) - Vec3<D>(p0);
    const Vec3<D> normal = cross(d1, d2);
    const D length = sqrt(dot(normal, normal));
    const Vec3<D> sizes(abs(d1.y * d2.z) + abs(d1.z * d2.y), abs(d1.z * d2.x) + abs(d1.x * d2.z),
                        abs(d1.x * d2.y) + abs(d1.y * d2.x));
    const MaskOf<F> has_area = D(0.0) < length;
    const auto unless_in_float = [&](const Vec3<F>& value, const Vec3<D>& of_length) {
      return select<F>(in_float, value, select<F>(has_area, to_float(of_length / length), Vec3<F>(F(0.0f))));
    };
    point.ng = unless_in_float(point.ng, normal);
    cancellation = unless_in_float(cancellation, sizes);
  }
  const Vec3<F> extent = abs(e1) + abs(e2);
  const Vec3<F> way = abs(e1) * u + abs(e2) * v;
  const Vec3<F> error = abs(point.ng) * (abs(point.position) * F(gamma_bound(3)) + way * F(gamma_bound(4)));
  const Vec3<F> bound = error + extent * (cancellation * F(gamma_bound(4)) + Vec3<F>(F(0x1p-40f)));
  point.offset = bound.x + bound.y + bound.z;
}

/// Moves a point of a triangle far larger than the point's distance from the origin, whose weights u and v then say too
/// little of where it is, onto the ray that has met it: the ray is followed to the triangle's plane, in double.
template <class F>
void place_on_ray(const MaskOf<F>& lanes, const Vec3<F>& p0, const Vec3<F>& p1, const Vec3<F>& p2,
                  const Vec3<F>& origin, const Vec3<F>& direction, const F& t, PointLanes<F>& point) {
  const F size = max_component(abs(p1 - p0) + abs(p2 - p0));
  const MaskOf<F> outsized = lanes & (size > F(1024.0f) * max_component(abs(point.position)));
  if (!any(outsized)) [[likely]]
    return;
  using D = DoubleOf<F>;
  const Vec3<D> corner(p0), d(direction);
  const Vec3<D> n = cross(Vec3<D>(p1) - corner, Vec3<D>(p2) - corner);
  const Vec3<D> beside = Vec3<D>(origin) + D(t) * d;
  const D facing = dot(d, n);
  const Vec3<F> on_ray = to_float(beside + (dot(corner - beside, n) / facing) * d);
  const MaskOf<F> meets = (D(0.0) < abs(facing)) & outsized;
  point.position = select<F>(meets, on_ray, point.position);
}

/// The point of a sphere at `from_center` (of any length near the radius) from its centre, and the offset. That covers
/// the rounding of the position and of adding the offset; and for queries, which decide in double, 2^-48 of the radius.
template <class F>
void place_on_sphere(const Vec3<DoubleOf<F>>& center, const F& radius, const Vec3<DoubleOf<F>>& from_center,
                     PointLanes<F>& point) {
  point.position = to_float(center + from_center);
  const Vec3<F> n = to_float(from_center) * (F(1.0f) / radius);
  point.ng = n * (F(1.0f) / sqrt(dot(n, n)));
  point.offset = F(gamma_bound(3)) * dot(abs(point.ng), abs(point.position)) + F(0x1p-48f) * radius;
}

/// The point where a ray has met a sphere. Since t is rounded, the point that it gives lies beside the sphere, by far
/// more than the sphere's size if that is far away; so the ray is followed from there to the sphere, whose nearer root
/// is c / q as in SphereQuadratic. In double only where floats would cancel: the step itself is short.
template <class F>
void place_on_sphere(const Vec3<F>& center, const F& radius, const Vec3<F>& origin, const Vec3<F>& direction,
                     const F& t, PointLanes<F>& point) {
  using D = DoubleOf<F>;
  const Vec3<D> d(direction);
  const Vec3<D> beside = Vec3<D>(origin) - Vec3<D>(center) + D(t) * d;
  const F c = to_float(dot(beside, beside) - D(radius) * D(radius));
  const F b = -dot(to_float(beside), direction);
  const F q = b + copysign(sqrt(max(b * b - dot(direction, direction) * c, F(0.0f))), b);
  const F step = select(q != F(0.0f), c / q, F(0.0f));
  place_on_sphere<F>(Vec3<D>(center), radius, beside + D(step) * d, point);
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
