#include "raylab/scene/camera.hpp"

#include <cmath>
#include <string>

#include "camera_ray.hpp"
#include "core/angle.hpp"
#include "raylab/core/error.hpp"

namespace raylab {

namespace {

/// Of the distance. A direction of three floats is good to 2^-24, which is a 64th of it.
constexpr double kNarrowPixel = 0x1p-18;

[[noreturn]] void bad(const std::string& key, const std::string& message) {
  throw Error(ErrorKind::input, "camera." + key, message);
}

}  // namespace

Camera::Camera(const CameraSettings& s, int width, int height) {
  if (!(s.vfov > 0.0f && s.vfov < 180.0f)) {
    bad("vfov", "found " + std::to_string(s.vfov) + ", expected degrees between 0 and 180");
  }
  if (!(s.focus_distance > 0.0f && s.focus_distance < kInfinity)) {
    bad("focus_distance", "found " + std::to_string(s.focus_distance) + ", expected a finite distance above 0");
  }
  if (!(s.defocus_angle >= 0.0f && s.defocus_angle < 180.0f)) {
    bad("defocus_angle", "found " + std::to_string(s.defocus_angle) + ", expected degrees from 0 up to 180");
  }
  if (width < 1 || height < 1) {
    bad("width", "a picture of " + std::to_string(width) + "x" + std::to_string(height) + " pixels has none");
  }
  // Double throughout: the camera is made once and every ray depends on it.
  const dvec3 from(s.look_from);
  const dvec3 view = dvec3(s.look_at) - from;
  const double distance = glm::length(view);
  if (!(distance > 0.0)) bad("look_at", "the same point as look_from: there is no view direction");
  const dvec3 forward = view / distance;
  const dvec3 side = glm::cross(forward, dvec3(s.up));
  const double sine = glm::length(side) / std::max(glm::length(dvec3(s.up)), 1e-300);
  if (!(sine > 1e-6)) bad("up", "runs along the view direction from look_from to look_at");
  const dvec3 right = glm::normalize(side);
  const dvec3 up = glm::cross(right, forward);

  const double half_height = sine_cosine_of_degrees(0.5 * static_cast<double>(s.vfov)).tangent() * s.focus_distance;
  const double pixel = 2.0 * half_height / height;
  rays_.origin = s.look_from;
  forward_ = vec3(forward);
  right_ = vec3(right);
  up_ = vec3(up);
  const double focus = s.focus_distance;
  rays_.exact = {focus * forward - 0.5 * pixel * width * right + half_height * up, pixel * right, -pixel * up};
  rays_.corner = vec3(rays_.exact.corner);
  rays_.step_x = vec3(rays_.exact.step_x);
  rays_.step_y = vec3(rays_.exact.step_y);
  rays_.narrow = pixel < kNarrowPixel * focus;
  rays_.has_lens = s.defocus_angle > 0.0f;
  const double lens_radius =
      sine_cosine_of_degrees(0.5 * static_cast<double>(s.defocus_angle)).tangent() * s.focus_distance;
  rays_.lens_x = vec3(lens_radius * right);
  rays_.lens_y = vec3(lens_radius * up);
}

Ray Camera::ray(float x, float y, const vec2& lens) const {
  Vec3<float> origin, direction;
  camera_ray<float>(rays_, x, y, {lens.x, lens.y}, origin, direction);
  return {origin, direction};
}

}  // namespace raylab
