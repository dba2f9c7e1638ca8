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

namespace detail {

/// The compiler's vector of four floats: SSE on x86-64.
using Float4 = float __attribute__((vector_size(16)));
using Int4 = int __attribute__((vector_size(16)));

inline Float4 float4(const vec3& v) { return Float4{v.x, v.y, v.z, 0.0f}; }
inline void store(const Float4& v, vec3& out) { out = vec3(v[0], v[1], v[2]); }
inline Float4 yzx(const Float4& v) { return __builtin_shufflevector(v, v, 1, 2, 0, 3); }
inline Float4 zxy(const Float4& v) { return __builtin_shufflevector(v, v, 2, 0, 1, 3); }
inline Float4 abs4(const Float4& v) { return Float4(Int4(v) & 0x7fffffff); }
inline float sum3(const Float4& v) { return v[0] + v[1] + v[2]; }

}  // namespace detail

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
///
/// Four floats wide, the last idle: this runs at every vertex of every path.
inline void place_on_triangle(const Triangle& t, float u, float v, SurfacePoint& point) {
  using namespace detail;
  const Float4 p0 = float4(t.p0), p1 = float4(t.p1), p2 = float4(t.p2);
  const Float4 e1 = p1 - p0;
  const Float4 e2 = p2 - p0;
  store(p0 * (1.0f - u - v) + p1 * u + p2 * v, point.position);
  const Float4 a = yzx(e1) * zxy(e2);
  const Float4 b = zxy(e1) * yzx(e2);
  const Float4 n = a - b;
  const float length2 = sum3(n * n);
  float inv_length = 1.0f / std::sqrt(length2);
  // The square of a small needle's product, or of a huge triangle's, leaves the range of float.
  if (!(length2 > 0x1p-100f && length2 < 0x1p120f)) [[unlikely]] {
    inv_length = static_cast<float>(
        1.0 / glm::length(dvec3(static_cast<double>(n[0]), static_cast<double>(n[1]), static_cast<double>(n[2]))));
  }
  const Float4 ng = n * inv_length;
  store(ng, point.ng);
  const Float4 extent = abs4(e1) + abs4(e2);
  const Float4 coordinates = abs4(p0) + abs4(p1) + abs4(p2);
  const Float4 error = abs4(ng) * coordinates + extent * ((abs4(a) + abs4(b)) * inv_length);
  point.offset = sum3(error * gamma_bound(8) + extent * 0x1p-40f);
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

/// Expands a hit of `ray`. The parameters say what the scene has (SceneNeeds): what it has not costs nothing.
template <bool kSpheres, bool kTexcoords, bool kShadingNormals>
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
  if (kShadingNormals && !mesh.normals.empty()) {
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
