#pragma once
// The formulas that scalar and vector code share, for one float, in GLM's types.
#include "core/frame.hpp"
#include "core/low_discrepancy.hpp"
#include "raylab/core/random.hpp"
#include "render/bsdf.hpp"

namespace raylab::test {

struct GlmFrame {
  vec3 x, y, z;
  explicit GlmFrame(const vec3& n) {
    const Frame f(n);
    x = f.x;
    y = f.y;
    z = f.z;
  }
  vec3 to_local(const vec3& v) const { return {glm::dot(v, x), glm::dot(v, y), glm::dot(v, z)}; }
  vec3 to_world(const vec3& v) const { return v.x * x + v.y * y + v.z * z; }
};

struct GlmBsdfSample {
  vec3 wi, weight;
  float pdf, eta_squared;
  bool delta;
};
struct GlmBsdfValue {
  Rgb value;
  float pdf;
};

inline GlmBsdfSample in_glm(const BsdfSample<float>& s) { return {s.wi, s.weight, s.pdf, s.eta_squared, s.delta}; }
inline GlmBsdfValue in_glm(const BsdfValue<float>& f) { return {f.value, f.pdf}; }

inline GlmBsdfValue eval_bsdf(const Material& m, const Rgb& color, const vec3& wo, const vec3& wi) {
  return in_glm(raylab::eval_bsdf<float>(material_lanes(m), color, wo, wi));
}
inline GlmBsdfSample sample_bsdf(const Material& m, const Rgb& color, const vec3& wo, bool inside, const vec2& u,
                                 float lobe) {
  return in_glm(raylab::sample_bsdf<float>(material_lanes(m), color, wo, inside, {u.x, u.y}, lobe));
}
inline GlmBsdfValue eval_bsdf_above(const Material& m, const Rgb& color, const vec3& wo, const vec3& wi,
                                    const vec3& ng) {
  return in_glm(raylab::eval_bsdf_above<float>(material_lanes(m), color, wo, wi, ng));
}
inline GlmBsdfSample sample_bsdf_above(const Material& m, const Rgb& color, const vec3& wo, const vec3& ng, bool inside,
                                       const vec2& u, float lobe) {
  return in_glm(raylab::sample_bsdf_above<float>(material_lanes(m), color, wo, ng, inside, {u.x, u.y}, lobe));
}
inline bool has_density(const Material& m) { return raylab::has_density(material_lanes(m)); }

inline vec2 disk(const vec2& u) {
  vec2 p;
  concentric_disk<float>(u.x, u.y, p.x, p.y);
  return p;
}
inline vec3 hemisphere(const vec2& u) { return cosine_hemisphere<float>(u.x, u.y); }

}  // namespace raylab::test
