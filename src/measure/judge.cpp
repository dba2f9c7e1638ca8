#include "raylab/measure/judge.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "raylab/core/parallel.hpp"

namespace raylab {

namespace {

/// Distance at which the rays around a ray run, in ulp of the largest coordinate: beyond what rounding moves.
constexpr float kAroundUlp = 32.0f;

float largest_coordinate(const Ray& ray, const Geometry& geometry, const PrimitiveId& id) {
  const Bounds b = primitive_bounds(geometry, id);
  return max_component(glm::max(glm::abs(ray.origin), glm::max(glm::abs(b.lower), glm::abs(b.upper))));
}

/// Eight rays from the same origin, which pass evenly spaced around the point at t, where their own t is 1. From
/// the same origin, since beside it they could start behind another surface: a ray from the floor, below the
/// floor. In units of t, since with a t near 0 the direction to a point beside it would overflow.
std::array<Ray, 8> rays_around(const Ray& ray, float t, float distance) {
  const dvec3 d = dvec3(ray.direction) / static_cast<double>(max_component(glm::abs(ray.direction)));
  const dvec3 a = glm::abs(d);
  const dvec3 axis(a.x <= a.y && a.x <= a.z, a.y < a.x && a.y <= a.z, a.z < a.x && a.z < a.y);
  const dvec3 e1 = glm::normalize(glm::cross(d, axis));
  const dvec3 e2 = glm::normalize(glm::cross(d, e1));
  const double unit = t;
  std::array<Ray, 8> around;
  for (std::size_t i = 0; i < around.size(); ++i) {
    const double angle = 0.25 * static_cast<double>(kPi) * static_cast<double>(i);
    const dvec3 offset = static_cast<double>(distance) * (std::cos(angle) * e1 + std::sin(angle) * e2);
    const double end = ray.t_max / unit;
    around[i] = {ray.origin, vec3(dvec3(ray.direction) * unit + offset), static_cast<float>(ray.t_min / unit),
                 end < std::numeric_limits<float>::max() ? static_cast<float>(end) : kInfinity};
  }
  return around;
}

/// Whether the surface stops the rays around this one too, before `passed_to`. At a silhouette it does not, and
/// whether the ray itself is stopped is a matter of rounding.
bool is_stopped_around(const Geometry& geometry, const Accelerator& exact, Ray ray, const Hit& hit, float passed_to) {
  const float largest = largest_coordinate(ray, geometry, {hit.geometry, hit.primitive});
  const float ulp = std::max(next_float_up(largest) - largest, std::numeric_limits<float>::min());
  ray.t_max = std::min(ray.t_max, passed_to);
  for (const Ray& neighbour : rays_around(ray, hit.t, kAroundUlp * ulp)) {
    if (!exact.occluded(neighbour)) return false;
  }
  return true;
}

/// Where the accelerator is past the surface for certain, if it went through: half way to what it hit instead.
float passed_to(const Disagreement& d) {
  if (!d.judged) return 0.0f;
  if (!d.tested) return d.ray.t_max;
  // Less apart they may be the same place.
  if (!(d.tested->t > d.judged->t * (1.0f + 0x1p-12f))) return 0.0f;
  return 0.5f * d.judged->t + 0.5f * d.tested->t;
}

Finding find_passages(const Geometry& geometry, const Accelerator& judged, const Accelerator& exact,
                      std::span<const Ray> rays) {
  std::vector<char> leaked(rays.size());
  parallel_for(rays.size(), [&](std::size_t i) {
    const Disagreement d{rays[i], judged.intersect(rays[i]), exact.intersect(rays[i])};
    const float end = passed_to(d);
    leaked[i] = end > 0.0f && is_stopped_around(geometry, exact, rays[i], *d.judged, end);
  });
  Finding leaks;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!leaked[i]) continue;
    if (leaks.count++ == 0) {
      leaks.first = Disagreement{rays[i], judged.intersect(rays[i]), exact.intersect(rays[i])};
    }
  }
  return leaks;
}

}  // namespace

HitErrors judge_hits(const Geometry& geometry, const Accelerator& judged, const Accelerator& exact,
                     std::span<const Ray> rays, Surface surface) {
  const AgreementReport report = compare_hits(judged, exact, geometry, rays);
  HitErrors errors;
  errors.rays_checked = report.rays;
  errors.hits = report.hits;
  errors.false_misses = report.false_misses;
  errors.false_hits = report.false_hits;
  errors.wrong_primitives = report.wrong_primitives;
  errors.undecided = report.undecided;
  errors.t_error_ulp = report.t_error_ulp;
  if (surface == Surface::closed) errors.leaks = find_passages(geometry, judged, exact, rays);
  return errors;
}

}  // namespace raylab
