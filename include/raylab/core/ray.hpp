#pragma once
#include "raylab/core/numeric.hpp"
#include "raylab/core/vec.hpp"

namespace raylab {

/// The half line origin + t direction, of which the open interval t_min < t < t_max counts.
/// The direction is any finite vector but zero, of any length; t is in units of that length.
struct Ray {
  vec3 origin;
  vec3 direction;
  float t_min = 0.0f;
  float t_max = kInfinity;

  vec3 at(float t) const { return origin + t * direction; }
};

}  // namespace raylab
