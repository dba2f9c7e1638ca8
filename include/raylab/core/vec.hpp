#pragma once
// Vector types of the whole project: GLM's, under short names.
#include <glm/glm.hpp>

namespace raylab {

using vec2 = glm::vec2;
using vec3 = glm::vec3;
using uvec3 = glm::uvec3;
using dvec3 = glm::dvec3;

/// Colours are linear RGB with Rec. 709 primaries; radiance in W / (m² sr) per channel.
using Rgb = glm::vec3;

/// Largest of the three components.
inline float max_component(const vec3& v) { return glm::max(v.x, glm::max(v.y, v.z)); }

/// Relative luminance (Rec. 709) of a linear colour.
inline float luminance(const Rgb& c) { return 0.2126f * c.r + 0.7152f * c.g + 0.0722f * c.b; }

/// True when every component is neither NaN nor infinite.
inline bool is_finite(const vec3& v) {
  // x - x is 0 for finite x and NaN otherwise: one comparison for all three.
  const float zero = (v.x - v.x) + (v.y - v.y) + (v.z - v.z);
  return zero == 0.0f;
}

inline bool is_black(const Rgb& c) { return c.r == 0.0f && c.g == 0.0f && c.b == 0.0f; }

}  // namespace raylab
