#pragma once
// Scattering of the One Weekend books' materials, each with value, sampling and density in one measure:
// solid angle. Directions are unit vectors in the local frame whose z axis is the shading normal on the side of
// `wo`; `wo` points back along the path and has z > 0, `wi` to where the light comes from.
#include "core/warp.hpp"
#include "raylab/core/numeric.hpp"
#include "raylab/scene/material.hpp"

namespace raylab {
namespace {

/// What scattering reads of a material; over the number type F.
template <class F>
struct MaterialLanes {
  F kind;  ///< Material::Kind as a number
  F fuzz;
  F index;

  /// From column(k) for the k-th of them.
  template <class Column>
  static MaterialLanes of(const Column& column) {
    return {column(0), column(1), column(2)};
  }
  MaskOf<F> is(Material::Kind k) const { return kind == F(static_cast<float>(k)); }
};
constexpr int kMaterialParameters = sizeof(MaterialLanes<float>) / sizeof(float);
inline MaterialLanes<float> material_lanes(const Material& m) { return {static_cast<float>(m.kind), m.fuzz, m.index}; }

/// A direction chosen by a BSDF.
template <class F>
struct BsdfSample {
  Vec3<F> wi = Vec3<F>(F(0.0f));
  Vec3<F> weight = Vec3<F>(F(0.0f));  ///< f cos / pdf; 0: absorbed
  F pdf = F(0.0f);                    ///< per steradian; 0 for a delta direction
  F eta_squared = F(1.0f);  ///< squared ratio of the indices crossed: by it radiance, and so the weight, has shrunk
  MaskOf<F> delta{};        ///< the only direction of its kind: light sampling cannot find it
};

/// f cos and the density with which sample() would choose wi.
template <class F>
struct BsdfValue {
  Vec3<F> value = Vec3<F>(F(0.0f));
  F pdf = F(0.0f);
};

/// Fraction of unpolarised light a smooth boundary reflects. cos_i in [0, 1] on the side of wo; eta = index beyond /
/// index on this side. Sets cos_t, 0 on total reflection. Exact Fresnel equations, not Schlick's approximation.
template <class F>
F fresnel_dielectric(const F& cos_i, const F& eta, F& cos_t) {
  const F sin2_t = (F(1.0f) - cos_i * cos_i) / (eta * eta);
  const MaskOf<F> total = sin2_t >= F(1.0f);
  cos_t = select(total, F(0.0f), sqrt(F(1.0f) - sin2_t));
  const F parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
  const F perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
  return select(total, F(1.0f), F(0.5f) * (parallel * parallel + perpendicular * perpendicular));
}

/// Density per steradian of the direction of r + f s, r the unit mirror direction, s uniform on the unit sphere and
/// fuzz f in (0, 1]. Along direction w the sphere of radius f around r is met at t1,2 = cos ± root with
/// root = sqrt(f² - sin²), each meeting with density t² / (4 pi f root); behind the origin it does not count.
/// At the rim, where the root is 0, the density is infinite; here it ends at what rounding can tell. A direction that
/// was `sampled` is within the rim even where rounding has put it beyond.
template <class F>
F fuzzy_mirror_pdf(const Vec3<F>& r, const Vec3<F>& w, const F& fuzz, bool sampled) {
  const Vec3<F> c = cross(r, w);  // sin² from the cross product: 1 - cos² cancels for small fuzz
  const F root2 = fuzz * fuzz - dot(c, c);
  const F root = sqrt(max(root2, F(4.0f * kUnitRoundoff) * fuzz));
  const F cosine = dot(r, w);
  const F t1 = max(F(0.0f), cosine + root);
  const F t2 = max(F(0.0f), cosine - root);
  const F pdf = (t1 * t1 + t2 * t2) / (F(4.0f * kPi) * fuzz * root);
  return sampled ? pdf : select(root2 > F(0.0f), pdf, F(0.0f));
}

template <class V>
V mirror(const V& wo) {
  return {-wo.x, -wo.y, wo.z};
}

/// Metal that blurs less than this is sampled by scattering alone, as a mirror is: a direction's rounding, 2^-23, would
/// count beside the width of its lobe, so that no density fits the directions.
constexpr float kLeastFuzz = 0x1p-16f;

/// Where light sampling can contribute: diffuse surfaces and metal that blurs.
template <class F>
MaskOf<F> has_density(const MaterialLanes<F>& m) {
  const MaskOf<F> lambertian = m.is(Material::Kind::lambertian);
  const MaskOf<F> rough = m.is(Material::Kind::metal) & (m.fuzz >= F(kLeastFuzz));
  return lambertian | rough;
}

/// Where sample_bsdf() reads its `lobe`.
template <class F>
MaskOf<F> has_lobes(const MaterialLanes<F>& m) {
  return m.is(Material::Kind::dielectric);
}

/// f cos and pdf for a direction; both 0 below the surface and for delta materials.
template <class F>
BsdfValue<F> eval_bsdf(const MaterialLanes<F>& m, const Vec3<F>& color, const Vec3<F>& wo, const Vec3<F>& wi) {
  F pdf(0.0f);
  const MaskOf<F> lambertian = m.is(Material::Kind::lambertian);
  if (any(lambertian)) pdf = select(lambertian, wi.z * F(kInvPi), pdf);
  const MaskOf<F> rough = m.is(Material::Kind::metal) & (m.fuzz >= F(kLeastFuzz));
  if (any(rough)) pdf = select(rough, fuzzy_mirror_pdf<F>(mirror(wo), wi, m.fuzz, false), pdf);
  pdf = select(wi.z > F(0.0f), pdf, F(0.0f));
  return {color * pdf, pdf};
}

/// Chooses wi. `inside` says that wo runs inside the dielectric, that is, on the side the geometric normal points
/// away from. u chooses the direction, lobe the reflection or refraction.
template <class F>
BsdfSample<F> sample_bsdf(const MaterialLanes<F>& m, const Vec3<F>& color, const Vec3<F>& wo, const MaskOf<F>& inside,
                          const Vec2<F>& u, const F& lobe) {
  const Vec3<F> black(F(0.0f));
  BsdfSample<F> s;
  const MaskOf<F> lambertian = m.is(Material::Kind::lambertian);
  if (any(lambertian)) {
    s.wi = cosine_hemisphere<F>(u.x, u.y);
    s.pdf = s.wi.z * F(kInvPi);
    s.weight = select(lambertian & (s.pdf > F(0.0f)), color, black);
  }
  const MaskOf<F> metal = m.is(Material::Kind::metal);
  if (any(metal)) {
    const Vec3<F> r = mirror(wo);
    const MaskOf<F> smooth = metal & (m.fuzz == F(0.0f));
    const MaskOf<F> rough = metal & (m.fuzz > F(0.0f));
    if (any(rough)) {
      const Vec3<F> blurred = r + m.fuzz * uniform_sphere<F>(u.x, u.y);
      const F length2 = dot(blurred, blurred);
      const Vec3<F> wi = blurred / sqrt(length2);
      // Into the surface: absorbed, as in the book.
      const MaskOf<F> reflected = rough & (length2 > F(0.0f)) & (wi.z > F(0.0f));
      s.wi = select(rough, wi, s.wi);
      // Rounding puts some directions beyond the rim: with fuzz 0.05 one in 3,000, 1e-3 one in 350, 1e-6 one in 8.
      s.pdf = select(rough, fuzzy_mirror_pdf<F>(r, wi, m.fuzz, true), s.pdf);
      s.weight = select(reflected, color, s.weight);
    }
    s.wi = select(smooth, r, s.wi);
    s.weight = select(smooth, color, s.weight);
    s.delta = metal & (m.fuzz < F(kLeastFuzz));
    s.pdf = select(s.delta, F(0.0f), s.pdf);
  }
  const MaskOf<F> dielectric = m.is(Material::Kind::dielectric);
  if (any(dielectric)) {
    const F eta = select(inside, F(1.0f) / m.index, m.index);
    F cos_t;
    const F reflectance = fresnel_dielectric<F>(min(wo.z, F(1.0f)), eta, cos_t);
    const MaskOf<F> reflected = lobe < reflectance;
    // Radiance, not power, is carried: refracted, it scales by the square of the indices' ratio (Veach 1997, §5.2).
    const F eta_squared = select(reflected, F(1.0f), eta * eta);
    s.wi = select(dielectric, select(reflected, mirror(wo), Vec3<F>(-wo.x / eta, -wo.y / eta, -cos_t)), s.wi);
    s.weight = select(dielectric, Vec3<F>(F(1.0f) / eta_squared), s.weight);
    s.eta_squared = select(dielectric, eta_squared, s.eta_squared);
    s.pdf = select(dielectric, F(0.0f), s.pdf);
    s.delta = s.delta | dielectric;
  }
  return s;
}

/// w mirrored at the plane with unit normal n.
template <class V>
V mirrored_at(const V& w, const V& n) {
  return w - 2.0f * dot(w, n) * n;
}

/// eval_bsdf() where the geometric normal `ng` (local, on wo's side) is not the shading normal. Part of the lobe then
/// lies below the surface. It is folded up, mirrored at the surface: dropping it would lose energy at every bounce,
/// keeping it would let light through. wi must lie above the surface.
template <class F>
BsdfValue<F> eval_bsdf_above(const MaterialLanes<F>& m, const Vec3<F>& color, const Vec3<F>& wo, const Vec3<F>& wi,
                             const Vec3<F>& ng) {
  BsdfValue<F> f = eval_bsdf<F>(m, color, wo, wi);
  const BsdfValue<F> folded = eval_bsdf<F>(m, color, wo, mirrored_at(wi, ng));
  f.value += folded.value;
  f.pdf += folded.pdf;
  return f;
}

/// sample_bsdf() to match: a direction on the wrong side of the geometric surface is mirrored at it.
template <class F>
BsdfSample<F> sample_bsdf_above(const MaterialLanes<F>& m, const Vec3<F>& color, const Vec3<F>& wo, const Vec3<F>& ng,
                                const MaskOf<F>& inside, const Vec2<F>& u, const F& lobe) {
  BsdfSample<F> s = sample_bsdf<F>(m, color, wo, inside, u, lobe);
  const Vec3<F> folded = mirrored_at(s.wi, ng);
  s.pdf = select(s.delta, s.pdf, s.pdf + eval_bsdf<F>(m, color, wo, folded).pdf);
  s.wi = select((dot(s.wi, ng) > F(0.0f)) ^ (s.wi.z > F(0.0f)), folded, s.wi);
  return s;
}

}  // namespace
}  // namespace raylab
