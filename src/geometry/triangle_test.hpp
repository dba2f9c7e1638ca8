#pragma once
// Ray against triangles, over the number type F: one ray and a triangle a lane, one triangle and a ray a lane, or a ray
// and a triangle of its own in each lane. Sums of products are never contracted (-ffp-contract=off) and the order of
// operations is fixed, so all of these, and all instruction sets, give the same hits to the bit.
#include "core/simd/lanes.hpp"

namespace raylab {
namespace {

// --- Möller and Trumbore 1997 (JGT 2:1)
// -------------------------------------------------------------------------------

template <class F>
struct MoellerTrumboreHit {
  F t, u, v;
  MaskOf<F> inside;  ///< the line meets the triangle
};

/// Determinants not above `smallest_determinant` in size count as a miss: the book's has 1e-8, whatever the scale.
template <class F>
[[gnu::always_inline]] inline MoellerTrumboreHit<F> moeller_trumbore(const Vec3<F>& origin, const Vec3<F>& direction,
                                                                     const Vec3<F>& p0, const Vec3<F>& p1,
                                                                     const Vec3<F>& p2, float smallest_determinant) {
  constexpr bool scalar = std::is_same_v<F, float>;  // a single ray leaves early, as in the paper
  const Vec3<F> e1 = p1 - p0, e2 = p2 - p0;
  const Vec3<F> p = cross(direction, e2);
  const F det = dot(e1, p);
  MoellerTrumboreHit<F> hit{};
  hit.inside = F(smallest_determinant) < abs(det);
  if (scalar && !any(hit.inside)) return hit;
  const F inv_det = F(1.0f) / det;
  const Vec3<F> s = origin - p0;
  hit.u = dot(s, p) * inv_det;
  hit.inside = hit.inside & (F(0.0f) <= hit.u) & (hit.u <= F(1.0f));
  if (scalar && !any(hit.inside)) return hit;
  const Vec3<F> q = cross(s, e1);
  hit.v = dot(direction, q) * inv_det;
  hit.inside = hit.inside & (F(0.0f) <= hit.v) & (hit.u + hit.v <= F(1.0f));
  if (scalar && !any(hit.inside)) return hit;
  hit.t = dot(e2, q) * inv_det;
  return hit;
}

// --- Woop, Benthin, Wald 2013, "Watertight Ray/Triangle Intersection" (JCGT 2:1)
// --------------------------------------
//
// The sheared vertices depend on the ray and the vertex alone, so two triangles evaluate a shared edge on the same
// numbers, and get exactly opposite values. Rounding, overflow and the flushing of denormals may lose the sign of a
// value but never flip it; a lost sign is decided in double. Contracting products and sums would break this.

/// The order of axes that makes the direction's largest component z; x and y follow it cyclically. (Woop and others
/// swap x and y where the direction is negative, which flips all three edge functions and changes no answer.) One ray
/// stores indices, a vector of rays masks.
template <class F>
class AxisOrder {
 public:
  AxisOrder() = default;
  explicit AxisOrder(const Vec3<F>& direction) {
    const Vec3<F> size = abs(direction);
    const MaskOf<F> x_over_y = size.x > size.y;
    z_is_x_ = x_over_y & (size.x > size.z);
    z_is_y_ = (!x_over_y) & (size.y > size.z);
  }
  F x_of(const Vec3<F>& v) const { return select(z_is_x_, v.y, select(z_is_y_, v.z, v.x)); }
  F y_of(const Vec3<F>& v) const { return select(z_is_x_, v.z, select(z_is_y_, v.x, v.y)); }
  F z_of(const Vec3<F>& v) const { return select(z_is_x_, v.x, select(z_is_y_, v.y, v.z)); }
  /// Whether in all of the lanes that axis is z.
  bool z_is(int axis, MaskOf<F> lanes) const {
    const MaskOf<F> yes = axis == 0 ? z_is_x_ : (axis == 1 ? z_is_y_ : !(z_is_x_ | z_is_y_));
    return !any(lanes & !yes);
  }

 private:
  MaskOf<F> z_is_x_, z_is_y_;
};
template <>
class AxisOrder<float> {
 public:
  explicit AxisOrder(const Vec3<float>& direction) {
    const Vec3<float> size = abs(direction);
    // Without branches: the largest component is a guess to a processor.
    const int x_over_y = size.x > size.y ? 1 : 0;
    const int z_is_x = x_over_y & (size.x > size.z ? 1 : 0);
    const int z_is_y = (x_over_y ^ 1) & (size.y > size.z ? 1 : 0);
    kz = 2 - 2 * z_is_x - z_is_y;
    kx = z_is_y != 0 ? 2 : z_is_x;
    ky = 3 - kx - kz;
  }
  float x_of(const Vec3<float>& v) const { return (&v.x)[kx]; }
  float y_of(const Vec3<float>& v) const { return (&v.x)[ky]; }
  float z_of(const Vec3<float>& v) const { return (&v.x)[kz]; }

  int kx, ky, kz;
};

/// The watertight test reads this of a ray: the order of axes, and the shear that aligns it with the z axis.
template <class F>
struct ShearedRay {
  AxisOrder<F> axes;
  F shear_x, shear_y;  ///< at most 1 in size
  F direction_z;

  ShearedRay() = default;
  explicit ShearedRay(const Vec3<F>& direction) : axes(direction), direction_z(axes.z_of(direction)) {
    shear_x = axes.x_of(direction) / direction_z;
    shear_y = axes.y_of(direction) / direction_z;
  }
};

/// Shears a vertex, given relative to the origin and with its axes in the ray's order, into ray space: there the ray
/// runs along the z axis. z keeps the units of the scene.
template <class F>
[[gnu::always_inline]] inline Vec3<F> sheared(const F& x, const F& y, const F& z, const F& shear_x, const F& shear_y) {
  return {x - shear_x * z, y - shear_y * z, z};
}
template <class F>
[[gnu::always_inline]] inline Vec3<F> to_ray_space(const ShearedRay<F>& ray, const Vec3<F>& from_origin) {
  return sheared(ray.axes.x_of(from_origin), ray.axes.y_of(from_origin), ray.axes.z_of(from_origin), ray.shear_x,
                 ray.shear_y);
}

/// Twice the signed areas opposite the vertices a, b and c.
template <class F>
struct EdgeFunctions {
  F u, v, w;
};
template <class F>
[[gnu::always_inline]] inline EdgeFunctions<F> edge_functions(const F& ax, const F& ay, const F& bx, const F& by,
                                                              const F& cx, const F& cy) {
  return {cx * by - cy * bx, ax * cy - ay * cx, bx * ay - by * ax};
}
/// Whether two of them differ in sign: then the ray passes the triangle by.
template <class F>
[[gnu::always_inline]] inline MaskOf<F> differ_in_sign(const EdgeFunctions<F>& e) {
  const MaskOf<F> one_below = min(e.w, min(e.v, e.u)) < F(0.0f);
  const MaskOf<F> one_above = F(0.0f) < max(e.w, max(e.v, e.u));
  return one_below & one_above;
}

/// The edge functions err by roundings of max|z| max|x, y|, so t errs by roundings of
///   slope = max|z| max|x, y| (extent of the triangle along z) / (|z| det),
/// which for a triangle far away is how steeply it stands against the ray. Up to kTrustedSlope t is taken as it is, a
/// few roundings off; beyond, for one hit in ten, it is computed again in double. Of a negative t only the sign
/// matters, and it is right up to kTrustedSignSlope; so a ray that leaves a triangle, as every scattered ray does,
/// needs no double.
constexpr float kTrustedSlope = 3.0f;
constexpr float kTrustedSignSlope = 0x1p19f;
/// A t that is not trusted errs by no more than |t| kRoughError slope: some 50 roundings of 2^-24, in theory; the slope
/// is that of most_error / depth, since edge functions also err by roundings of max|x, y|^2, and the interpolation by
/// some of max|z|. Where this bound decides the side of the limit, t is not computed again. Smaller errors count as
/// kSmallestError, since their own rounding would matter.
constexpr float kRoughError = 0x1p-18f;
constexpr float kSmallestError = 0x1p-100f;

/// Where a ray meets the plane of a triangle inside whose edges it passes.
template <class F>
struct WatertightHit {
  F t, beta, gamma;   ///< beta and gamma are the weights of b and c
  MaskOf<F> sure;     ///< floats decide that it is inside; else in_double() must
  MaskOf<F> precise;  ///< t is within a few roundings; else plane_distance() has it
  F error, depth;     ///< error / depth is the slope
  F most_error;       ///< the same for a triangle that may be wider than it is far
};

/// From the edge functions, the vertices' z, and the largest |x| and |y| of all three. Interpolates from a: the error
/// of z is then small where the triangle is.
template <class F>
[[gnu::always_inline]] inline WatertightHit<F> watertight_hit(const EdgeFunctions<F>& e, const F& az, const F& bz,
                                                              const F& cz, const F& xy_size, const F& direction_z) {
  WatertightHit<F> hit;
  const F det = e.u + e.v + e.w;
  const F inv_det = F(1.0f) / det;
  hit.beta = e.v * inv_det;
  hit.gamma = e.w * inv_det;
  const F ab = bz - az, ac = cz - az;
  const F z = az + hit.beta * ab + hit.gamma * ac;
  hit.t = z / direction_z;
  const F size = abs(det);
  const F z_size = max(abs(az), max(abs(bz), abs(cz)));
  hit.error = z_size * (max(abs(ab), abs(ac)) * xy_size);
  hit.depth = abs(z) * size;
  hit.most_error = max(z_size, xy_size) * (max(abs(ab), abs(ac)) * xy_size) + z_size * size;
  // Outside these bounds (NaN included) the flushed parts of the products, or 1 / det, would count.
  hit.sure = (F(0x1p-100f) < size) & (size < F(0x1p120f)) & (e.u != F(0.0f)) & (e.v != F(0.0f)) & (e.w != F(0.0f));
  hit.precise =
      (hit.error < F(kTrustedSlope) * hit.depth) | ((hit.t < F(0.0f)) & (hit.error < F(kTrustedSignSlope) * hit.depth));
  return hit;
}

/// Whether a hit with an imprecise t is certainly beyond the limit or, with any_hit, certainly within the interval.
template <bool any_hit, class F>
[[gnu::always_inline]] inline MaskOf<F> side_is_certain(const WatertightHit<F>& hit, const F& t_min, const F& limit) {
  const F margin = max(hit.most_error, F(kSmallestError)) * F(kRoughError) * abs(hit.t);
  const MaskOf<F> beyond = margin < (hit.t - limit) * hit.depth;
  if constexpr (!any_hit) return beyond;
  return beyond | ((margin < (limit - hit.t) * hit.depth) & (margin < (hit.t - t_min) * hit.depth));
}

/// A `facing` below this fraction of the sum of its terms' absolute values means that the ray is nearly parallel to the
/// plane: by the rounding of the edge functions it may then meet the plane outside the triangle.
constexpr double kDoubtfulFacing = 0x1p-12;

/// Distance to the plane of a triangle, in double from the vertices as they are; where the ray runs nearly along the
/// plane, kept within the distances of the vertices, and `otherwise` where it runs along it.
template <class F>
F plane_distance(const AxisOrder<F>& axes, const Vec3<F>& origin, const Vec3<F>& direction, const Vec3<F>& p0,
                 const Vec3<F>& p1, const Vec3<F>& p2, const F& otherwise) {
  using D = DoubleOf<F>;
  const Vec3<D> a(p0);
  const Vec3<D> n = cross(Vec3<D>(p1) - a, Vec3<D>(p2) - a);
  const Vec3<D> facings = Vec3<D>(direction) * n;
  const D facing = facings.x + facings.y + facings.z;
  const D t = dot(a - Vec3<D>(origin), n) / facing;
  const Vec3<D> sizes = abs(facings);
  const auto doubtful = !(D(kDoubtfulFacing) * (sizes.x + sizes.y + sizes.z) < abs(facing));
  if (!any(doubtful)) [[likely]]
    return to_float(t);
  const D origin_z(axes.z_of(origin)), direction_z(axes.z_of(direction));
  const auto at = [&](const Vec3<F>& p) { return (D(axes.z_of(p)) - origin_z) / direction_z; };
  const D t0 = at(p0), t1 = at(p1), t2 = at(p2);
  const D kept = min(max(max(t0, t1), t2), max(min(min(t0, t1), t2), t));
  const auto along = !((facing < D(0.0)) | (D(0.0) < facing));
  return select(doubtful, select(along, otherwise, to_float(kept)), to_float(t));
}

}  // namespace
}  // namespace raylab
