#pragma once
// Ray against one primitive. All tests accept the open interval t_min < t < t_max only.
#include <algorithm>
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
  explicit WatertightRay(const Ray& ray) : origin(ray.origin), direction(ray.direction) {
    const vec3 a = glm::abs(ray.direction);
    kz = a.x > a.y ? (a.x > a.z ? 0 : 2) : (a.y > a.z ? 1 : 2);
    kx = kz == 2 ? 0 : kz + 1;
    ky = kx == 2 ? 0 : kx + 1;
    direction_z = ray.direction[kz];
    if (direction_z < 0.0f) std::swap(kx, ky);  // keeps the winding
    shear_x = ray.direction[kx] / direction_z;
    shear_y = ray.direction[ky] / direction_z;
  }

  /// A vertex in the ray's space: the ray goes along the z axis, z in the units of the scene.
  vec3 to_local(const vec3& vertex) const {
    const vec3 v = vertex - origin;
    const float* component = &v.x;  // GLM's subscript is a switch
    const float z = component[kz];
    return {component[kx] - shear_x * z, component[ky] - shear_y * z, z};
  }

  vec3 origin;
  vec3 direction;
  int kx, ky, kz;
  float shear_x, shear_y;  ///< at most 1 in size
  float direction_z;
};

namespace detail {

/// The edge functions err by roundings of max|z| max|x, y|, so t errs by roundings of
///   slope = max|z| max|x, y| (extent of the triangle along z) / (|z| det),
/// which for a triangle far away is how steeply it stands against the ray. Up to kTrustedSlope t is taken as it
/// is, a few roundings off: beyond, one hit in ten, it is computed again in double. Of a t below 0 only the sign
/// matters, which is right up to kTrustedSignSlope: so a ray that leaves a triangle, as every scattered one does,
/// needs no double for it.
inline constexpr float kTrustedSlope = 3.0f;
inline constexpr float kTrustedSignSlope = 0x1p19f;

/// Along the normal, in double; of any length.
inline dvec3 triangle_normal(const Triangle& tri) {
  const dvec3 p0(tri.p0);
  return glm::cross(dvec3(tri.p1) - p0, dvec3(tri.p2) - p0);
}

/// Below this share of the sizes of its terms the sine between ray and plane is so small that the line, which the
/// edge functions know up to roundings of floats, may meet the plane outside the triangle.
inline constexpr double kDoubtfulFacing = 0x1p-12;

/// Distance to the plane of the triangle, in double from the vertices as they are; where the ray runs nearly along
/// the plane, kept within the distances of the vertices, and `otherwise` where it runs along it.
[[gnu::noinline]] inline float watertight_plane_distance(const vec3& origin, const vec3& direction,
                                                         const Triangle& tri, float otherwise) {
  const dvec3 n = triangle_normal(tri);
  const dvec3 facings = dvec3(direction) * n;
  const dvec3 distances = (dvec3(tri.p0) - dvec3(origin)) * n;
  const double facing = facings.x + facings.y + facings.z;
  double t = (distances.x + distances.y + distances.z) / facing;
  const dvec3 size = glm::abs(facings);
  if (!(std::abs(facing) > kDoubtfulFacing * (size.x + size.y + size.z))) [[unlikely]] {
    if (facing == 0.0) return otherwise;
    const int k = WatertightRay({origin, direction}).kz;
    const auto at_corner = [&](const vec3& p) {
      return (static_cast<double>(p[k]) - static_cast<double>(origin[k])) / static_cast<double>(direction[k]);
    };
    const double t0 = at_corner(tri.p0), t1 = at_corner(tri.p1), t2 = at_corner(tri.p2);
    t = std::clamp(t, std::min({t0, t1, t2}), std::max({t0, t1, t2}));
  }
  return static_cast<float>(t);
}

/// The hit whose edge functions (twice the signed areas opposite a, b, c) are u, v, w of one sign, det their
/// sum. Interpolates from a: the error of z is then small where the triangle is.
template <class Real>
std::optional<TriangleHit> watertight_hit(const WatertightRay& ray, const Triangle& tri, const vec3& a,
                                          const vec3& b, const vec3& c, Real v, Real w, Real det, float t_min,
                                          float t_max) {
  const Real inv_det = Real(1) / det;
  const Real beta = v * inv_det;
  const Real gamma = w * inv_det;
  const Real ab = Real(b.z) - Real(a.z);
  const Real ac = Real(c.z) - Real(a.z);
  const Real z = Real(a.z) + beta * ab + gamma * ac;
  auto t = static_cast<float>(z / Real(ray.direction_z));
  const float z_size = std::max({std::abs(a.z), std::abs(b.z), std::abs(c.z)});
  const float xy_size =
      std::max({std::abs(a.x), std::abs(a.y), std::abs(b.x), std::abs(b.y), std::abs(c.x), std::abs(c.y)});
  const Real error = Real(z_size) * (std::max(std::abs(ab), std::abs(ac)) * Real(xy_size));
  const Real depth = std::abs(z) * std::abs(det);
  if (!(error < Real(t < 0.0f ? kTrustedSignSlope : kTrustedSlope) * depth))
    t = watertight_plane_distance(ray.origin, ray.direction, tri, t);
  if (!(t > t_min && t < t_max)) return std::nullopt;
  return TriangleHit{t, static_cast<float>(beta), static_cast<float>(gamma)};
}

/// The test where floats do not decide it: on an edge, or with areas too small or too large for a float.
/// Products of floats are exact in double, so every edge function has its true sign.
[[gnu::noinline, gnu::cold]] inline std::optional<TriangleHit> watertight_in_double(const WatertightRay& ray,
                                                                                    const Triangle& tri,
                                                                                    const vec3& a, const vec3& b,
                                                                                    const vec3& c, float t_min,
                                                                                    float t_max) {
  const double u = static_cast<double>(c.x) * b.y - static_cast<double>(c.y) * b.x;
  const double v = static_cast<double>(a.x) * c.y - static_cast<double>(a.y) * c.x;
  const double w = static_cast<double>(b.x) * a.y - static_cast<double>(b.y) * a.x;
  if ((u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0)) return std::nullopt;
  const double det = u + v + w;
  if (det == 0.0) return std::nullopt;
  return watertight_hit(ray, tri, a, b, c, v, w, det, t_min, t_max);
}

}  // namespace detail

/// Woop, Benthin, Wald 2013, "Watertight Ray/Triangle Intersection" (JCGT 2:1).
/// The sheared vertices depend on the ray and the vertex alone, so two triangles evaluate a shared edge on the
/// same numbers, and get exactly opposite values. Rounding, overflow and the flushing of denormals never turn a
/// sign around, they can only lose it; then double decides. All of this falls if products and sums are
/// contracted: this project compiles with -ffp-contract=off.
inline std::optional<TriangleHit> intersect_watertight(const WatertightRay& ray, const Triangle& tri, float t_min,
                                                       float t_max) {
  const vec3 a = ray.to_local(tri.p0);
  const vec3 b = ray.to_local(tri.p1);
  const vec3 c = ray.to_local(tri.p2);
  const float u = c.x * b.y - c.y * b.x;
  const float v = a.x * c.y - a.y * c.x;
  const float w = b.x * a.y - b.y * a.x;
  const float smallest = std::min(std::min(u, v), w);
  const float largest = std::max(std::max(u, v), w);
  if (smallest < 0.0f && largest > 0.0f) return std::nullopt;
  const float det = u + v + w;
  // Outside these bounds (NaN included) the flushed parts of the products, or 1 / det, would count.
  const float size = std::abs(det);
  if (smallest == 0.0f || largest == 0.0f || !(size > 0x1p-100f && size < 0x1p120f)) [[unlikely]] {
    return detail::watertight_in_double(ray, tri, a, b, c, t_min, t_max);
  }
  return detail::watertight_hit(ray, tri, a, b, c, v, w, det, t_min, t_max);
}

/// The nearer and the farther distance at which the line of the ray meets the sphere, in units of its direction;
/// nothing where it passes by. Where they are equal but for rounding either may be the smaller. Stable where the
/// quadratic formula cancels: a distant or large sphere (Haines, Günther and Akenine-Möller 2019, Ray Tracing Gems,
/// ch. 7). In double, since squares of tiny radii, of long and of short directions leave the range of float; it costs
/// little.
inline std::optional<std::pair<float, float>> sphere_roots(const Ray& ray, const Sphere& sphere) {
  const dvec3 direction(ray.direction);
  const dvec3 oc = dvec3(ray.origin) - dvec3(sphere.center);
  const double radius = sphere.radius;
  const double a = glm::dot(direction, direction);
  const double b = -glm::dot(oc, direction);
  // The distance of the centre from the line, squared and times a, from the vectors and not from b² - a c.
  const dvec3 moment = glm::cross(oc, direction);
  const double discriminant = radius * radius * a - glm::dot(moment, moment);
  if (!(discriminant >= 0.0)) return std::nullopt;
  const double q = b + std::copysign(std::sqrt(discriminant), b);
  if (q == 0.0) return std::pair(0.0f, 0.0f);
  const auto t0 = static_cast<float>((glm::dot(oc, oc) - radius * radius) / q);
  const auto t1 = static_cast<float>(q / a);
  return q > 0.0 ? std::pair(t0, t1) : std::pair(t1, t0);
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
  const float t = roots->first > t_min ? roots->first : roots->second;
  if (t > t_min && t < t_max) return t;
  return std::nullopt;
}

}  // namespace raylab
