#include "raylab/scene/framing.hpp"

namespace raylab {

namespace {

constexpr float kHuge = 25.0f;  // times the radius of all that is smaller: a ground sphere, or a dome

/// Everything that is neither a light, where lights are left out, nor a sphere as large as the ground.
std::vector<PrimitiveId> subjects(const Scene& scene, bool lights) {
  const Geometry& geometry = scene.geometry;
  std::vector<PrimitiveId> kept, spheres;
  Bounds bounds;
  for_each_valid_primitive(geometry, [&](const PrimitiveId& id) {
    const std::uint32_t material = scene.material_of(id.geometry, id.primitive);
    if (!lights && scene.materials[material].kind == Material::Kind::diffuse_light) return;
    if (geometry.is_sphere(id.geometry)) return spheres.push_back(id);
    bounds.extend(primitive_bounds(geometry, id));
    kept.push_back(id);
  });
  const auto radius = [&](const PrimitiveId& id) { return geometry.spheres[id.primitive].radius; };
  std::stable_sort(spheres.begin(), spheres.end(), [&](auto a, auto b) { return radius(a) < radius(b); });
  for (const PrimitiveId& id : spheres) {
    if (!bounds.empty() && radius(id) > kHuge * 0.5f * glm::length(bounds.diagonal())) break;
    bounds.extend(primitive_bounds(geometry, id));
    kept.push_back(id);
  }
  return kept;
}

}  // namespace

CameraSettings frame_scene(const Scene& scene, const CameraSettings& camera, int width, int height) {
  const Geometry& geometry = scene.geometry;
  std::vector<PrimitiveId> framed = subjects(scene, false);
  if (framed.empty()) framed = subjects(scene, true);
  if (framed.empty()) return camera;
  const auto for_each_ball = [&](const auto& visit) {
    for (const PrimitiveId& id : framed) {
      if (geometry.is_sphere(id.geometry)) {
        const Sphere& sphere = geometry.spheres[id.primitive];
        visit(dvec3(sphere.center), static_cast<double>(sphere.radius));
        continue;
      }
      const Triangle t = triangle_corners(geometry.meshes[id.geometry], id.primitive);
      for (const vec3& p : {t.p0, t.p1, t.p2}) visit(dvec3(p), 0.0);
    }
  };
  const dvec3 back = glm::normalize(dvec3(camera.look_from) - dvec3(camera.look_at));
  const Framing framing = frame_balls(for_each_ball, back, dvec3(camera.up), camera.vfov, width, height);
  CameraSettings moved = camera;
  moved.look_at = vec3(framing.center);
  moved.look_from = vec3(framing.center + framing.distance * back);
  return moved;
}

}  // namespace raylab
