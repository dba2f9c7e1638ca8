#pragma once
// Points of emitters and their densities, over the number type F.
#include "core/frame.hpp"
#include "core/simd/lanes.hpp"
#include "core/warp.hpp"
#include "raylab/core/numeric.hpp"
#include "scene/surface_lanes.hpp"

namespace raylab {
namespace {

/// What sampling reads of an emitting triangle.
template <class F>
struct EmittingTriangle {
  Vec3<F> p0, e1, e2;
  Vec3<F> ng;
  F offset;    ///< see SurfacePoint::offset
  F pdf_area;  ///< choice included
};

constexpr float kBelowOne = 0x1.fffffep-1f;

/// Where a number lies among those from `first` on that choose an emitter of probability 1 / scale, in [0, 1).
template <class F>
F left_of_choice(const F& number, const F& first, const F& scale) {
  return min((number - first) * scale, F(kBelowOne));
}

/// Where a shadow ray ends, as a share of the way to a point of an emitter with unit normal ng, where inv_facing is
/// 1 / |dot(way, ng)|: so far above the emitter's plane that it cannot meet it, which is the point's offset and the
/// rounding of the way. What covers an emitter from farther off casts its shadow; a share of the way, such as 0.999,
/// would let a lamp shine through. 1, 2 and 3 roundings are seen to fail for a tiny lamp far away, 4 are not.
template <class F>
F shadow_end(const Vec3<F>& way, const Vec3<F>& ng, const F& offset, const F& inv_facing) {
  const F rounding = F(gamma_bound(4)) * dot(abs(way), abs(ng));
  return max(F(1.0f) - (offset + rounding) * inv_facing, F(0.0f));
}

/// A point of an emitting triangle or sphere as seen from elsewhere.
template <class F>
struct EmitterSample {
  Vec3<F> position, wi;  ///< as in LightSample
  Vec3<F> ng;            ///< as in LightSample
  F end;                 ///< as in LightSample
  F b1, b2;              ///< barycentric coordinates of the position; 0 on spheres
  F pdf;                 ///< as in LightSample
};

/// Barycentric coordinates by a low-distortion map from the square (Heitz 2019, "A Low-Distortion Map Between Triangle
/// and Square").
template <class F>
Vec2<F> square_to_triangle(const Vec2<F>& u) {
  const F half_x = F(0.5f) * u.x, half_y = F(0.5f) * u.y;
  const F offset = half_y - half_x;
  const MaskOf<F> upper = offset > F(0.0f);
  return {select(upper, half_x, half_x - offset), select(upper, half_y + offset, half_y)};
}

/// s.position of a triangle as seen from p.
template <class F>
void see_triangle_point(const Vec3<F>& ng, const F& offset, const F& pdf_area, const Vec3<F>& p, EmitterSample<F>& s) {
  const Vec3<F> to_light = s.position - p;
  const F distance2 = dot(to_light, to_light);
  const F facing = dot(to_light, ng);
  const F distance = sqrt(distance2);
  s.wi = to_light / distance;
  s.ng = ng;
  const F inv_facing = F(1.0f) / abs(facing);
  const F pdf = pdf_area * distance2 * distance * inv_facing;
  s.pdf = select((distance2 > F(0.0f)) & (facing != F(0.0f)) & (pdf < F(kInfinity)), pdf, F(0.0f));
  s.end = shadow_end(to_light, ng, offset, inv_facing);
}

template <class F>
EmitterSample<F> sample_triangle(const EmittingTriangle<F>& emitter, const Vec3<F>& p, const Vec2<F>& u) {
  EmitterSample<F> s;
  const Vec2<F> b = square_to_triangle(u);
  s.b1 = b.x;
  s.b2 = b.y;
  s.position = emitter.p0 + (s.b1 * emitter.e1 + s.b2 * emitter.e2);
  see_triangle_point(emitter.ng, emitter.offset, emitter.pdf_area, p, s);
  return s;
}

/// Density per area of a triangle that is chosen with some probability.
template <class F>
F triangle_pdf_area(const F& probability, const Vec3<F>& p0, const Vec3<F>& p1, const Vec3<F>& p2) {
  // In double: the square of a product of two edges soon leaves the range of float.
  using D = DoubleOf<F>;
  const Vec3<D> corner(p0);
  const Vec3<D> n = cross(Vec3<D>(p1) - corner, Vec3<D>(p2) - corner);
  return to_float(D(2.0) * D(probability) / sqrt(dot(n, n)));
}

/// A point of a triangle, given by its corners, of which nothing is kept.
template <class F>
EmitterSample<F> sample_triangle(const MaskOf<F>& lanes, const Vec3<F>& p0, const Vec3<F>& p1, const Vec3<F>& p2,
                                 const F& probability, const Vec3<F>& p, const Vec2<F>& u) {
  EmitterSample<F> s;
  const Vec2<F> b = square_to_triangle(u);
  s.b1 = b.x;
  s.b2 = b.y;
  PointLanes<F> point;
  place_on_triangle<F>(lanes, p0, p1, p2, s.b1, s.b2, point);
  s.position = point.position;
  see_triangle_point(point.ng, point.offset, triangle_pdf_area(probability, p0, p1, p2), p, s);
  return s;
}

/// A sphere as seen from p. In double, since near its surface the distance to the centre cancels with the radius.
template <class F>
struct SeenSphere {
  using D = DoubleOf<F>;
  Vec3<D> to_center;
  D d2, r2;  ///< squared distance of the centre, squared radius

  SeenSphere(const Vec3<F>& center, const F& radius, const Vec3<F>& p)
      : to_center(Vec3<D>(center) - Vec3<D>(p)), d2(dot(to_center, to_center)), r2(D(radius) * D(radius)) {}

  MaskOf<F> from_outside() const { return r2 < d2; }
  /// 1 - cos of the half angle under which it is seen from outside; accurate for small angles.
  D one_minus_cos_max() const { return r2 / d2 / (D(1.0) + sqrt((d2 - r2) / d2)); }
  /// Density of directions within that angle.
  F pdf() const { return to_float(D(1.0) / (D(2.0 * static_cast<double>(kPi)) * one_minus_cos_max())); }
};

/// A point of a sphere that is seen from outside, uniform in the cone of directions that meet the sphere; the angle
/// alpha at its centre gives the point (pbrt-v4 §6.2.4). `probability` is that with which the sphere is chosen.
template <class F>
EmitterSample<F> sample_sphere_outside(const Vec3<F>& center, const F& radius, const F& probability, const Vec3<F>& p,
                                       const Vec2<F>& u) {
  using D = DoubleOf<F>;
  const SeenSphere<F> seen(center, radius, p);
  const D d = sqrt(seen.d2);
  const D one_minus_cos = D(u.x) * seen.one_minus_cos_max();
  const D cos_theta = D(1.0) - one_minus_cos;
  const D sin2_theta = max(D(0.0), one_minus_cos * (D(1.0) + cos_theta));
  const D sin_max = sqrt(seen.r2) / d;
  const D cos_alpha = sin2_theta / sin_max + cos_theta * sqrt(max(D(0.0), D(1.0) - sin2_theta / (sin_max * sin_max)));
  const F sin_alpha = to_float(sqrt(max(D(0.0), D(1.0) - cos_alpha * cos_alpha)));
  F sine, cosine;
  sine_cosine_of_turn<F>(u.y, sine, cosine);
  const BasicFrame<F> frame(to_float(-seen.to_center / d));
  const Vec3<F> n = frame.to_world({sin_alpha * cosine, sin_alpha * sine, to_float(cos_alpha)});
  const Vec3<D> direction(n);  // of unit length only as far as floats can be
  PointLanes<F> point;
  place_on_sphere<F>(Vec3<D>(center), radius, D(radius) / sqrt(dot(direction, direction)) * direction, point);
  EmitterSample<F> s;
  s.position = point.position;
  s.b1 = s.b2 = F(0.0f);
  s.ng = point.ng;
  const Vec3<F> way = s.position - p;
  s.wi = way * (F(1.0f) / sqrt(dot(way, way)));
  const F pdf = probability * seen.pdf();
  s.pdf = select((pdf > F(0.0f)) & (pdf < F(kInfinity)), pdf, F(0.0f));
  s.end = shadow_end(way, point.ng, point.offset, F(1.0f) / abs(dot(way, point.ng)));
  return s;
}

/// Density per steradian at p of a point on a triangle with unit normal ng that a ray of unit direction wi has hit.
template <class F>
F triangle_pdf(const F& pdf_area, const Vec3<F>& p, const Vec3<F>& hit_position, const Vec3<F>& ng, const Vec3<F>& wi) {
  const Vec3<F> to_light = hit_position - p;
  const F cosine = abs(dot(ng, wi));
  return select(cosine > F(0.0f), pdf_area * dot(to_light, to_light) / cosine, F(0.0f));
}

/// A sample of a light as seen from a vertex: see LightSample.
template <class F>
struct SampledLight {
  Vec3<F> wi, position, radiance;
  F end, pdf;
  MaskOf<F> infinite;
  Vec3<F> ng{};
};

}  // namespace
}  // namespace raylab
