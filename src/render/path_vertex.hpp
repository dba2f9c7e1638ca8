#pragma once
// One segment of a path, over the number type F: what the reference integrator does for one path and the wavefront for
// the lanes of a vector. All formulas of light transport that the two share stand here and in what this includes.
#include "bsdf.hpp"
#include "core/frame.hpp"
#include "light_lanes.hpp"
#include "lights.hpp"
#include "raylab/render/integrator.hpp"
#include "sampler_lanes.hpp"
#include "scene/camera_ray.hpp"
#include "scene/surface_lanes.hpp"

namespace raylab {
namespace {

/// Draws of one path segment, from Integrator::kFirstDimension on. kLightChoice is the lower half of the number whose
/// upper half is kLightPoint's first: see Lights::sample().
enum Draw : std::uint32_t { kDirection, kLobe, kLightPoint, kLightChoice, kRoulette, kDrawsPerSegment };
/// Draws of a segment for light over mirrors and over spheres, apart, so that scenes without have the numbers that they
/// had.
enum SpecularDraw : std::uint32_t {
  kMirrorPoint = 1u << 20,
  kMirrorChoice = 2u << 20,
  kSpherePoint = 3u << 20,
  kSphereChoice = 4u << 20
};

/// First dimension of a segment's draws; the camera ray is segment 1.
constexpr std::uint32_t first_draw(int segment) {
  return Integrator::kFirstDimension + static_cast<std::uint32_t>(segment - 1) * kDrawsPerSegment;
}

/// t_min of the One Weekend books.
constexpr float kBookOffset = 0.001f;

/// A path between two of its vertices.
template <class F>
struct PathState {
  Vec3<F> origin, direction;  ///< of its next ray; the direction is unit
  Vec3<F> throughput;
  F power_scale;  ///< times the throughput: the power left, in parts of what the first surface left
  F scatter_pdf;  ///< density of the direction per steradian; 0: light sampling could not have found it
  Vec3<F> scatter_position;
};

/// The camera ray through a sample of pixel (x, y).
template <class F>
PathState<F> camera_path(const Camera::Rays& camera, const BasicSampler<F>& sampler, const F& x, const F& y) {
  const Vec2<F> jitter = sampler.get2(Integrator::kPixelDimension);
  Vec2<F> lens{F(0.5f), F(0.5f)};
  if (camera.has_lens) lens = sampler.get2(Integrator::kLensDimension);
  PathState<F> path;
  camera_ray<F>(camera, x + jitter.x, y + jitter.y, lens, path.origin, path.direction);
  path.direction = path.direction * (F(1.0f) / sqrt(dot(path.direction, path.direction)));
  path.throughput = Vec3<F>(F(1.0f));
  path.power_scale = F(1.0f);
  path.scatter_pdf = F(0.0f);
  path.scatter_position = path.origin;
  return path;
}

/// Power heuristic for one sample of each strategy (Veach 1997, §9.2).
template <class F>
F mis_weight(const F& pdf, const F& other_pdf) {
  const F a = pdf * pdf;
  const F b = other_pdf * other_pdf;
  // Densities whose square overflows are delta-like: they take all of the weight.
  return select(a == F(kInfinity), F(1.0f), select(a > F(0.0f), a / (a + b), F(0.0f)));
}

/// Weight of light that the path has met by scattering, where light sampling would have found it with `light_pdf`.
template <class F>
F met_light_weight(const PathState<F>& path, const F& light_pdf) {
  return select(path.scatter_pdf > F(0.0f), mis_weight(path.scatter_pdf, light_pdf), F(1.0f));
}

/// A point that scatters, as the path sees it.
template <class F>
struct PathVertex {
  MaterialLanes<F> material;
  Vec3<F> color;
  PointLanes<F> point;
  Vec3<F> ng;           ///< geometric normal on the side of wo, where the path came from
  MaskOf<F> inside;     ///< that is the side which the point's own normal points away from
  MaskOf<F> smooth;     ///< the shading normal is not the geometric one
  BasicFrame<F> frame;  ///< around the shading normal, on the side of wo
  Vec3<F> wo_local;
};

/// `normal_sum` is the argument of shading_normal(); it is 0 for a surface without normals. Where the interpolated
/// normal points away from wo, the geometric normal replaces it.
template <class F>
PathVertex<F> path_vertex(const MaterialLanes<F>& material, const Vec3<F>& color, const PointLanes<F>& point,
                          const Vec3<F>& direction, const Vec3<F>* normal_sum) {
  const Vec3<F> wo = -direction;
  const MaskOf<F> inside = dot(wo, point.ng) < F(0.0f);
  const Vec3<F> ng = select<F>(inside, -point.ng, point.ng);
  Vec3<F> ns = ng;
  MaskOf<F> smooth{};
  if (normal_sum != nullptr) {
    const Vec3<F> interpolated = shading_normal<F>(*normal_sum, ng);
    ns = select<F>(dot(wo, interpolated) > F(0.0f), interpolated, ng);
    smooth = (ns.x != ng.x) | (ns.y != ng.y) | (ns.z != ng.z);
  }
  const BasicFrame<F> frame(ns);
  return {material, color, point, ng, inside, smooth, frame, frame.to_local(wo)};
}

/// Start of a ray that leaves the vertex.
template <class F>
Vec3<F> ray_start(const PathVertex<F>& v, const Vec3<F>& direction, RayOffset offset) {
  return offset == RayOffset::book ? v.point.position : offset_origin<F>(v.point, direction);
}

/// A ray towards a light, and what arrives along it if nothing is in between.
template <class F>
struct ShadowRay {
  Vec3<F> origin, direction;
  F t_min, t_max;
  Vec3<F> radiance;
  MaskOf<F> usable;  ///< elsewhere nothing can arrive, and the rest means nothing
};

template <class F>
ShadowRay<F> shadow_ray(const PathVertex<F>& v, const PathState<F>& path, const SampledLight<F>& light,
                        RayOffset offset) {
  ShadowRay<F> ray;
  ray.usable = (light.pdf > F(0.0f)) & (dot(light.wi, v.ng) > F(0.0f));
  if (!any(ray.usable)) return ray;
  const Vec3<F> wi_local = v.frame.to_local(light.wi);
  BsdfValue<F> f = eval_bsdf<F>(v.material, v.color, v.wo_local, wi_local);
  if (any(v.smooth)) {
    const BsdfValue<F> above = eval_bsdf_above<F>(v.material, v.color, v.wo_local, wi_local, v.frame.to_local(v.ng));
    f.value = select<F>(v.smooth, above.value, f.value);
    f.pdf = select(v.smooth, above.pdf, f.pdf);
  }
  ray.usable = ray.usable & (f.pdf > F(0.0f));
  if (!any(ray.usable)) return ray;
  ray.origin = ray_start(v, light.wi, offset);
  ray.direction = select<F>(light.infinite, light.wi, light.position - ray.origin);
  ray.t_min = F(0.0f);
  if (offset == RayOffset::book) ray.t_min = F(kBookOffset) / sqrt(dot(ray.direction, ray.direction));
  ray.t_max = light.end;
  ray.radiance = path.throughput * f.value * light.radiance * (mis_weight(light.pdf, f.pdf) / light.pdf);
  return ray;
}

/// Scatters the path into its next ray. Returns the lanes that go on; the others are absorbed. u chooses the direction,
/// lobe the reflection or refraction of dielectrics.
template <class F>
MaskOf<F> scatter(const PathVertex<F>& v, const Vec2<F>& u, const F& lobe, RayOffset offset, PathState<F>& path) {
  BsdfSample<F> s = sample_bsdf<F>(v.material, v.color, v.wo_local, v.inside, u, lobe);
  if (any(v.smooth)) {
    const BsdfSample<F> above =
        sample_bsdf_above<F>(v.material, v.color, v.wo_local, v.frame.to_local(v.ng), v.inside, u, lobe);
    s.wi = select<F>(v.smooth, above.wi, s.wi);
    s.pdf = select(v.smooth, above.pdf, s.pdf);
  }
  path.direction = v.frame.to_world(s.wi);
  path.origin = ray_start(v, path.direction, offset);
  path.throughput *= s.weight;
  path.power_scale *= s.eta_squared;  // refraction scales radiance, not power
  path.scatter_pdf = select(s.delta, F(0.0f), s.pdf);
  path.scatter_position = v.point.position;
  return !is_black(s.weight);
}

/// Russian roulette, from the second surface on. A path goes on for certain while it has 1 / kFullSurvival of the power
/// that the first surface left it, and below that in proportion. The first surface's colour is left out since it
/// darkens the whole pixel, whose error counts by its own brightness: a cheap part of what "Adjoint-Driven Russian
/// Roulette and Splitting" (Vorba and Křivánek 2016) does. Returns where the path goes on. `u` gives a uniform number;
/// it is called only if some path may end.
template <class F, class Uniform>
MaskOf<F> survives_roulette(int segment, PathState<F>& path, const Uniform& u) {
  if (segment == 1) path.power_scale = F(1.0f) / max_component(path.throughput);
  const F power = max_component(path.throughput) * path.power_scale;
  const F survival = min(F(Integrator::kFullSurvival) * power, F(1.0f));
  const MaskOf<F> has_power = power > F(0.0f);  // NaN has none, whatever the other lanes have
  if (segment == 1 || !any(survival < F(1.0f))) return has_power;
  path.throughput = path.throughput / survival;
  return has_power & (u() < survival);
}

}  // namespace
}  // namespace raylab
