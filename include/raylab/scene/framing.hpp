#pragma once
#include <algorithm>
#include <cmath>

#include "raylab/scene/camera.hpp"
#include "raylab/scene/scene.hpp"

namespace raylab {

/// Where to stand so that all of something is in view.
struct Framing {
  dvec3 lower, upper;  ///< of the box around it
  dvec3 center;        ///< of the box: to be looked at
  double radius;       ///< half the box's diagonal; 1 where that is 0
  dvec3 right, up;     ///< of the picture, unit
  double distance;     ///< of the eye from the centre
};

/// Frames balls, of radius 0 for points, which `for_each_ball` hands to a visitor as (dvec3 centre, double radius), the
/// same ones each time it is called. `back` is unit and points from the centre to the eye, `up` is not along it, `vfov`
/// is in degrees, and the picture's width and height are of any unit. Without balls the origin is framed.
template <class ForEachBall>
Framing frame_balls(const ForEachBall& for_each_ball, const dvec3& back, const dvec3& up, double vfov, double width,
                    double height) {
  constexpr double kMargin = 1.08;  // of the distance at which the picture's edge is touched
  Framing framing;
  framing.lower = dvec3(INFINITY);
  framing.upper = dvec3(-INFINITY);
  for_each_ball([&](const dvec3& p, double radius) {
    framing.lower = glm::min(framing.lower, p - radius);
    framing.upper = glm::max(framing.upper, p + radius);
  });
  if (framing.lower.x > framing.upper.x) framing.lower = framing.upper = dvec3(0.0);
  framing.center = 0.5 * (framing.lower + framing.upper);
  framing.radius = 0.5 * glm::length(framing.upper - framing.lower);
  if (!(framing.radius > 0.0)) framing.radius = 1.0;
  framing.right = glm::normalize(glm::cross(up, back));
  framing.up = glm::cross(back, framing.right);
  const double half_height = std::tan(0.5 * vfov * 3.14159265358979323846 / 180.0);
  const double half_width = half_height * width / height;
  // A ball stays within a side of the picture when its centre stays so far within it, measured across the view.
  const double reach_right = std::sqrt(1.0 + half_width * half_width);
  const double reach_up = std::sqrt(1.0 + half_height * half_height);
  framing.distance = 0.01 * framing.radius;
  for_each_ball([&](const dvec3& p, double radius) {
    const dvec3 v = p - framing.center;
    const double across = std::max((std::abs(glm::dot(v, framing.right)) + radius * reach_right) / half_width,
                                   (std::abs(glm::dot(v, framing.up)) + radius * reach_up) / half_height);
    framing.distance = std::max(framing.distance, glm::dot(v, back) + kMargin * across);
  });
  return framing;
}

/// The camera, moved but not turned, so that the scene is in view: all of it but lights, and spheres so much larger
/// than the rest that they are its ground or its sky. A scene of nothing else is framed whole.
CameraSettings frame_scene(const Scene& scene, const CameraSettings& camera, int width, int height);

}  // namespace raylab
