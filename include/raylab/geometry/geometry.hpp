#pragma once
#include <compare>
#include <cstdint>
#include <vector>

#include "raylab/core/bounds.hpp"
#include "raylab/core/vec.hpp"

namespace raylab {

/// Indexed triangles with optional shading normals and texture coordinates.
/// `triangles` holds three indices into `positions` each. Normals and texture coordinates have index arrays of
/// their own; where such an array is empty, `triangles` indexes them too. An empty attribute is absent.
struct TriangleMesh {
  std::vector<vec3> positions;  ///< call pad_positions() once complete
  std::vector<uvec3> triangles;
  std::vector<vec3> normals;  ///< unit length
  std::vector<uvec3> normal_indices;
  std::vector<vec2> texcoords;
  std::vector<uvec3> texcoord_indices;

  const uvec3& normal_corners(std::uint32_t triangle) const {
    return normal_indices.empty() ? triangles[triangle] : normal_indices[triangle];
  }
  const uvec3& texcoord_corners(std::uint32_t triangle) const {
    return texcoord_indices.empty() ? triangles[triangle] : texcoord_indices[triangle];
  }

  /// Reserves the 16 readable bytes after the last position that Embree's vector loads need.
  void pad_positions() { positions.reserve(positions.size() + 2); }

  /// Bytes held by the arrays.
  std::size_t bytes() const;
};

struct Sphere {
  vec3 center;
  float radius;  ///< positive
};

/// One primitive of a Geometry.
struct PrimitiveId {
  std::uint32_t geometry;
  std::uint32_t primitive;

  auto operator<=>(const PrimitiveId&) const = default;
};

/// All primitives of a scene. Geometry ids count the meshes first; all the spheres together are one geometry
/// whose id follows the last mesh's.
struct Geometry {
  std::vector<TriangleMesh> meshes;
  std::vector<Sphere> spheres;

  std::uint32_t sphere_geometry() const { return static_cast<std::uint32_t>(meshes.size()); }
  bool is_sphere(std::uint32_t geometry) const { return geometry == sphere_geometry(); }
  std::size_t triangle_count() const;
  std::size_t primitive_count() const { return triangle_count() + spheres.size(); }

  /// Bounds of all valid primitives; empty when there are none.
  Bounds bounds() const;
  std::size_t bytes() const;
};

/// The closest hit of a ray: on the triangle (p0, p1, p2) the point (1-u-v) p0 + u p1 + v p2.
/// t is in units of the ray's direction. u and v are 0 on spheres.
struct Hit {
  float t;
  float u, v;
  std::uint32_t geometry;
  std::uint32_t primitive;

  bool operator==(const Hit&) const = default;
};

/// Corners of one triangle.
struct Triangle {
  vec3 p0, p1, p2;
};

inline Triangle triangle_corners(const TriangleMesh& mesh, std::uint32_t triangle) {
  const uvec3& i = mesh.triangles[triangle];
  return {mesh.positions[i.x], mesh.positions[i.y], mesh.positions[i.z]};
}

/// Coordinates beyond this are not accepted by any accelerator: squares of larger ones overflow, and Embree drops
/// those from 1.844e18 on.
inline constexpr float kLargestCoordinate = 1.8e18f;

/// Whether accelerators take the primitive in: indices in range, coordinates finite and not beyond
/// kLargestCoordinate, and for spheres a positive radius that is no denormal. Others behave as if absent.
bool is_valid_triangle(const TriangleMesh& mesh, std::uint32_t triangle);
bool is_valid_sphere(const Sphere& sphere);

/// Calls visit(PrimitiveId) for the valid primitives in order of their ids.
template <class Visit>
void for_each_valid_primitive(const Geometry& geometry, const Visit& visit) {
  for (std::uint32_t m = 0; m < geometry.meshes.size(); ++m) {
    const TriangleMesh& mesh = geometry.meshes[m];
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      if (is_valid_triangle(mesh, i)) visit(PrimitiveId{m, i});
    }
  }
  for (std::uint32_t i = 0; i < geometry.spheres.size(); ++i) {
    if (is_valid_sphere(geometry.spheres[i])) visit(PrimitiveId{geometry.sphere_geometry(), i});
  }
}

/// The valid primitives in order of their ids; primitive_count() less their number is how many are invalid.
std::vector<PrimitiveId> valid_primitives(const Geometry& geometry);

/// Bounds of the exact sphere: rounded outward.
Bounds sphere_bounds(const Sphere& sphere);
inline Bounds triangle_bounds(const Triangle& t) {
  Bounds b;
  b.extend(t.p0);
  b.extend(t.p1);
  b.extend(t.p2);
  return b;
}

/// Bounds of a valid primitive.
Bounds primitive_bounds(const Geometry& geometry, const PrimitiveId& id);

}  // namespace raylab
