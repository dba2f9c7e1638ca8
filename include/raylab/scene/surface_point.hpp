#pragma once
#include <cmath>

#include "raylab/core/lanes.hpp"
#include "raylab/core/numeric.hpp"
#include "raylab/geometry/geometry.hpp"
#include "raylab/scene/scene.hpp"

namespace raylab {

/// A Hit expanded to what shading reads; of lanes of type F (core/lanes.hpp).
template <class F>
struct BasicSurfacePoint {
  Vec3Of<F> position;
  F offset;      ///< a point this far along ±ng is on that side of the surface for every accelerator's arithmetic
  Vec3Of<F> ng;  ///< unit geometric normal, by the winding of the triangle; outward on spheres
  Vec3Of<F> ns;  ///< unit shading normal, on the same side as ng; ng itself where the mesh has none
  Vec2Of<F> uv;  ///< texture coordinates; (0,0) where absent
};
using SurfacePoint = BasicSurfacePoint<float>;

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
template <class F>
void place_on_triangle(const Vec3Of<F>& p0, const Vec3Of<F>& p1, const Vec3Of<F>& p2, const F& u, const F& v,
                       BasicSurfacePoint<F>& point) {
  using Vec3 = Vec3Of<F>;
  using glm::abs;
  const Vec3 e1 = p1 - p0;
  const Vec3 e2 = p2 - p0;
  point.position = p0 * (F(1.0f) - u - v) + p1 * u + p2 * v;
  const Vec3 a(e1.y * e2.z, e1.z * e2.x, e1.x * e2.y);
  const Vec3 b(e1.z * e2.y, e1.x * e2.z, e1.y * e2.x);
  const Vec3 n = a - b;
  const F length2 = dot(n, n);
  F inv_length = F(1.0f) / square_root(length2);
  // The square of a small needle's product, or of a huge triangle's, leaves the range of float.
  const MaskOf<F> out_of_range = !((length2 > F(0x1p-100f)) & (length2 < F(0x1p120f)));
  if (any(out_of_range)) [[unlikely]] {
    const F largest = greater(magnitude(n.x), greater(magnitude(n.y), magnitude(n.z)));
    const Vec3 scaled = n / largest;
    inv_length = select(out_of_range, F(1.0f) / (largest * square_root(dot(scaled, scaled))), inv_length);
  }
  point.ng = n * inv_length;
  const Vec3 extent = abs(e1) + abs(e2);
  const Vec3 coordinates = abs(p0) + abs(p1) + abs(p2);
  const Vec3 error = abs(point.ng) * coordinates + extent * ((abs(a) + abs(b)) * inv_length);
  const Vec3 bound = error * F(gamma_bound(8)) + extent * F(0x1p-40f);
  point.offset = bound.x + bound.y + bound.z;
}
inline void place_on_triangle(const Triangle& t, float u, float v, SurfacePoint& point) {
  place_on_triangle<float>(t.p0, t.p1, t.p2, u, v, point);
}

/// The point of the sphere closest to p, the outward normal there and the offset. A query's distance to the sphere
/// errs by roundings of the radius and of the centre's coordinates.
template <class F>
void place_on_sphere(const Vec3Of<F>& center, const F& radius, const Vec3Of<F>& p, BasicSurfacePoint<F>& point) {
  const Vec3Of<F> from_center = p - center;
  point.ng = from_center * (F(1.0f) / square_root(dot(from_center, from_center)));
  point.position = center + radius * point.ng;
  point.offset =
      F(gamma_bound(16)) * (magnitude(center.x) + magnitude(center.y) + magnitude(center.z) + radius);
}
inline void place_on_sphere(const Sphere& sphere, const vec3& p, SurfacePoint& point) {
  place_on_sphere<float>(sphere.center, sphere.radius, p, point);
}

/// The shading normal from the sum of a mesh's normals weighted by (1-u-v, u, v): unit and on the side of ng, and ng
/// itself where the sum vanishes.
template <class F>
Vec3Of<F> shading_normal(const Vec3Of<F>& sum, const Vec3Of<F>& ng) {
  const F length2 = dot(sum, sum);
  const F scale = with_sign_of(F(1.0f), dot(sum, ng)) / square_root(length2);
  return select(length2 > F(0.0f), scale * sum, ng);
}
/// The sum that shading_normal() takes, of a mesh that has normals.
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
  if (kShadingNormals && !mesh.normals.empty()) {
    point.ns = shading_normal<float>(interpolated_normal(mesh, hit.primitive, hit.u, hit.v), point.ng);
  }
  if (kTexcoords) point.uv = interpolated_texcoords(mesh, hit.primitive, hit.u, hit.v);
  return point;
}

/// Start of a ray that leaves the point towards `direction`, on that direction's side of the surface.
template <class F>
Vec3Of<F> offset_origin(const BasicSurfacePoint<F>& point, const Vec3Of<F>& direction) {
  return point.position + with_sign_of(point.offset, dot(direction, point.ng)) * point.ng;
}

}  // namespace raylab
