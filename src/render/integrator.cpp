#include "raylab/render/integrator.hpp"

#include <array>
#include <string>
#include <utility>

#include "raylab/core/error.hpp"
#include "raylab/core/frame.hpp"
#include "raylab/render/bsdf.hpp"
#include "raylab/scene/surface_point.hpp"

namespace raylab {

namespace {

// What a scene can do without (SceneNeeds) in the innermost loop. A bit that is off takes the branch out at compile
// time, and with it the loads behind it.
constexpr unsigned kSampleLights = 1;  ///< emitters are sampled; off in the book's integrator
constexpr unsigned kSpheres = 2;
constexpr unsigned kTextures = 4;
constexpr unsigned kShadingNormals = 8;
constexpr unsigned kFeatureSets = 16;

// Draws of one path segment, from Integrator::kFirstDimension on.
enum Draw : std::uint32_t { kDirection, kLobe, kLightPoint, kLightChoice, kRoulette, kDrawsPerSegment };

// Segments traced before Russian roulette may end a path.
constexpr int kFirstRouletteSegment = 5;

/// Power heuristic for one sample of each strategy (Veach 1997, §9.2).
float mis_weight(float pdf, float other_pdf) {
  const float a = pdf * pdf;
  const float b = other_pdf * other_pdf;
  // Densities whose square overflows are delta-like: they take all of the weight.
  if (a == kInfinity) return 1.0f;
  return a > 0.0f ? a / (a + b) : 0.0f;
}

/// Shadow rays end short of their target by more than the rounding of t; the rest is in the target's own offset.
constexpr float kShadowEnd = 1.0f - 32.0f * kUnitRoundoff;

/// t_min of the One Weekend books.
constexpr float kBookOffset = 0.001f;

}  // namespace

IntegratorKind parse_integrator(std::string_view name) {
  if (name == "path") return IntegratorKind::path;
  if (name == "book") return IntegratorKind::book;
  throw Error(ErrorKind::usage, "--integrator",
              "unknown integrator \"" + std::string(name) + "\"; expected path or book");
}

std::string_view integrator_name(IntegratorKind kind) { return kind == IntegratorKind::path ? "path" : "book"; }

template <std::size_t... kIndex>
Integrator::Estimate Integrator::choose(unsigned features, std::index_sequence<kIndex...>) {
  static constexpr std::array<Estimate, sizeof...(kIndex)> kTable{&Integrator::estimate<kIndex>...};
  return kTable[features];
}

Integrator::Integrator(const Scene& scene, const Accelerator& accelerator, const SceneNeeds& needs,
                       const IntegratorSettings& settings)
    : scene_(scene), accelerator_(accelerator), settings_(settings), lights_(scene, needs) {
  unsigned features = 0;
  if (settings.kind == IntegratorKind::path && !lights_.empty()) features |= kSampleLights;
  if (needs.spheres) features |= kSpheres;
  if (needs.textures) features |= kTextures;
  if (needs.shading_normals) features |= kShadingNormals;
  estimate_ = choose(features, std::make_index_sequence<kFeatureSets>());
}

template <unsigned kFeatures>
Rgb Integrator::estimate(const Integrator& self, const Ray& camera_ray, const Sampler& sampler, RayCounts& counts) {
  constexpr bool has_lights = (kFeatures & kSampleLights) != 0;
  constexpr bool has_spheres = (kFeatures & kSpheres) != 0;
  constexpr bool has_textures = (kFeatures & kTextures) != 0;
  constexpr bool has_shading_normals = (kFeatures & kShadingNormals) != 0;
  const Scene& scene = self.scene_;
  const Accelerator& accelerator = self.accelerator_;
  const bool book_offset = self.settings_.ray_offset == RayOffset::book;
  const bool roulette = self.settings_.kind == IntegratorKind::path;
  const int max_depth = self.settings_.max_depth;

  Rgb radiance(0.0f);
  Rgb throughput(1.0f);
  float eta_scale = 1.0f;    // undoes the radiance scaling of refraction, so that roulette sees the path's power
  float scatter_pdf = 0.0f;  // density of the last direction; 0: light sampling could not have found it
  vec3 scatter_position(0.0f);
  Ray ray{camera_ray.origin, glm::normalize(camera_ray.direction)};  // unit from here on
  ++counts.camera;

  for (int segment = 1;; ++segment) {
    const std::optional<Hit> hit = accelerator.intersect(ray);
    if (!hit) {
      Rgb arriving = scene.environment.radiance(ray.direction);
      if (has_lights && scatter_pdf > 0.0f) {
        arriving *= mis_weight(scatter_pdf, self.lights_.environment_pdf(ray.direction));
      }
      return radiance + throughput * arriving;
    }

    const SurfacePoint point = surface_point<has_spheres, has_textures, has_shading_normals>(scene.geometry, ray, *hit);
    const std::uint32_t material_id = scene.material_of(hit->geometry, hit->primitive);
    const Material& material = scene.materials[material_id];
    const Rgb color = has_textures ? texture_color(material.color, scene.textures, point.position, point.uv)
                                   : material.color.a;
    const vec3 wo = -ray.direction;

    if (material.kind == Material::Kind::diffuse_light) {
      float weight = 1.0f;
      if (has_lights && scatter_pdf > 0.0f) {
        const bool sphere = has_spheres && scene.geometry.is_sphere(hit->geometry);
        const float light_pdf =
            sphere ? self.lights_.sphere_pdf(hit->primitive, material_id, scatter_position, point.position, -wo)
                   : self.lights_.triangle_pdf(material_id, scatter_position, point.position, point.ng, -wo);
        weight = mis_weight(scatter_pdf, light_pdf);
      }
      return radiance + throughput * color * weight;
    }
    if (segment >= max_depth) return radiance;

    // The shading frame on wo's side. Where interpolation turns the shading normal away from wo, the geometric one
    // takes its place: a surface is seen from the side it is on.
    const bool inside = glm::dot(wo, point.ng) < 0.0f;
    const vec3 ng = inside ? -point.ng : point.ng;
    vec3 ns = ng;
    if constexpr (has_shading_normals) {
      ns = inside ? -point.ns : point.ns;
      if (!(glm::dot(wo, ns) > 0.0f)) ns = ng;
    }
    const bool bent = has_shading_normals && ns != ng;
    const Frame frame(ns);
    const vec3 wo_local = frame.to_local(wo);
    const std::uint32_t draws =
        kFirstDimension + static_cast<std::uint32_t>(segment - 1) * kDrawsPerSegment;

    if (has_lights && has_density(material)) {
      const LightSample light = self.lights_.sample(point.position, sampler.get1(draws + kLightChoice),
                                                    sampler.get2(draws + kLightPoint));
      if (light.pdf > 0.0f && glm::dot(light.wi, ng) > 0.0f) {
        const vec3 wi_local = frame.to_local(light.wi);
        const BsdfValue f = bent ? eval_bsdf_above(material, color, wo_local, wi_local, frame.to_local(ng))
                                 : eval_bsdf(material, color, wo_local, wi_local);
        if (f.pdf > 0.0f) {
          const vec3 start = book_offset ? point.position : offset_origin(point, light.wi);
          const Ray shadow = light.infinite ? Ray{start, light.wi} : Ray{start, light.target - start, 0.0f, kShadowEnd};
          ++counts.shadow;
          if (!accelerator.occluded(shadow)) {
            radiance += throughput * f.value * light.radiance * (mis_weight(light.pdf, f.pdf) / light.pdf);
          }
        }
      }
    }

    const vec2 u = sampler.get2(draws + kDirection);
    const float lobe = material.kind == Material::Kind::dielectric ? sampler.get1(draws + kLobe) : 0.0f;
    const BsdfSample scattered =
        bent ? sample_bsdf_above(material, color, wo_local, frame.to_local(ng), inside, u, lobe)
             : sample_bsdf(material, color, wo_local, inside, u, lobe);
    if (is_black(scattered.weight)) return radiance;
    const vec3 wi = frame.to_world(scattered.wi);
    throughput *= scattered.weight;
    eta_scale *= scattered.eta_squared;
    scatter_pdf = scattered.delta ? 0.0f : scattered.pdf;
    scatter_position = point.position;

    if (roulette && segment >= kFirstRouletteSegment) {
      const float survival = max_component(throughput) * eta_scale;
      if (survival < 1.0f) {
        if (sampler.get1(draws + kRoulette) >= survival) return radiance;
        throughput /= survival;
      }
    }
    ray = book_offset ? Ray{point.position, wi, kBookOffset} : Ray{offset_origin(point, wi), wi};
    ++counts.scattered;
  }
}

}  // namespace raylab
