#pragma once
// Spheres as a geometry of Embree's, tested by callback with our own roots: Embree's are not stable, and miss the
// ground sphere of radius 1e6 by 13% of the distance. Local to the including file.
#include "api.hpp"
#include "geometry/primitive_test.hpp"

namespace raylab {

namespace {

bool hit_sphere(void* user, unsigned primitive, const RTCRay& ray, float& t) {
  const Ray own{{ray.org_x, ray.org_y, ray.org_z}, {ray.dir_x, ray.dir_y, ray.dir_z}};
  const Sphere& sphere = static_cast<const Geometry*>(user)->spheres[primitive];
  // Embree's interval is closed, ours is open.
  const auto hit =
      PrimitiveTest<Intersector::fast>(own).sphere(sphere, next_float_down(ray.tnear), next_float_up(ray.tfar));
  if (hit) t = *hit;
  return hit.has_value();
}

/// Whether Embree, which drops a box that is empty or reaches beyond its range, takes the sphere in.
bool is_embree_sphere(const Sphere& sphere) {
  if (!is_valid_sphere(sphere)) return false;
  const Bounds b = sphere_bounds(sphere);
  return max_component(glm::max(glm::abs(b.lower), glm::abs(b.upper))) < 1.844e18f;
}

void sphere_bounds_callback(const RTCBoundsFunctionArguments* args) {
  const Sphere& sphere = static_cast<const Geometry*>(args->geometryUserPtr)->spheres[args->primID];
  const Bounds b = is_valid_sphere(sphere) ? sphere_bounds(sphere) : Bounds();  // Embree drops empty ones
  *args->bounds_o = {b.lower.x, b.lower.y, b.lower.z, 0.0f, b.upper.x, b.upper.y, b.upper.z, 0.0f};
}

void sphere_intersect_callback(const RTCIntersectFunctionNArguments* args) {
  RTCRayN* const rays = RTCRayHitN_RayN(args->rayhit, args->N);
  RTCHitN* const hits = RTCRayHitN_HitN(args->rayhit, args->N);
  for (unsigned i = 0; i < args->N; ++i) {
    if (args->valid[i] == 0) continue;
    float& t = RTCRayN_tfar(rays, args->N, i);
    const bool hit = hit_sphere(args->geometryUserPtr, args->primID, rtcGetRayFromRayN(rays, args->N, i), t);
    if (hit) {
      RTCHitN_u(hits, args->N, i) = 0.0f;
      RTCHitN_v(hits, args->N, i) = 0.0f;
      RTCHitN_geomID(hits, args->N, i) = args->geomID;
      RTCHitN_primID(hits, args->N, i) = args->primID;
    }
    args->valid[i] = hit ? -1 : 0;
  }
}

void sphere_occluded_callback(const RTCOccludedFunctionNArguments* args) {
  for (unsigned i = 0; i < args->N; ++i) {
    if (args->valid[i] == 0) continue;
    float t;
    const bool hit = hit_sphere(args->geometryUserPtr, args->primID, rtcGetRayFromRayN(args->ray, args->N, i), t);
    if (hit) RTCRayN_tfar(args->ray, args->N, i) = -kInfinity;
    args->valid[i] = hit ? -1 : 0;
  }
}

}  // namespace
}  // namespace raylab
