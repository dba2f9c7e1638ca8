#include <cmath>
#include <vector>

#include "catch.hpp"
#include "core_statistics.hpp"
#include "expect_error.hpp"
#include "glm_formulas.hpp"
#include "raylab/scene/camera.hpp"

using namespace raylab;
using raylab::test::chi_square_z;
using raylab::test::expect_error;
using raylab::test::kLimitZ;

namespace {

CameraSettings settings() {
  CameraSettings s;
  s.look_from = {1, 2, 3};
  s.look_at = {4, 1, -2};
  s.up = {0.1f, 1, 0};
  s.vfov = 40.0f;
  s.focus_distance = 7.0f;
  return s;
}

double degrees_between(const vec3& a, const vec3& b) {
  return std::acos(glm::dot(glm::normalize(dvec3(a)), glm::normalize(dvec3(b)))) * 180.0 / kPi;
}

/// Where the ray of a picture position goes, as the picture plane at distance 1 sees it: x right, y up.
vec2 projected(const Camera& camera, float x, float y) {
  const vec3 d = camera.ray(x, y, vec2(0.5f)).direction;
  const float z = glm::dot(d, camera.forward());
  return {glm::dot(d, camera.right()) / z, glm::dot(d, camera.up()) / z};
}

void expect_rejected(const char* place, std::initializer_list<const char*> parts, const CameraSettings& s) {
  expect_error(ErrorKind::input, place, parts, [&] { const Camera camera(s, 4, 3); });
}

}  // namespace

TEST_CASE("the point looked at is in the middle of the picture", "[unit][camera]") {
  const CameraSettings s = settings();
  const Camera camera(s, 640, 480);
  const Ray ray = camera.ray(320.0f, 240.0f, vec2(0.5f));
  CHECK(ray.origin == s.look_from);
  CHECK(degrees_between(ray.direction, s.look_at - s.look_from) < 1e-3);
  CHECK(std::abs(glm::dot(camera.right(), s.up)) < 1e-5f);
  CHECK(glm::dot(camera.up(), s.up) > 0.0f);
}

TEST_CASE("pixels stay where they are from the widest to the narrowest field of view", "[stability][camera]") {
  for (const double vfov : {0.01, 0.02, 0.05, 0.1, 1.0, 40.0, 120.0, 170.0, 179.0}) {
    for (const float focus : {1e-3f, 1.0f, 1e6f}) {
      CameraSettings s = settings();
      s.vfov = static_cast<float>(vfov);
      s.focus_distance = focus;
      s.look_from += vec3(1e5f);
      s.look_at = s.look_from + vec3(3, -1, -5);
      const Camera camera(s, 800, 600);
      const dvec3 forward = glm::normalize(dvec3(3, -1, -5));
      const dvec3 right = glm::normalize(glm::cross(forward, dvec3(s.up)));
      const dvec3 up = glm::cross(right, forward);
      const double pixel = 2.0 * std::tan(static_cast<double>(s.vfov) / 360.0 * 3.14159265358979323846) / 600.0;
      double farthest = 0.0;
      for (int k = 0; k <= 8; ++k) {
        const vec2 at(100.0f * static_cast<float>(k), 600.0f - 75.0f * static_cast<float>(k));
        const dvec3 d(camera.ray(at.x, at.y, vec2(0.5f)).direction);
        const double z = glm::dot(d, forward);
        farthest = std::max({farthest, std::abs(glm::dot(d, right) / z / pixel - (at.x - 400.0)),
                             std::abs(glm::dot(d, up) / z / pixel - (300.0 - at.y))});
      }
      INFO("vfov " << vfov << ", focus " << focus);
      CHECK(farthest < 0.2);
    }
  }
}

TEST_CASE("picture positions are pixels from the upper left, square, under the vertical field of view",
          "[unit][camera]") {
  const Camera camera(settings(), 640, 480);
  const double half = std::tan(20.0 * kPi / 180.0);
  const double pixel = 2.0 * half / 480.0;
  for (const vec2& p : {vec2(0, 0), vec2(640, 0), vec2(0, 480), vec2(640, 480), vec2(320, 240), vec2(17.25f, 400.5f)}) {
    const vec2 seen = projected(camera, p.x, p.y);
    CHECK(seen.x == Approx((p.x - 320.0) * pixel).margin(1e-6));
    CHECK(seen.y == Approx((240.0 - p.y) * pixel).margin(1e-6));
  }
  CHECK(degrees_between(camera.ray(320, 0, vec2(0.5f)).direction, camera.ray(320, 480, vec2(0.5f)).direction) ==
        Approx(40.0).epsilon(1e-4));
}

TEST_CASE("a camera looking along -z has x to the right and y up", "[unit][camera]") {
  const Camera camera(CameraSettings{}, 10, 10);
  CHECK(glm::length(camera.forward() - vec3(0, 0, -1)) < 1e-6f);
  CHECK(glm::length(camera.right() - vec3(1, 0, 0)) < 1e-6f);
  CHECK(glm::length(camera.up() - vec3(0, 1, 0)) < 1e-6f);
  const vec3 corner = camera.ray(0, 0, vec2(0.5f)).direction;
  CHECK(corner.x < 0.0f);
  CHECK(corner.y > 0.0f);
}

TEST_CASE("all rays of a pinhole start at the eye, whatever the lens numbers", "[unit][camera]") {
  const Camera camera(settings(), 4, 3);
  CHECK_FALSE(camera.has_lens());
  CHECK(camera.ray(1.5f, 2.5f, vec2(0.1f, 0.9f)).origin == settings().look_from);
  CHECK(camera.ray(1.5f, 2.5f, vec2(0.1f, 0.9f)).direction == camera.ray(1.5f, 2.5f, vec2(0.7f)).direction);
}

TEST_CASE("rays through a thin lens meet in the plane of focus and fill a disk", "[unit][camera]") {
  CameraSettings s = settings();
  s.defocus_angle = 3.0f;
  const Camera camera(s, 640, 480);
  const Camera pinhole(settings(), 640, 480);
  REQUIRE(camera.has_lens());
  const double radius = std::tan(1.5 * kPi / 180.0) * 7.0;
  double farthest = 0.0, off_axis = 0.0, out_of_plane = 0.0, apart = 0.0;
  for (int i = 0; i < 500; ++i) {
    const std::uint64_t bits = mix_bits(static_cast<std::uint64_t>(i) + 1);
    const vec2 lens(bits_to_unit(static_cast<std::uint32_t>(bits)),
                    bits_to_unit(static_cast<std::uint32_t>(bits >> 32)));
    const Ray ray = camera.ray(100.0f, 50.0f, lens);
    const vec3 from_eye = ray.origin - s.look_from;
    farthest = std::max(farthest, static_cast<double>(glm::length(from_eye)));
    off_axis = std::max(off_axis, static_cast<double>(std::abs(glm::dot(from_eye, camera.forward()))));
    // t = 1 in the plane of focus, where the pinhole's ray passes too.
    const vec3 focus = ray.at(1.0f);
    out_of_plane =
        std::max(out_of_plane, std::abs(glm::dot(dvec3(focus - s.look_from), dvec3(camera.forward())) - 7.0));
    apart = std::max(apart, static_cast<double>(glm::length(focus - pinhole.ray(100.0f, 50.0f, lens).at(1.0f))));
  }
  CHECK(farthest <= radius * 1.00001);
  CHECK(farthest > radius * 0.97);
  CHECK(off_axis < 1e-5);
  CHECK(out_of_plane < 1e-5);
  CHECK(apart < 1e-5);
}

TEST_CASE("the map from the square to the disk keeps areas", "[statistical][camera]") {
  // Cells of equal area: rings at the roots of k / 8, in 16 sectors.
  std::vector<double> counted(8 * 16, 0.0);
  const int side = 400;
  for (int i = 0; i < side; ++i) {
    for (int k = 0; k < side; ++k) {
      const vec2 p = test::disk({(i + 0.5f) / side, (k + 0.5f) / side});
      const float r2 = glm::dot(p, p);
      REQUIRE(r2 <= 1.0f);
      const int ring = std::min(7, static_cast<int>(r2 * 8.0f));
      const float turn = std::atan2(p.y, p.x) / (2.0f * kPi) + 0.5f;
      ++counted[ring * 16 + std::min(15, static_cast<int>(turn * 16.0f))];
    }
  }
  // The grid is far more even than chance; only the places where it cuts a cell show.
  for (const double n : counted) CHECK(n == Approx(side * side / 128.0).epsilon(0.05));
  CHECK(test::disk(vec2(0.5f)) == vec2(0.0f));
  CHECK(glm::length(test::disk(vec2(0.0f))) == Approx(1.0f));
  CHECK(glm::length(test::disk(vec2(kOneMinusEpsilon, 0.0f))) == Approx(1.0f));
}

TEST_CASE("a camera that makes no picture is refused with the key and the value", "[unit][camera]") {
  const float kNaN = std::nanf("");
  for (const float vfov : {0.0f, -1.0f, 180.0f, 400.0f, kNaN, kInfinity}) {
    CameraSettings s = settings();
    s.vfov = vfov;
    expect_rejected("camera.vfov", {"expected degrees between 0 and 180"}, s);
  }
  for (const float distance : {0.0f, -2.0f, kNaN, kInfinity}) {
    CameraSettings s = settings();
    s.focus_distance = distance;
    expect_rejected("camera.focus_distance", {"above 0"}, s);
  }
  for (const float angle : {-0.1f, 180.0f, kNaN, kInfinity}) {
    CameraSettings s = settings();
    s.defocus_angle = angle;
    expect_rejected("camera.defocus_angle", {"from 0 up to 180"}, s);
  }
  CameraSettings s = settings();
  s.look_at = s.look_from;
  expect_rejected("camera.look_at", {"the same point as look_from"}, s);
  for (const vec3& up : {vec3(3, -1, -5), vec3(-3, 1, 5), vec3(3.000001f, -1, -5), vec3(0.0f), vec3(kNaN)}) {
    s = settings();
    s.up = up;
    expect_rejected("camera.up", {"view direction"}, s);
  }
  for (const float bad : {kNaN, kInfinity}) {
    s = settings();
    s.look_from.y = bad;
    CHECK_THROWS_AS(Camera(s, 4, 3), Error);
    s = settings();
    s.look_at.z = bad;
    CHECK_THROWS_AS(Camera(s, 4, 3), Error);
    s = settings();
    s.up.x = bad;
    CHECK_THROWS_AS(Camera(s, 4, 3), Error);
  }
  expect_error(ErrorKind::input, "camera.width", {"0x3"}, [] { const Camera camera(settings(), 0, 3); });
  expect_error(ErrorKind::input, "camera.width", {"3x-1"}, [] { const Camera camera(settings(), 3, -1); });
}

TEST_CASE("cameras far out, tiny and huge point their rays alike", "[unit][camera]") {
  for (const float scale : {1e-12f, 1e-6f, 1.0f, 1e6f, 1e12f}) {
    CameraSettings s = settings();
    s.look_from *= scale;
    s.look_at *= scale;
    s.focus_distance *= scale;
    const Camera camera(s, 64, 48);
    const Camera reference(settings(), 64, 48);
    INFO(scale);
    CHECK(degrees_between(camera.ray(5, 7, vec2(0.5f)).direction, reference.ray(5, 7, vec2(0.5f)).direction) < 1e-3);
  }
}
