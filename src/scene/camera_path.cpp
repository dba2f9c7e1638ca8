#include "raylab/scene/camera_path.hpp"

#include <algorithm>
#include <cmath>

namespace raylab {
namespace {

/// From b at t = 0 to c at t = 1; a comes before them and d after.
dvec3 catmull_rom(const dvec3& a, const dvec3& b, const dvec3& c, const dvec3& d, double t) {
  return b + 0.5 * t * (c - a + t * (2.0 * a - 5.0 * b + 4.0 * c - d + t * (3.0 * (b - c) + d - a)));
}

}  // namespace

CameraSettings camera_on_path(std::span<const CameraSettings> cameras, double place) {
  const double last = static_cast<double>(cameras.size() - 1);
  const double clamped = std::clamp(place, 0.0, last);
  const auto start = static_cast<std::size_t>(std::min(std::floor(clamped), std::max(last - 1.0, 0.0)));
  const double t = clamped - static_cast<double>(start);
  const CameraSettings& from = cameras[start];
  if (t == 0.0) return from;
  const CameraSettings& to = cameras[start + 1];
  if (t == 1.0) return to;
  const auto along = [&](vec3 CameraSettings::*member) {
    const dvec3 b(from.*member), c(to.*member);
    // Before the first and after the last the path goes on straight.
    const dvec3 a = start > 0 ? dvec3(cameras[start - 1].*member) : 2.0 * b - c;
    const dvec3 d = start + 2 < cameras.size() ? dvec3(cameras[start + 2].*member) : 2.0 * c - b;
    return vec3(catmull_rom(a, b, c, d, t));
  };
  const auto evenly = [&](float a, float b) { return static_cast<float>((1.0 - t) * double{a} + t * double{b}); };
  CameraSettings camera;
  camera.look_from = along(&CameraSettings::look_from);
  camera.look_at = along(&CameraSettings::look_at);
  const dvec3 up = (1.0 - t) * glm::normalize(dvec3(from.up)) + t * glm::normalize(dvec3(to.up));
  camera.up = glm::length(up) > 1e-6 ? vec3(up) : from.up;
  camera.vfov = evenly(from.vfov, to.vfov);
  camera.defocus_angle = evenly(from.defocus_angle, to.defocus_angle);
  camera.focus_distance = evenly(from.focus_distance, to.focus_distance);
  return camera;
}

}  // namespace raylab
