#include "viewpoint.hpp"

#include <algorithm>
#include <cmath>

namespace raylab {

namespace {

constexpr double kPole = 1.0 * kPi / 180.0;  // radians kept from the up vector

/// Rodrigues' rotation of v around a unit axis.
dvec3 rotated(const dvec3& v, const dvec3& axis, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return v * c + glm::cross(axis, v) * s + axis * (glm::dot(axis, v) * (1.0 - c));
}

}  // namespace

Viewpoint::Viewpoint(const CameraSettings& settings)
    : settings_(settings),
      position_(settings.look_from),
      target_(settings.look_at),
      up_(glm::normalize(dvec3(settings.up))) {}

dvec3 Viewpoint::forward() const { return glm::normalize(target_ - position_); }

void Viewpoint::move(const dvec3& right_up_forward) {
  const dvec3 ahead = forward();
  const dvec3 right = glm::normalize(glm::cross(ahead, up_));
  const dvec3 step = right * right_up_forward.x + up_ * right_up_forward.y + ahead * right_up_forward.z;
  position_ += step;
  target_ += step;
  update();
}

double Viewpoint::allowed_pitch(double pitch) const {
  const double now = std::asin(std::clamp(glm::dot(forward(), up_), -1.0, 1.0));
  const double limit = 0.5 * kPi - kPole;
  // A view that starts beyond the limit may stay there, but not go farther.
  return std::clamp(pitch, std::min(-limit - now, 0.0), std::max(limit - now, 0.0));
}

void Viewpoint::turn(double yaw, double pitch) {
  const dvec3 view = target_ - position_;
  const dvec3 right = glm::normalize(glm::cross(view, up_));
  target_ = position_ + rotated(rotated(view, right, allowed_pitch(pitch)), up_, -yaw);
  update();
}

void Viewpoint::orbit(const dvec3& pivot, double yaw, double pitch) {
  const dvec3 right = glm::normalize(glm::cross(forward(), up_));
  // Going up means looking down.
  const double tilt = allowed_pitch(-pitch);
  const auto turned = [&](const dvec3& p) { return pivot + rotated(rotated(p - pivot, right, tilt), up_, yaw); };
  const dvec3 position = turned(position_);
  target_ = turned(target_);
  position_ = position;
  update();
}

void Viewpoint::go_to(const CameraSettings& settings) {
  position_ = settings.look_from;
  target_ = settings.look_at;
  update();
}

void Viewpoint::set_focus_distance(double distance) {
  settings_.focus_distance = static_cast<float>(std::clamp(distance, 1e-18, 1e18));
}

void Viewpoint::set_defocus_angle(double degrees) {
  settings_.defocus_angle = static_cast<float>(std::clamp(degrees, 0.0, 90.0));
}

void Viewpoint::set_vfov(double degrees) { settings_.vfov = static_cast<float>(std::clamp(degrees, 1.0, 170.0)); }

void Viewpoint::update() {
  settings_.look_from = vec3(position_);
  settings_.look_at = vec3(target_);
}

double natural_speed(const Geometry& geometry, const CameraSettings& camera) {
  const double diagonal = glm::length(dvec3(geometry.bounds().diagonal()));
  const double distance = glm::length(dvec3(camera.look_at) - dvec3(camera.look_from));
  return diagonal > 0.0 ? std::min(0.25 * diagonal, 0.5 * distance) : 0.5 * distance;
}

}  // namespace raylab
