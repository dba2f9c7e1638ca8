#pragma once
#include "raylab/core/ray.hpp"
#include "raylab/geometry/geometry.hpp"
#include "raylab/scene/scene.hpp"

namespace raylab {

/// A Hit expanded to what shading reads.
struct SurfacePoint {
  vec3 position;
  float offset;  ///< a point this far along ±ng is on that side of the surface for every accelerator's arithmetic
  vec3 ng;       ///< unit geometric normal, by the winding of the triangle; outward on spheres
  vec3 ns;       ///< unit shading normal, on the same side as ng; ng itself where the mesh has none
  vec2 uv;       ///< texture coordinates; (0,0) where absent
};

/// Expands a hit of `ray`.
SurfacePoint surface_point(const Geometry& geometry, const Ray& ray, const Hit& hit);

/// Point (1-u-v) p0 + u p1 + v p2 of a triangle, with its geometric normal and offset.
SurfacePoint point_on_triangle(const Triangle& triangle, float u, float v);

/// The point of the sphere in unit direction n from its centre, with n for its normal, and the offset.
SurfacePoint point_on_sphere(const Sphere& sphere, const vec3& n);

/// Start of a ray that leaves the point towards `direction`, on that direction's side of the surface.
vec3 offset_origin(const SurfacePoint& point, const vec3& direction);

/// A mesh's normals, if it has some, weighted by (1-u-v, u, v): not of unit length.
inline vec3 interpolated_normal(const TriangleMesh& mesh, std::uint32_t triangle, float u, float v) {
  const uvec3& i = mesh.normal_corners(triangle);
  return (1.0f - u - v) * mesh.normals[i.x] + u * mesh.normals[i.y] + v * mesh.normals[i.z];
}
/// Texture coordinates of a point of a triangle; (0,0) where the mesh has none.
inline vec2 interpolated_texcoords(const TriangleMesh& mesh, std::uint32_t triangle, float u, float v) {
  if (mesh.texcoords.empty()) return vec2(0.0f);
  const uvec3& i = mesh.texcoord_corners(triangle);
  return (1.0f - u - v) * mesh.texcoords[i.x] + u * mesh.texcoords[i.y] + v * mesh.texcoords[i.z];
}

/// Texture coordinates of unit direction n on a sphere: u from -x over +z around +y, v from the south pole (Ray
/// Tracing: The Next Week §4.4).
vec2 sphere_texcoords(const vec3& n);

}  // namespace raylab
