#include "raylab/scene/surface_point.hpp"

#include <cmath>

#include "core/warp.hpp"
#include "raylab/core/numeric.hpp"
#include "surface_lanes.hpp"

namespace raylab {

namespace {

SurfacePoint as_surface_point(const PointLanes<float>& p) { return {p.position, p.offset, p.ng, p.ng, vec2(0.0f)}; }

}  // namespace

SurfacePoint point_on_triangle(const Triangle& t, float u, float v) {
  PointLanes<float> p;
  place_on_triangle<float>(true, t.p0, t.p1, t.p2, u, v, p);
  return as_surface_point(p);
}

SurfacePoint point_on_sphere(const Sphere& sphere, const vec3& n) {
  const Vec3<double> direction(n);  // of unit length only as far as floats can be
  const double scale = static_cast<double>(sphere.radius) / std::sqrt(dot(direction, direction));
  PointLanes<float> p;
  place_on_sphere<float>(Vec3<double>(sphere.center), sphere.radius, scale * direction, p);
  return as_surface_point(p);
}

SurfacePoint surface_point(const Geometry& geometry, const Ray& ray, const Hit& hit) {
  if (geometry.is_sphere(hit.geometry)) {
    const Sphere& sphere = geometry.spheres[hit.primitive];
    PointLanes<float> p;
    place_on_sphere<float>(sphere.center, sphere.radius, ray.origin, ray.direction, hit.t, p);
    SurfacePoint point = as_surface_point(p);
    point.uv = sphere_texcoords(point.ng);
    return point;
  }
  const TriangleMesh& mesh = geometry.meshes[hit.geometry];
  const Triangle corners = triangle_corners(mesh, hit.primitive);
  PointLanes<float> p;
  place_on_triangle<float>(true, corners.p0, corners.p1, corners.p2, hit.u, hit.v, p);
  place_on_ray<float>(true, corners.p0, corners.p1, corners.p2, ray.origin, ray.direction, hit.t, p);
  SurfacePoint point = as_surface_point(p);
  if (!mesh.normals.empty()) {
    point.ns = shading_normal<float>(interpolated_normal(mesh, hit.primitive, hit.u, hit.v), point.ng);
  }
  point.uv = interpolated_texcoords(mesh, hit.primitive, hit.u, hit.v);
  return point;
}

vec3 offset_origin(const SurfacePoint& point, const vec3& direction) {
  return offset_origin<float>({point.position, point.offset, point.ng}, direction);
}

vec2 sphere_texcoords(const vec3& n) {
  // The arc cosine of -n.y, but accurate near the poles too.
  const float theta = arc_tangent<float>(std::sqrt(n.x * n.x + n.z * n.z), -n.y);
  const float phi = arc_tangent<float>(-n.z, n.x) + kPi;
  return {phi * (0.5f * kInvPi), theta * kInvPi};
}

}  // namespace raylab
