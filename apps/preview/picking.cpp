#include "picking.hpp"

#include "raylab/core/parallel.hpp"

namespace raylab {

std::optional<Picked> pick(const Scene& scene, const Accelerator& accelerator, const CameraSettings& settings,
                           int width, int height, double x, double y) {
  const FlushDenormals flush;  // as accelerators ask of whoever queries them
  const Camera camera(settings, width, height);
  const vec2 middle_of_lens(0.5f);
  const Ray ray = camera.ray(static_cast<float>(x), static_cast<float>(y), middle_of_lens);
  const std::optional<Hit> hit = accelerator.intersect(ray);
  if (!hit) return std::nullopt;
  const vec3 point = ray.at(hit->t);
  return Picked{point, glm::dot(point - camera.origin(), camera.forward()), hit->geometry, hit->primitive,
                scene.material_of(hit->geometry, hit->primitive)};
}

}  // namespace raylab
