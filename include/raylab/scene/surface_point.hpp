#pragma once
#include <cmath>

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

/// Point (1-u-v) p0 + u p1 + v p2 of a triangle, its geometric normal and its offset.
///
/// The offset covers, along ng,
///  - the rounding of the position itself and of adding the offset: gamma(8) of the corners' coordinates
///    (pbrt-v4 §6.8.4 has gamma(7) for the barycentric sum);
///  - the error with which the next ray's query finds this very triangle: a test that takes the distance to the
///    plane as dot(p0 - o, e1 x e2) errs by a few roundings of |extent| |e1| |e2|, which for a needle is far more
///    than its |e1 x e2|;
///  - 2^-40 of the extent, so that a query that decides in double still sees the point off the plane.
/// For a plane parallel to an axis through 0 the first two vanish, as do the errors they bound.
inline void place_on_triangle(const Triangle& t, float u, float v, SurfacePoint& point) {
  const vec3 e1 = t.p1 - t.p0;
  const vec3 e2 = t.p2 - t.p0;
  point.position = (1.0f - u - v) * t.p0 + u * t.p1 + v * t.p2;
  const vec3 a = vec3(e1.y * e2.z, e1.z * e2.x, e1.x * e2.y);
  const vec3 b = vec3(e1.z * e2.y, e1.x * e2.z, e1.y * e2.x);
  const vec3 n = a - b;
  const float length2 = glm::dot(n, n);
  float inv_length = 1.0f / std::sqrt(length2);
  // The square of a small needle's product, or of a huge triangle's, leaves the range of float.
  if (!(length2 > 0x1p-100f && length2 < 0x1p120f)) [[unlikely]] {
    inv_length = static_cast<float>(1.0 / glm::length(dvec3(n)));
  }
  point.ng = n * inv_length;
  const vec3 extent = glm::abs(e1) + glm::abs(e2);
  const vec3 coordinates = glm::abs(t.p0) + glm::abs(t.p1) + glm::abs(t.p2);
  point.offset = gamma_bound(8) * (glm::dot(glm::abs(point.ng), coordinates) +
                                   glm::dot(extent, (glm::abs(a) + glm::abs(b)) * inv_length)) +
                 0x1p-40f * (extent.x + extent.y + extent.z);
}

/// The point of the sphere closest to p, the outward normal there and the offset. A query's distance to the sphere
/// errs by roundings of the radius and of the centre's coordinates.
inline void place_on_sphere(const Sphere& sphere, const vec3& p, SurfacePoint& point) {
  point.ng = glm::normalize(p - sphere.center);
  point.position = sphere.center + sphere.radius * point.ng;
  const vec3 c = glm::abs(sphere.center);
  point.offset = gamma_bound(16) * (c.x + c.y + c.z + sphere.radius);
}

/// Texture coordinates of unit direction n on a sphere: u from -x over +z around +y, v from the south pole (Ray
/// Tracing: The Next Week §4.4).
inline vec2 sphere_texcoords(const vec3& n) {
  const float theta = std::acos(glm::clamp(-n.y, -1.0f, 1.0f));
  const float phi = std::atan2(-n.z, n.x) + kPi;
  return {phi * (0.5f * kInvPi), theta * kInvPi};
}

/// Expands a hit of `ray`. `normals` and `texcoords` say which attributes to look at; absent ones cost nothing.
template <bool kSpheres, bool kTexcoords>
SurfacePoint surface_point(const Geometry& geometry, const Ray& ray, const Hit& hit) {
  SurfacePoint point;
  point.uv = vec2(0.0f);
  if (kSpheres && geometry.is_sphere(hit.geometry)) {
    place_on_sphere(geometry.spheres[hit.primitive], ray.at(hit.t), point);
    point.ns = point.ng;
    if (kTexcoords) point.uv = sphere_texcoords(point.ng);
    return point;
  }
  const TriangleMesh& mesh = geometry.meshes[hit.geometry];
  place_on_triangle(triangle_corners(mesh, hit.primitive), hit.u, hit.v, point);
  point.ns = point.ng;
  const float w = 1.0f - hit.u - hit.v;
  if (!mesh.normals.empty()) {
    const uvec3& i = mesh.normal_corners(hit.primitive);
    const vec3 n = w * mesh.normals[i.x] + hit.u * mesh.normals[i.y] + hit.v * mesh.normals[i.z];
    const float length2 = glm::dot(n, n);
    if (length2 > 0.0f) {
      const float scale = (glm::dot(n, point.ng) < 0.0f ? -1.0f : 1.0f) / std::sqrt(length2);
      point.ns = scale * n;
    }
  }
  if (kTexcoords && !mesh.texcoords.empty()) {
    const uvec3& i = mesh.texcoord_corners(hit.primitive);
    point.uv = w * mesh.texcoords[i.x] + hit.u * mesh.texcoords[i.y] + hit.v * mesh.texcoords[i.z];
  }
  return point;
}

/// Start of a ray that leaves the point towards `direction`, on that direction's side of the surface.
inline vec3 offset_origin(const SurfacePoint& point, const vec3& direction) {
  return point.position + std::copysign(point.offset, glm::dot(direction, point.ng)) * point.ng;
}

}  // namespace raylab
