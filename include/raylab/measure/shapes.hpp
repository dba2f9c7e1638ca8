#pragma once
// Geometry made by formula or at random, to try accelerators on.
#include <cstdint>
#include <vector>

#include "raylab/geometry/geometry.hpp"

namespace raylab {

/// Closed mesh: an icosahedron whose triangles are each split into four `levels` times, vertices moved onto the
/// sphere. 20 · 4^levels triangles; neighbours share their vertices by index.
TriangleMesh icosphere(const vec3& center, float radius, int levels);

/// Closed box of twelve triangles with its normals outwards.
TriangleMesh box_mesh(const vec3& lower, const vec3& upper);

/// `count` separate triangles with centres uniform in [-extent, extent]³ and edges up to about `size` long.
TriangleMesh triangle_soup(std::size_t count, float extent, float size, std::uint64_t seed);

/// Spheres with centres uniform in [-extent, extent]³ and radii between a tenth of `radius` and `radius`.
std::vector<Sphere> sphere_soup(std::size_t count, float extent, float radius, std::uint64_t seed);

}  // namespace raylab
