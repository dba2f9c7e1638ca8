#pragma once
#include "raylab/geometry/geometry.hpp"
#include "raylab/scene/scene.hpp"

namespace raylab {

/// A Hit expanded to what shading reads.
struct SurfacePoint {
  vec3 position;
  float offset;  ///< a point this far along ±ng is on that side of the surface for certain
  vec3 ng;       ///< unit geometric normal, by the winding of the triangle; outward on spheres
  vec3 ns;       ///< unit shading normal, on the same side as ng
  vec2 uv;       ///< texture coordinates; (0,0) where absent
  std::uint32_t material;
};

}  // namespace raylab
