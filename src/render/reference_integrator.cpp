#include "reference_integrator.hpp"

#include "path_vertex.hpp"
#include "raylab/scene/surface_point.hpp"
#include "sphere_chain_lanes.hpp"

namespace raylab {

namespace {

using Sample = BasicSampler<float>;

/// Light from outside the scene along the path's last ray.
Rgb escaped(const ShadingScene& s, const PathState<float>& path, ChainId chain) {
  Rgb radiance = s.scene.environment.radiance(path.direction);
  if (s.sample_lights) {
    float pdf = s.lights.environment_pdf(path.direction);
    vec3 from = path.scatter_position, direction = path.direction;
    if (s.has_chains()) pdf *= s.chain_share(chain, from, path.origin, direction, direction, direction, true);
    radiance *= met_light_weight(path, pdf);
  }
  return radiance;
}

/// Light that an emitter sends along the path's last ray.
Rgb emitted(const ShadingScene& s, const PathState<float>& path, const Hit& hit, std::uint32_t material,
            const SurfacePoint& point, const Rgb& color, ChainId chain, const vec3& scatter_ng) {
  if (!s.sample_lights) return path.throughput * color;
  vec3 from = path.scatter_position, direction = path.direction;
  float share = 1.0f;
  if (s.has_chains()) share = s.chain_share(chain, from, path.origin, direction, point.position, point.ng, false);
  float pdf = s.scene.geometry.is_sphere(hit.geometry)
                  ? s.lights.sphere_pdf(hit.primitive, material, from, point.position, direction, scatter_ng)
                  : s.lights.triangle_pdf(hit.geometry, hit.primitive, material, from, point.position, point.ng,
                                          direction, scatter_ng);
  if (s.has_chains()) pdf *= share;
  return path.throughput * color * met_light_weight(path, pdf);
}

/// Light from one point of one light that reaches the vertex and goes on along the path.
Rgb direct_light(const ShadingScene& s, const PathVertex<float>& v, const PathState<float>& path, const Sample& sampler,
                 std::uint32_t draw, RayCounts& counts) {
  const auto bits = sampler.bits2(draw + kLightPoint);
  const std::uint64_t select = static_cast<std::uint64_t>(bits.first) << 32 | sampler.bits2(draw + kLightChoice).first;
  const LightSample light = s.lights.sample(v.point.position, select, bits_to_unit(bits.second), v.ng);
  const ShadowRay<float> ray = shadow_ray<float>(
      v, path, {light.wi, light.position, light.radiance, light.end, light.pdf, light.infinite}, s.settings.ray_offset);
  if (!ray.usable) return Rgb(0.0f);
  ++counts.shadow;
  return s.accelerator.occluded({ray.origin, ray.direction, ray.t_min, ray.t_max}) ? Rgb(0.0f) : Rgb(ray.radiance);
}

/// The same over a chain of mirrors.
Rgb mirrored_light(const ShadingScene& s, const PathVertex<float>& v, const PathState<float>& path,
                   const Sample& sampler, std::uint32_t draw, int segment, RayCounts& counts) {
  const auto bits = sampler.bits2(draw + kMirrorPoint);
  const auto choice = sampler.bits2(draw + kMirrorChoice);
  const MirroredLight light = s.mirrors.sample(v.point.position, bits_to_unit(choice.first),
                                               static_cast<std::uint64_t>(bits.first) << 32 | choice.second,
                                               bits_to_unit(bits.second), s.settings.max_depth - segment - 1);
  const ShadowRay<float> first = shadow_ray<float>(
      v, path, {light.wi, light.image, light.radiance, 1.0f, light.pdf, false}, s.settings.ray_offset);
  if (!first.usable) return Rgb(0.0f);
  MirroredRay ray{{first.origin, first.direction, first.t_min}, light.light, light.gap, first.radiance, light.chain, 0};
  while (!s.mirrors.is_last(ray)) {
    ++counts.shadow;
    if (!s.mirrors.reflect(ray, s.accelerator.intersect(ray.ray), s.settings.ray_offset)) return Rgb(0.0f);
  }
  ++counts.shadow;
  return s.accelerator.occluded(ray.ray) ? Rgb(0.0f) : ray.radiance;
}

/// The same over a sphere.
Rgb sphere_light(const ShadingScene& s, const PathVertex<float>& v, const PathState<float>& path, const Sample& sampler,
                 std::uint32_t draw, int segment, RayCounts& counts) {
  const auto bits = sampler.bits2(draw + kSpherePoint);
  const auto choices = sampler.bits2(draw + kSphereChoice);
  const SphereChainTable& table = s.spheres.table();
  const ChosenChain<float> chosen = choose_chain<float>(
      table.count, [&](int k, int row) { return table.columns[k][row]; }, v.point.position,
      bits_to_unit(choices.second));
  const auto column = [&](int k) { return table.columns[k][chosen.row]; };
  const SphereChain<float> chain = sphere_chain<float>(column);
  if (chain.crossings > static_cast<float>(s.settings.max_depth - segment - 2)) return Rgb(0.0f);
  const LightSample from_center = s.lights.sample(
      chain.center, static_cast<std::uint64_t>(bits.first) << 32 | choices.first, bits_to_unit(bits.second));
  const SampledLight<float> light{from_center.wi,  from_center.position, from_center.radiance, from_center.end,
                                  from_center.pdf, from_center.infinite, from_center.ng};
  const LightOverSphere<float> over = light_over_sphere<float>(chain, chosen, v.point.position, light);
  const ShadowRay<float> first = shadow_ray<float>(
      v, path, {over.wi, light.position, light.radiance, kInfinity, over.pdf, true}, s.settings.ray_offset);
  if (!first.usable) return Rgb(0.0f);
  const SphereRays<float> rays = sphere_rays<float>(chain, over, light, first.origin);
  ++counts.shadow;
  if (s.accelerator.occluded({first.origin, rays.first_direction, first.t_min, rays.first_end})) return Rgb(0.0f);
  ++counts.shadow;
  if (s.accelerator.occluded({rays.origin, rays.direction, 0.0f, rays.end})) return Rgb(0.0f);
  return first.radiance * Vec3<float>(column(7), column(8), column(9));
}

/// The argument of shading_normal() in scene/surface_lanes.hpp.
vec3 normal_sum(const Geometry& geometry, const Hit& hit) {
  if (geometry.is_sphere(hit.geometry) || geometry.meshes[hit.geometry].normals.empty()) return vec3(0.0f);
  return interpolated_normal(geometry.meshes[hit.geometry], hit.primitive, hit.u, hit.v);
}

/// Radiance that arrives along the path's first ray.
Rgb Li(const ShadingScene& s, PathState<float> path, const Sample& sampler, RayCounts& counts) {
  const Scene& scene = s.scene;
  Rgb radiance(0.0f);
  float t_min = 0.0f;
  ChainId chain = 0;      // of the specular surfaces since the last vertex from which lights were sampled
  vec3 scatter_ng(0.0f);  // the normal there; over specular surfaces lights are sampled without one
  for (int segment = 1;; ++segment) {
    ++(segment == 1 ? counts.camera : counts.scattered);
    const Ray ray{path.origin, path.direction, t_min};
    const std::optional<Hit> hit = s.accelerator.intersect(ray);
    if (!hit) return radiance + path.throughput * escaped(s, path, chain);

    const SurfacePoint point = surface_point(scene.geometry, ray, *hit);
    const std::uint32_t material_id = scene.material_of(hit->geometry, hit->primitive);
    const Material& material = scene.materials[material_id];
    const Rgb color = texture_color(material.color, scene.textures, point.position, point.uv,
                                    address_mode_of_v(scene.geometry.is_sphere(hit->geometry)));
    if (material.kind == Material::Kind::diffuse_light)
      return radiance + emitted(s, path, *hit, material_id, point, color, chain, scatter_ng);
    if (segment >= s.settings.max_depth) return radiance;

    const Vec3<float> normals = normal_sum(scene.geometry, *hit);
    const PathVertex<float> v =
        path_vertex<float>(material_lanes(material), color, {point.position, point.offset, point.ng}, path.direction,
                           s.needs.shading_normals ? &normals : nullptr);
    const std::uint32_t draw = first_draw(segment);
    if (s.sample_lights && has_density(v.material)) radiance += direct_light(s, v, path, sampler, draw, counts);
    if (!s.mirrors.empty() && has_density(v.material)) {
      radiance += mirrored_light(s, v, path, sampler, draw, segment, counts);
    }
    if (!s.spheres.empty() && has_density(v.material)) {
      radiance += sphere_light(s, v, path, sampler, draw, segment, counts);
    }

    const Vec2<float> u = sampler.get2(draw + kDirection);
    const float lobe = has_lobes(v.material) ? sampler.get1(draw + kLobe) : 0.0f;
    const PathState<float> before = path;
    scatter_ng = v.ng;
    if (!scatter<float>(v, u, lobe, s.settings.ray_offset, path)) return radiance;
    if (s.has_chains()) {
      vec3 from = before.scatter_position;
      const bool reflected = dot(Vec3<float>(path.direction), v.ng) > 0.0f;
      if (before.scatter_pdf > 0.0f && s.follow(hit->geometry, hit->primitive, reflected, chain, from)) {
        path.scatter_pdf = before.scatter_pdf;
        path.scatter_position = from;
        scatter_ng = vec3(0.0f);
      } else {
        chain = 0;
      }
    }
    if (s.settings.kind != IntegratorKind::book) {
      if (!survives_roulette<float>(segment, path, [&] { return sampler.get1(draw + kRoulette); })) return radiance;
    }
    if (s.settings.ray_offset == RayOffset::book) t_min = kBookOffset;
  }
}

}  // namespace

void ReferenceIntegrator::trace(const PathBatch& paths, BatchRadiance& radiance, RayCounts& counts) const {
  for (std::size_t i = 0; i < paths.count; ++i) {
    const Sample sampler(paths.sampler, paths.seed_low[i], paths.seed_high[i], paths.sample[i]);
    const PathState<float> path = camera_path<float>(s_.camera.rays(), sampler, paths.x[i], paths.y[i]);
    const Rgb sample = Li(s_, path, sampler, counts);
    for (int c = 0; c < 3; ++c) radiance[static_cast<std::size_t>(c)][i] = sample[c];
  }
}

}  // namespace raylab
