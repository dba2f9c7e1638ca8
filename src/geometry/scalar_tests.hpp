#pragma once
// One ray against one primitive, from the formulas of triangle_test.hpp and sphere_test.hpp: what the scalar
// accelerators, and the vector ones in rare cases, call.
#include "raylab/geometry/intersect.hpp"
#include "sphere_test.hpp"
#include "triangle_test.hpp"

namespace raylab {
namespace {

/// The determinant below which the book's triangle test gives up, whatever the scale; the fast test only at 0.
constexpr float smallest_determinant(Intersector kind) { return kind == Intersector::book ? 1e-8f : 0.0f; }

/// A ray made ready for many watertight tests.
struct PreparedRay {
  Vec3<float> origin, direction;
  ShearedRay<float> sheared;

  PreparedRay(const Vec3<float>& o, const Vec3<float>& d) : origin(o), direction(d), sheared(d) {}
};

struct ScalarHit {
  float t, u, v;
};

/// The watertight test where floats do not decide it: on an edge, or with areas too small or too large for a float.
/// Products of floats are exact in double, so every edge function has its true sign. The interval is the caller's.
[[gnu::noinline, gnu::cold]] inline bool watertight_in_double(const PreparedRay& ray, const Vec3<float>& p0,
                                                              const Vec3<float>& p1, const Vec3<float>& p2,
                                                              ScalarHit& hit) {
  const Vec3<float> a = to_ray_space(ray.sheared, p0 - ray.origin);
  const Vec3<float> b = to_ray_space(ray.sheared, p1 - ray.origin);
  const Vec3<float> c = to_ray_space(ray.sheared, p2 - ray.origin);
  const EdgeFunctions<double> e = edge_functions<double>(a.x, a.y, b.x, b.y, c.x, c.y);
  if (differ_in_sign(e) || e.u + e.v + e.w == 0.0) return false;
  const float xy_size = max(max(abs(a.x), abs(a.y)), max(max(abs(b.x), abs(b.y)), max(abs(c.x), abs(c.y))));
  const WatertightHit<double> h = watertight_hit<double>(e, a.z, b.z, c.z, xy_size, ray.sheared.direction_z);
  hit = {to_float(h.t), to_float(h.beta), to_float(h.gamma)};
  if (!h.precise) hit.t = plane_distance<float>(ray.sheared.axes, ray.origin, ray.direction, p0, p1, p2, hit.t);
  return true;
}

inline std::optional<TriangleHit> watertight(const PreparedRay& ray, const Vec3<float>& p0, const Vec3<float>& p1,
                                             const Vec3<float>& p2, float t_min, float t_max) {
  const Vec3<float> a = to_ray_space(ray.sheared, p0 - ray.origin);
  const Vec3<float> b = to_ray_space(ray.sheared, p1 - ray.origin);
  const Vec3<float> c = to_ray_space(ray.sheared, p2 - ray.origin);
  const EdgeFunctions<float> e = edge_functions<float>(a.x, a.y, b.x, b.y, c.x, c.y);
  if (differ_in_sign(e)) return std::nullopt;
  const float xy_size = max(max(abs(a.x), abs(a.y)), max(max(abs(b.x), abs(b.y)), max(abs(c.x), abs(c.y))));
  const WatertightHit<float> h = watertight_hit<float>(e, a.z, b.z, c.z, xy_size, ray.sheared.direction_z);
  ScalarHit hit{h.t, h.beta, h.gamma};
  if (!h.sure) [[unlikely]] {
    if (!watertight_in_double(ray, p0, p1, p2, hit)) return std::nullopt;
  } else if (!h.precise) {
    hit.t = plane_distance<float>(ray.sheared.axes, ray.origin, ray.direction, p0, p1, p2, h.t);
  }
  if (!(hit.t > t_min && hit.t < t_max)) return std::nullopt;
  return TriangleHit{hit.t, hit.u, hit.v};
}

/// The nearer and the farther distance at which the line of a ray meets a sphere, in units of its direction; false
/// where it passes by. Where they are equal but for rounding either may be the smaller.
inline bool sphere_distances(const Vec3<float>& origin, const Vec3<float>& direction, const Vec3<float>& center,
                             float radius, float& nearer, float& farther) {
  const SphereQuadratic<double> s(Vec3<double>(origin) - Vec3<double>(center), Vec3<double>(direction), radius);
  if (!(s.discriminant >= 0.0)) return false;
  const double q = s.q();
  nearer = farther = 0.0f;
  if (q == 0.0) return true;
  const float t0 = to_float(s.c / q), t1 = to_float(q / s.a);
  nearer = q > 0.0 ? t0 : t1;
  farther = q > 0.0 ? t1 : t0;
  return true;
}

/// The book's sphere test, kept for comparison: the quadratic formula in floats, which cancels where the sphere is far
/// away or the origin close to a large one (Shirley et al., Ray Tracing in One Weekend).
inline bool sphere_distances_book(const Vec3<float>& origin, const Vec3<float>& direction, const Vec3<float>& center,
                                  float radius, float& nearer, float& farther) {
  const Vec3<float> to_center = center - origin;
  const float a = dot(direction, direction);
  const float h = dot(direction, to_center);
  const float c = dot(to_center, to_center) - radius * radius;
  const float discriminant = h * h - a * c;
  if (!(discriminant >= 0.0f)) return false;
  const float root = sqrt(discriminant);
  nearer = (h - root) / a;
  farther = (h + root) / a;
  return true;
}

/// Closest distance to a sphere with t_min < t <= limit, from outside or inside; false if there is none.
template <Intersector kind>
bool sphere_hit(const Vec3<float>& origin, const Vec3<float>& direction, const Vec3<float>& center, float radius,
                float t_min, float limit, float& t) {
  float nearer = 0.0f, farther = 0.0f;
  const bool met = kind == Intersector::book ? sphere_distances_book(origin, direction, center, radius, nearer, farther)
                                             : sphere_distances(origin, direction, center, radius, nearer, farther);
  t = nearer > t_min ? nearer : farther;
  return met && t > t_min && t <= limit;
}

}  // namespace
}  // namespace raylab
