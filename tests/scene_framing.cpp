// A camera moved so that all of a scene is in view.
#include "catch.hpp"
#include "raylab/scene/framing.hpp"

using namespace raylab;

namespace {

/// Where a point is seen: within [-1, 1] both ways is in the picture, z is how far ahead it lies.
dvec3 seen_at(const CameraSettings& s, int width, int height, const dvec3& p) {
  const Camera camera(s, width, height);
  const dvec3 v = p - dvec3(camera.origin());
  const double ahead = glm::dot(v, dvec3(camera.forward()));
  const double half_height = std::tan(0.5 * s.vfov * kPi / 180.0) * ahead;
  return {glm::dot(v, dvec3(camera.right())) / (half_height * width / height),
          glm::dot(v, dvec3(camera.up())) / half_height, ahead};
}

void add_sphere(Scene& scene, const vec3& center, float radius, std::uint32_t material = 0) {
  scene.geometry.spheres.push_back({center, radius});
  scene.sphere_materials.push_back(material);
}

/// A triangle and a ball, beside a lamp far above, on a ground of radius 1000.
Scene some_scene() {
  Scene scene;
  scene.materials.resize(2);
  scene.materials[1].kind = Material::Kind::diffuse_light;
  TriangleMesh mesh;
  mesh.positions = {vec3(-3, 0, 0), vec3(-2, 0, 1), vec3(-2.5f, 1, 0)};
  mesh.triangles = {uvec3(0, 1, 2), uvec3(0, 1, 77)};  // the second is invalid
  scene.geometry.meshes.push_back(mesh);
  scene.mesh_materials.resize(1);
  add_sphere(scene, vec3(2, 0.5f, -1), 0.5f);
  add_sphere(scene, vec3(0, -1000, 0), 1000.0f);
  add_sphere(scene, vec3(0, 300, 0), 20.0f, 1);
  return scene;
}

}  // namespace

TEST_CASE("a framed scene is in view whole and large, but for lights and its ground", "[unit]") {
  const Scene scene = some_scene();
  CameraSettings camera;
  camera.look_from = vec3(40, 500, 3);
  camera.look_at = GENERATE(vec3(0, 0, 0), vec3(41, 500.2f, 3), vec3(40, 300, 2));
  camera.vfov = GENERATE(20.0f, 90.0f);
  camera.focus_distance = 3.0f;
  const int width = GENERATE(300, 100), height = 150;
  const CameraSettings framed = frame_scene(scene, camera, width, height);
  const dvec3 before = glm::normalize(dvec3(camera.look_at) - dvec3(camera.look_from));
  const dvec3 after = glm::normalize(dvec3(framed.look_at) - dvec3(framed.look_from));
  CHECK(glm::length(before - after) < 1e-5);
  CHECK(framed.vfov == camera.vfov);
  CHECK(framed.focus_distance == 3.0f);
  double farthest = 0.0;
  const auto check = [&](const dvec3& p) {
    const dvec3 at = seen_at(framed, width, height, p);
    CHECK(at.z > 0.0);
    farthest = std::max({farthest, std::abs(at.x), std::abs(at.y)});
  };
  for (const vec3& p : scene.geometry.meshes[0].positions) check(dvec3(p));
  for (int i = 0; i < 2000; ++i) {  // points all over the ball
    const double z = 1.0 - (i + 0.5) / 1000.0, turn = 2.4 * i, r = std::sqrt(1.0 - z * z);
    check(dvec3(2, 0.5, -1) + 0.5 * dvec3(r * std::cos(turn), r * std::sin(turn), z));
  }
  CHECK(farthest < 1.0);
  CHECK(farthest > 0.7);
}

TEST_CASE("a scene of lights or of one huge sphere is framed whole, and an empty one not at all", "[unit]") {
  Scene scene;
  scene.materials.resize(1);
  CameraSettings camera;
  CHECK(frame_scene(scene, camera, 10, 10).look_from == camera.look_from);
  scene.materials[0].kind = GENERATE(Material::Kind::lambertian, Material::Kind::diffuse_light);
  add_sphere(scene, vec3(0, 0, 7), 1000.0f);
  const CameraSettings framed = frame_scene(scene, camera, 10, 10);
  CHECK(framed.look_at == vec3(0, 0, 7));
  CHECK(framed.look_from.z == Approx(7.0 + 1.08 * 1000.0 * std::sqrt(2.0)));
}
