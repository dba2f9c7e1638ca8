#pragma once
// Ray against one primitive. All tests accept the open interval t_min < t < t_max only.
#include <cmath>
#include <optional>
#include <utility>

#include "raylab/core/ray.hpp"
#include "raylab/geometry/geometry.hpp"

namespace raylab {

struct TriangleHit {
  float t, u, v;
};

/// The triangle tests a hand-written accelerator can use (`--intersector`).
enum class Intersector {
  book,        ///< Möller–Trumbore with the absolute |det| < 1e-8 rejected: the baseline, faults kept
  fast,        ///< Möller–Trumbore, only det = 0 rejected
  watertight,  ///< Woop, Benthin, Wald 2013: no ray passes between two triangles that share an edge
};

/// Möller and Trumbore 1997 (JGT 2:1). Determinants not above `smallest_determinant` in size count as a miss.
inline std::optional<TriangleHit> intersect_moeller_trumbore(const Ray& ray, const Triangle& tri, float t_min,
                                                             float t_max, float smallest_determinant) {
  const vec3 e1 = tri.p1 - tri.p0;
  const vec3 e2 = tri.p2 - tri.p0;
  const vec3 p = glm::cross(ray.direction, e2);
  const float det = glm::dot(e1, p);
  if (!(std::abs(det) > smallest_determinant)) return std::nullopt;
  const float inv_det = 1.0f / det;
  const vec3 s = ray.origin - tri.p0;
  const float u = glm::dot(s, p) * inv_det;
  if (!(u >= 0.0f && u <= 1.0f)) return std::nullopt;
  const vec3 q = glm::cross(s, e1);
  const float v = glm::dot(ray.direction, q) * inv_det;
  if (!(v >= 0.0f && u + v <= 1.0f)) return std::nullopt;
  const float t = glm::dot(e2, q) * inv_det;
  if (!(t > t_min && t < t_max)) return std::nullopt;
  return TriangleHit{t, u, v};
}

/// What the watertight test needs of a ray: the axis permutation and the shear that turn its direction into
/// +z. Made once a ray.
struct WatertightRay {
  explicit WatertightRay(const Ray& ray) : origin(ray.origin) {
    const vec3 a = glm::abs(ray.direction);
    kz = a.x > a.y ? (a.x > a.z ? 0 : 2) : (a.y > a.z ? 1 : 2);
    kx = kz == 2 ? 0 : kz + 1;
    ky = kx == 2 ? 0 : kx + 1;
    if (ray.direction[kz] < 0.0f) std::swap(kx, ky);  // keeps the winding
    shear_x = ray.direction[kx] / ray.direction[kz];
    shear_y = ray.direction[ky] / ray.direction[kz];
    shear_z = 1.0f / ray.direction[kz];
  }
  vec3 origin;
  int kx, ky, kz;
  float shear_x, shear_y, shear_z;
};

/// Woop, Benthin, Wald 2013, "Watertight Ray/Triangle Intersection" (JCGT 2:1).
/// The sheared vertices depend on the ray and the vertex alone, so two triangles evaluate a shared edge on the
/// same numbers; products of floats are exact in double, so the fallback decides a zero edge function by its
/// true sign. Both arguments fall if products and sums are contracted: this project compiles with
/// -ffp-contract=off.
inline std::optional<TriangleHit> intersect_watertight(const WatertightRay& ray, const Triangle& tri,
                                                       float t_min, float t_max) {
  const vec3 a = tri.p0 - ray.origin;
  const vec3 b = tri.p1 - ray.origin;
  const vec3 c = tri.p2 - ray.origin;
  const float ax = a[ray.kx] - ray.shear_x * a[ray.kz];
  const float ay = a[ray.ky] - ray.shear_y * a[ray.kz];
  const float bx = b[ray.kx] - ray.shear_x * b[ray.kz];
  const float by = b[ray.ky] - ray.shear_y * b[ray.kz];
  const float cx = c[ray.kx] - ray.shear_x * c[ray.kz];
  const float cy = c[ray.ky] - ray.shear_y * c[ray.kz];

  float u = cx * by - cy * bx;
  float v = ax * cy - ay * cx;
  float w = bx * ay - by * ax;
  if (u == 0.0f || v == 0.0f || w == 0.0f) {
    u = static_cast<float>(static_cast<double>(cx) * by - static_cast<double>(cy) * bx);
    v = static_cast<float>(static_cast<double>(ax) * cy - static_cast<double>(ay) * cx);
    w = static_cast<float>(static_cast<double>(bx) * ay - static_cast<double>(by) * ax);
  }
  if ((u < 0.0f || v < 0.0f || w < 0.0f) && (u > 0.0f || v > 0.0f || w > 0.0f)) return std::nullopt;

  const float det = u + v + w;
  if (det == 0.0f) return std::nullopt;
  const float az = ray.shear_z * a[ray.kz];
  const float bz = ray.shear_z * b[ray.kz];
  const float cz = ray.shear_z * c[ray.kz];
  const float inv_det = 1.0f / det;
  const float t = (u * az + v * bz + w * cz) * inv_det;
  if (!(t > t_min && t < t_max)) return std::nullopt;
  return TriangleHit{t, v * inv_det, w * inv_det};
}

/// The nearer and the farther distance at which the line of the ray meets the sphere, in units of its
/// direction, nearer first; nothing where it passes by. Stable where the quadratic formula cancels: a distant or
/// large sphere (Haines, Günther and Akenine-Möller 2019, Ray Tracing Gems, ch. 7).
inline std::optional<std::pair<float, float>> sphere_roots(const Ray& ray, const Sphere& sphere) {
  const vec3 oc = ray.origin - sphere.center;
  const float a = glm::dot(ray.direction, ray.direction);
  const float b = -glm::dot(oc, ray.direction);
  // Distance from the centre to the line, squared, from the vector itself and not from b² - a c.
  const vec3 to_line = oc + (b / a) * ray.direction;
  const float discriminant = sphere.radius * sphere.radius - glm::dot(to_line, to_line);
  if (!(discriminant >= 0.0f)) return std::nullopt;
  // |oc|² - r² as a product: the difference of the squares would cancel close to the surface.
  const float distance = std::sqrt(glm::dot(oc, oc));
  const float c = (distance - sphere.radius) * (distance + sphere.radius);
  const float q = b + std::copysign(std::sqrt(a * discriminant), b);
  if (q == 0.0f) return std::pair(0.0f, 0.0f);
  const float t0 = c / q;
  const float t1 = q / a;
  return t0 < t1 ? std::pair(t0, t1) : std::pair(t1, t0);
}

/// The book's sphere test, kept for comparison: the quadratic formula in floats, which cancels where the sphere
/// is far away or the origin close to a large one (Shirley et al., Ray Tracing in One Weekend).
inline std::optional<float> intersect_sphere_book(const Ray& ray, const Sphere& sphere, float t_min, float t_max) {
  const vec3 to_center = sphere.center - ray.origin;
  const float a = glm::dot(ray.direction, ray.direction);
  const float h = glm::dot(ray.direction, to_center);
  const float c = glm::dot(to_center, to_center) - sphere.radius * sphere.radius;
  const float discriminant = h * h - a * c;
  if (!(discriminant >= 0.0f)) return std::nullopt;
  const float root = std::sqrt(discriminant);
  const float t0 = (h - root) / a;
  if (t0 > t_min && t0 < t_max) return t0;
  const float t1 = (h + root) / a;
  if (t1 > t_min && t1 < t_max) return t1;
  return std::nullopt;
}

/// Closest distance to the sphere inside the interval, from outside or inside.
inline std::optional<float> intersect_sphere(const Ray& ray, const Sphere& sphere, float t_min, float t_max) {
  const auto roots = sphere_roots(ray, sphere);
  if (!roots) return std::nullopt;
  if (roots->first > t_min && roots->first < t_max) return roots->first;
  if (roots->second > t_min && roots->second < t_max) return roots->second;
  return std::nullopt;
}

}  // namespace raylab
