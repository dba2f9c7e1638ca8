// A flight through cameras.
#include <array>

#include "catch.hpp"
#include "raylab/scene/camera_path.hpp"

using namespace raylab;

namespace {

CameraSettings at(const vec3& eye, float vfov) {
  CameraSettings camera;
  camera.look_from = eye;
  camera.look_at = eye + vec3(0, 0, -1);
  camera.vfov = vfov;
  return camera;
}

}  // namespace

TEST_CASE("a path passes through its cameras and ends at the first and the last", "[unit]") {
  const std::array cameras = {at(vec3(0), 20), at(vec3(1, 2, 0), 40), at(vec3(3, 0, 1), 30)};
  for (std::size_t i = 0; i < cameras.size(); ++i) CHECK(camera_on_path(cameras, static_cast<double>(i)) == cameras[i]);
  CHECK(camera_on_path(cameras, -1.0) == cameras[0]);
  CHECK(camera_on_path(cameras, 9.0) == cameras[2]);
  CHECK(camera_on_path(cameras, 0.5).vfov == 30.0f);
  CHECK(camera_on_path(std::span(cameras).first(1), 0.5) == cameras[0]);
}

TEST_CASE("a path has no corners, and is straight where its cameras are", "[unit]") {
  const std::array bent = {at(vec3(0), 40), at(vec3(1, 0, 0), 40), at(vec3(1, 1, 0), 40)};
  constexpr double kStep = 1e-3;
  const auto direction = [&](double place) {
    return glm::normalize(camera_on_path(bent, place + kStep).look_from - camera_on_path(bent, place).look_from);
  };
  CHECK(glm::dot(direction(1.0 - kStep), direction(1.0)) > 0.9999f);
  const std::array line = {at(vec3(0), 40), at(vec3(1, 0, 0), 40), at(vec3(2, 0, 0), 40)};
  CHECK(glm::length(camera_on_path(line, 0.25).look_from - vec3(0.25f, 0, 0)) < 1e-6f);
  CHECK(glm::length(camera_on_path(line, 1.5).look_from - vec3(1.5f, 0, 0)) < 1e-6f);
}
