#include "raylab/geometry/intersect.hpp"

#include "primitive_test.hpp"

namespace raylab {

std::optional<TriangleHit> intersect_triangle(Intersector intersector, const Ray& ray, const Triangle& triangle,
                                              float t_min, float t_max) {
  return with_primitive_test(intersector, ray, [&](const auto& test) { return test.triangle(triangle, t_min, t_max); });
}

std::optional<std::pair<float, float>> sphere_roots(const Ray& ray, const Sphere& sphere) {
  float nearer, farther;
  if (!sphere_distances(ray.origin, ray.direction, sphere.center, sphere.radius, nearer, farther)) return std::nullopt;
  return std::pair(nearer, farther);
}

std::optional<float> intersect_sphere(Intersector intersector, const Ray& ray, const Sphere& sphere, float t_min,
                                      float t_max) {
  return with_primitive_test(intersector, ray, [&](const auto& test) { return test.sphere(sphere, t_min, t_max); });
}

std::optional<Hit> intersect_primitive(Intersector intersector, const Ray& ray, const Geometry& geometry,
                                       const PrimitiveId& id, float t_min, float t_max) {
  return with_primitive_test(intersector, ray, [&](const auto& test) { return test(geometry, id, t_min, t_max); });
}

}  // namespace raylab
