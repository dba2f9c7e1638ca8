#pragma once
#include <cstdint>
#include <vector>

#include "raylab/scene/scene.hpp"

namespace raylab {

/// One corner as the raster view draws it.
struct RasterVertex {
  vec3 position;
  vec3 normal;  ///< unit shading normal; zero: flat, by the triangle
  vec2 uv;
};

/// Triangles of one material: indices [first, first + count).
struct RasterDraw {
  std::uint32_t material;
  std::uint32_t first, count;
};

/// All meshes of a scene, once in full and once with fewer triangles over the same vertices, for while the camera
/// moves. Invalid triangles are left out.
struct RasterGeometry {
  std::vector<RasterVertex> vertices;
  std::vector<std::uint32_t> indices;
  std::vector<RasterDraw> full;
  std::vector<RasterDraw> coarse;  ///< equal to `full` where that is small enough

  std::size_t coarse_triangles() const;
};

/// `most_coarse` triangles are drawn while moving without being simplified; above, each mesh is clustered on a
/// grid (Rossignac and Borrel 1993) so fine that about as many are left.
RasterGeometry raster_geometry(const Scene& scene, std::size_t most_coarse);

}  // namespace raylab
