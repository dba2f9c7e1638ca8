#include "raylab/render/features.hpp"

#include <algorithm>

#include "raylab/core/parallel.hpp"
#include "raylab/scene/surface_point.hpp"

namespace raylab {

namespace {

Rgb albedo_of(const Scene& scene, const Hit& hit, const SurfacePoint& point) {
  const Material& m = scene.materials[scene.material_of(hit.geometry, hit.primitive)];
  if (m.kind == Material::Kind::dielectric) return Rgb(1.0f);
  const Rgb color = texture_color(m.color, scene.textures, point.position, point.uv,
                                  address_mode_of_v(scene.geometry.is_sphere(hit.geometry)));
  return m.kind == Material::Kind::diffuse_light ? glm::min(color, Rgb(1.0f)) : color;
}

}  // namespace

FirstHitFeatures first_hit_features(const Scene& scene, const Accelerator& accelerator, const RenderOptions& options,
                                    std::uint32_t samples) {
  FirstHitFeatures features{Image(options.width, options.height), Image(options.width, options.height), {}};
  features.depth.assign(features.albedo.pixels.size(), kInfinity);
  const Camera camera(options.camera, options.width, options.height);
  const PixelRect region = options.crop.value_or(PixelRect{0, 0, options.width, options.height});
  parallel_for(static_cast<std::size_t>(region.height), [&](std::size_t row) {
    const int y = region.y + static_cast<int>(row);
    for (int x = region.x; x < region.x + region.width; ++x) {
      Rgb albedo(0.0f);
      vec3 normal(0.0f);
      float depth = 0.0f;
      int hits = 0;
      for (std::uint32_t s = 0; s < samples; ++s) {
        const CameraSample sample = camera_sample(camera, options, x, y, options.first_sample + s);
        const std::optional<Hit> hit = accelerator.intersect(sample.ray);
        if (!hit) continue;
        const auto point = surface_point(scene.geometry, sample.ray, *hit);
        albedo += albedo_of(scene, *hit, point);
        normal += glm::dot(point.ng, sample.ray.direction) > 0.0f ? -point.ns : point.ns;
        depth += hit->t * glm::dot(sample.ray.direction, camera.forward());
        ++hits;
      }
      const auto n = static_cast<float>(samples);
      features.albedo.at(x, y) = albedo / n;
      features.normal.at(x, y) = normal / n;
      if (hits > 0) {
        features.depth[static_cast<std::size_t>(y) * options.width + x] = depth / static_cast<float>(hits);
      }
    }
  });
  return features;
}

}  // namespace raylab
