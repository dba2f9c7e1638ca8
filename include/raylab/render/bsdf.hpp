#pragma once
// Scattering of the One Weekend books' materials, each with value, sampling and density in one measure:
// solid angle. Directions are unit vectors in the local frame whose z axis is the shading normal on the side of
// `wo`; `wo` points back along the path and has z > 0, `wi` to where the light comes from.
#include <algorithm>
#include <cmath>

#include "raylab/core/numeric.hpp"
#include "raylab/core/vec.hpp"
#include "raylab/scene/camera.hpp"
#include "raylab/scene/material.hpp"

namespace raylab {

/// A direction chosen by a BSDF.
struct BsdfSample {
  vec3 wi = vec3(0.0f);
  Rgb weight = Rgb(0.0f);  ///< f cos / pdf; 0: absorbed
  float pdf = 0.0f;        ///< per steradian; 0 for a delta direction
  float eta_squared = 1.0f;  ///< squared ratio of the indices crossed: by it radiance, and so the weight, has shrunk
  bool delta = false;      ///< the only direction of its kind: light sampling cannot find it
};

/// f cos and the density with which sample() would choose wi.
struct BsdfValue {
  Rgb value = Rgb(0.0f);
  float pdf = 0.0f;
};

/// Fraction of unpolarised light a smooth boundary reflects. cos_i in [0, 1] on the side of wo; eta = index beyond /
/// index on this side. Sets cos_t, 0 on total reflection. Exact Fresnel equations, not Schlick's approximation.
inline float fresnel_dielectric(float cos_i, float eta, float& cos_t) {
  const float sin2_t = (1.0f - cos_i * cos_i) / (eta * eta);
  if (sin2_t >= 1.0f) {
    cos_t = 0.0f;
    return 1.0f;
  }
  cos_t = std::sqrt(1.0f - sin2_t);
  const float parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
  const float perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
  return 0.5f * (parallel * parallel + perpendicular * perpendicular);
}

/// Cosine-weighted direction of the upper hemisphere (Malley's method).
inline vec3 cosine_hemisphere(const vec2& u) {
  const vec2 d = concentric_disk(u);
  return {d.x, d.y, std::sqrt(std::max(0.0f, 1.0f - d.x * d.x - d.y * d.y))};
}

/// Uniform direction of the sphere.
inline vec3 uniform_sphere(const vec2& u) {
  const float z = 1.0f - 2.0f * u.x;
  const float r = std::sqrt(std::max(0.0f, 1.0f - z * z));
  const float phi = 2.0f * kPi * u.y;
  return {r * std::cos(phi), r * std::sin(phi), z};
}

/// Density per steradian of the direction of r + f s, r the unit mirror direction, s uniform on the unit sphere and
/// fuzz f in (0, 1]. Along direction w the sphere of radius f around r is met at t1,2 = cos ± root with
/// root = sqrt(f² - sin²), each meeting with density t² / (4 pi f root); behind the origin it does not count.
/// At the rim, where the root is 0, the density is infinite; here it ends at what rounding can tell. A direction that
/// was `sampled` is within the rim even where rounding has put it beyond.
inline float fuzzy_mirror_pdf(const vec3& r, const vec3& w, float fuzz, bool sampled = false) {
  const vec3 c = glm::cross(r, w);  // sin² from the cross product: 1 - cos² cancels for small fuzz
  const float root2 = fuzz * fuzz - glm::dot(c, c);
  if (!(root2 > 0.0f || sampled)) return 0.0f;
  const float root = std::sqrt(std::max(root2, 4.0f * kUnitRoundoff * fuzz));
  const float cosine = glm::dot(r, w);
  const float t1 = std::max(0.0f, cosine + root);
  const float t2 = std::max(0.0f, cosine - root);
  return (t1 * t1 + t2 * t2) / (4.0f * kPi * fuzz * root);
}

inline vec3 mirror(const vec3& wo) { return {-wo.x, -wo.y, wo.z}; }

/// Whether light sampling can contribute at a surface of this material.
inline bool has_density(const Material& m) {
  return m.kind == Material::Kind::lambertian || (m.kind == Material::Kind::metal && m.fuzz > 0.0f);
}

/// f cos and pdf for a direction; both 0 below the surface and for delta materials.
inline BsdfValue eval_bsdf(const Material& m, const Rgb& color, const vec3& wo, const vec3& wi) {
  if (!(wi.z > 0.0f)) return {};
  if (m.kind == Material::Kind::lambertian) {
    const float pdf = wi.z * kInvPi;
    return {color * pdf, pdf};
  }
  if (m.kind == Material::Kind::metal && m.fuzz > 0.0f) {
    const float pdf = fuzzy_mirror_pdf(mirror(wo), wi, m.fuzz);
    return {color * pdf, pdf};
  }
  return {};
}

/// Chooses wi. `inside` says that wo runs inside the dielectric, that is, on the side the geometric normal points
/// away from. u chooses the direction, lobe the reflection or refraction.
inline BsdfSample sample_bsdf(const Material& m, const Rgb& color, const vec3& wo, bool inside, const vec2& u,
                              float lobe) {
  BsdfSample s;
  switch (m.kind) {
    case Material::Kind::lambertian:
      s.wi = cosine_hemisphere(u);
      s.pdf = s.wi.z * kInvPi;
      if (s.pdf > 0.0f) s.weight = color;
      return s;
    case Material::Kind::metal: {
      const vec3 r = mirror(wo);
      if (m.fuzz == 0.0f) {
        s.wi = r;
        s.delta = true;
        s.weight = color;
        return s;
      }
      const vec3 blurred = r + m.fuzz * uniform_sphere(u);
      const float length2 = glm::dot(blurred, blurred);
      if (!(length2 > 0.0f)) return s;
      s.wi = blurred / std::sqrt(length2);
      if (!(s.wi.z > 0.0f)) return s;  // into the surface: absorbed, as in the book
      // Rounding puts some directions beyond the rim: with fuzz 0.05 one in 3,000, 1e-3 one in 350, 1e-6 one in 8.
      s.pdf = fuzzy_mirror_pdf(r, s.wi, m.fuzz, true);
      s.weight = color;
      return s;
    }
    case Material::Kind::dielectric: {
      const float eta = inside ? 1.0f / m.index : m.index;
      float cos_t;
      const float reflected = fresnel_dielectric(std::min(wo.z, 1.0f), eta, cos_t);
      s.delta = true;
      if (lobe < reflected) {
        s.wi = mirror(wo);
        s.weight = Rgb(1.0f);
        return s;
      }
      s.wi = {-wo.x / eta, -wo.y / eta, -cos_t};
      // Radiance, not power, is carried: it scales by the square of the indices' ratio (Veach 1997, §5.2).
      s.eta_squared = eta * eta;
      s.weight = Rgb(1.0f / s.eta_squared);
      return s;
    }
    case Material::Kind::diffuse_light: return s;
  }
  return s;
}

/// w mirrored at the plane with unit normal n.
inline vec3 mirrored_at(const vec3& w, const vec3& n) { return w - 2.0f * glm::dot(w, n) * n; }

/// eval_bsdf() where the geometric normal `ng` (local, on wo's side) is not the shading normal. Part of the lobe then
/// lies below the surface. It is folded up, mirrored at the surface: dropping it would lose energy at every bounce,
/// keeping it would let light through. wi must lie above the surface.
inline BsdfValue eval_bsdf_above(const Material& m, const Rgb& color, const vec3& wo, const vec3& wi, const vec3& ng) {
  BsdfValue f = eval_bsdf(m, color, wo, wi);
  const BsdfValue folded = eval_bsdf(m, color, wo, mirrored_at(wi, ng));
  f.value += folded.value;
  f.pdf += folded.pdf;
  return f;
}

/// sample_bsdf() to match: a direction on the wrong side of the geometric surface is mirrored at it.
inline BsdfSample sample_bsdf_above(const Material& m, const Rgb& color, const vec3& wo, const vec3& ng, bool inside,
                                    const vec2& u, float lobe) {
  BsdfSample s = sample_bsdf(m, color, wo, inside, u, lobe);
  const vec3 folded = mirrored_at(s.wi, ng);
  if (!s.delta) s.pdf += eval_bsdf(m, color, wo, folded).pdf;
  if ((glm::dot(s.wi, ng) > 0.0f) != (s.wi.z > 0.0f)) s.wi = folded;
  return s;
}

}  // namespace raylab
