#pragma once
// Points of emitters and their densities, over the number type F.
#include "core/simd/lanes.hpp"
#include "raylab/core/numeric.hpp"

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

/// A point of an emitting triangle as seen from elsewhere.
template <class F>
struct TriangleLightSample {
  Vec3<F> position, wi;  ///< as in LightSample
  F end;                 ///< as in LightSample
  F b1, b2;              ///< barycentric coordinates of the position
  F pdf;                 ///< as in LightSample
};

template <class F>
TriangleLightSample<F> sample_triangle(const EmittingTriangle<F>& emitter, const Vec3<F>& p, const Vec2<F>& u) {
  // Low-distortion map from the square (Heitz 2019, "A Low-Distortion Map Between Triangle and Square").
  TriangleLightSample<F> s;
  const F half_x = F(0.5f) * u.x, half_y = F(0.5f) * u.y;
  const F offset = half_y - half_x;
  const MaskOf<F> upper = offset > F(0.0f);
  s.b1 = select(upper, half_x, half_x - offset);
  s.b2 = select(upper, half_y + offset, half_y);
  s.position = emitter.p0 + (s.b1 * emitter.e1 + s.b2 * emitter.e2);
  const Vec3<F> to_light = s.position - p;
  const F distance2 = dot(to_light, to_light);
  const F facing = dot(to_light, emitter.ng);
  const F distance = sqrt(distance2);
  s.wi = to_light / distance;
  const F inv_facing = F(1.0f) / abs(facing);
  const F pdf = emitter.pdf_area * distance2 * distance * inv_facing;
  s.pdf = select((distance2 > F(0.0f)) & (facing != F(0.0f)) & (pdf < F(kInfinity)), pdf, F(0.0f));
  s.end = shadow_end(to_light, emitter.ng, emitter.offset, inv_facing);
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
