// How the camera moves, and what it points at.
#include "viewpoint.hpp"

#include <cmath>

#include "../catch.hpp"
#include "picking.hpp"

using namespace raylab;

namespace {

CameraSettings settings() {
  CameraSettings s;
  s.look_from = vec3(0.1f, 0.2f, 5.3f);
  s.look_at = vec3(0.1f, 0.2f, 0.7f);
  s.vfov = 40.0f;
  return s;
}

void check_near(const dvec3& a, const dvec3& b, double margin = 1e-6) {
  INFO(a.x << ' ' << a.y << ' ' << a.z << " should be " << b.x << ' ' << b.y << ' ' << b.z);
  CHECK(glm::length(a - b) < margin);
}

/// Where a point is seen, in pixels of a 200 x 100 picture.
glm::dvec2 seen_at(const CameraSettings& s, const dvec3& p) {
  const Camera camera(s, 200, 100);
  const dvec3 d = p - dvec3(camera.origin());
  const double pixels = 50.0 / (std::tan(0.5 * s.vfov * kPi / 180.0) * glm::dot(d, dvec3(camera.forward())));
  return {100.0 + pixels * glm::dot(d, dvec3(camera.right())), 50.0 - pixels * glm::dot(d, dvec3(camera.up()))};
}

}  // namespace

TEST_CASE("a camera that has not moved has the very numbers of the file", "[unit][preview]") {
  const Viewpoint viewpoint(settings());
  CHECK(viewpoint.settings().look_from == settings().look_from);
  CHECK(viewpoint.settings().look_at == settings().look_at);
}

TEST_CASE("moves go along the view's right, the up vector and the view", "[unit][preview]") {
  Viewpoint viewpoint(settings());
  viewpoint.move({1.0, 2.0, 3.0});
  check_near(dvec3(viewpoint.settings().look_from), dvec3(1.1, 2.2, 2.3));
  check_near(dvec3(viewpoint.settings().look_at), dvec3(1.1, 2.2, -2.3));
}

TEST_CASE("the view turns to the right and upwards, and stops short of the poles", "[unit][preview]") {
  Viewpoint viewpoint(settings());
  viewpoint.turn(0.5 * kPi, 0.0);
  check_near(viewpoint.forward(), dvec3(1, 0, 0));
  viewpoint.turn(0.0, 0.25 * kPi);
  check_near(viewpoint.forward(), dvec3(std::sqrt(0.5), std::sqrt(0.5), 0));
  for (int i = 0; i < 100; ++i) viewpoint.turn(0.3, 1.0);
  CHECK(viewpoint.forward().y > 0.99);
  CHECK_NOTHROW(Camera(viewpoint.settings(), 10, 10));
  for (int i = 0; i < 100; ++i) viewpoint.turn(0.3, -1.0);
  CHECK(viewpoint.forward().y < -0.99);
  CHECK_NOTHROW(Camera(viewpoint.settings(), 10, 10));
}

TEST_CASE("an orbit keeps the distance to the point and its place in the picture", "[unit][preview]") {
  Viewpoint viewpoint(settings());
  const dvec3 pivot(0.5, 0.9, 0.3);
  const double distance = glm::length(viewpoint.position() - pivot);
  const auto before = seen_at(viewpoint.settings(), pivot);
  viewpoint.orbit(pivot, 0.3, 0.2);
  CHECK(viewpoint.position().x > settings().look_from.x);
  CHECK(viewpoint.position().y > settings().look_from.y);
  for (int i = 0; i < 200; ++i) viewpoint.orbit(pivot, 0.1, i % 2 == 0 ? 0.1 : -0.1);
  CHECK(glm::length(viewpoint.position() - pivot) == Approx(distance).epsilon(1e-6));
  const auto after = seen_at(viewpoint.settings(), pivot);
  CHECK(after.x == Approx(before.x).margin(1e-3));
  CHECK(after.y == Approx(before.y).margin(1e-3));
  for (int i = 0; i < 100; ++i) viewpoint.orbit(pivot, 0.0, 1.0);
  CHECK_NOTHROW(Camera(viewpoint.settings(), 10, 10));
  CHECK(glm::length(viewpoint.position() - pivot) == Approx(distance).epsilon(1e-6));
}

TEST_CASE("many small steps add up", "[unit][preview]") {
  CameraSettings far = settings();
  far.look_from += vec3(1e5f, 0.0f, 0.0f);
  far.look_at += vec3(1e5f, 0.0f, 0.0f);
  Viewpoint viewpoint(far);
  for (int i = 0; i < 10000; ++i) viewpoint.move({1e-4, 0.0, 0.0});  // far below a float's last bit there
  CHECK(viewpoint.settings().look_from.x == Approx(far.look_from.x + 1.0f).margin(0.02));
}

TEST_CASE("speed follows the scene, not its ground sphere", "[unit][preview]") {
  Geometry geometry;
  geometry.spheres = {{vec3(0.0f), 1.0f}};
  CHECK(natural_speed(geometry, settings()) == Approx(0.25 * std::sqrt(12.0)));
  geometry.spheres.push_back({vec3(0.0f, -1000.0f, 0.0f), 1000.0f});
  CHECK(natural_speed(geometry, settings()) == Approx(0.5 * 4.6));
  CHECK(natural_speed({}, settings()) > 0.0);
}

TEST_CASE("picking finds what is seen at a pixel and its focus distance", "[unit][preview]") {
  Scene scene;
  scene.geometry.spheres = {{vec3(0.1f, 0.2f, 0.0f), 0.5f}, {vec3(2.1f, 0.2f, -3.0f), 0.5f}};
  scene.sphere_materials = {0, 1};
  scene.materials.resize(2);
  const auto accelerator = make_accelerator("bvh", scene.geometry);
  const auto middle = pick(scene, *accelerator, settings(), 200, 100, 100.0, 50.0);
  REQUIRE(middle);
  CHECK(middle->material == 0);
  CHECK(middle->focus_distance == Approx(4.8));
  const auto at = seen_at(settings(), dvec3(2.1, 0.2, -3.0));
  const auto aside = pick(scene, *accelerator, settings(), 200, 100, at.x, at.y);
  REQUIRE(aside);
  CHECK(aside->material == 1);
  const dvec3 towards = glm::normalize(dvec3(2.1, 0.2, -3.0) - dvec3(settings().look_from));
  check_near(dvec3(aside->point), dvec3(2.1, 0.2, -3.0) - 0.5 * towards, 1e-4);
  CHECK(aside->focus_distance == Approx(settings().look_from.z - aside->point.z));
  CHECK_FALSE(pick(scene, *accelerator, settings(), 200, 100, 1.0, 1.0));
}
