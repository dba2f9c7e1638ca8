#include "raylab/measure/agreement.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/primitive_test.hpp"
#include "raylab/core/parallel.hpp"
#include "raylab/geometry/exact.hpp"
#include "raylab/measure/ray_sets.hpp"

namespace raylab {

namespace {

/// The tolerance of every comparison, in ulp of the largest coordinate involved.
constexpr double kToleranceUlp = 8.0;

double ulp(float x) {
  const float size = std::max(std::abs(x), std::numeric_limits<float>::min());
  return static_cast<double>(next_float_up(size)) - static_cast<double>(size);
}

double tolerance(const Ray& ray, const Geometry& geometry, const PrimitiveId& id) {
  const Bounds b = primitive_bounds(geometry, id);
  const vec3 largest = glm::max(glm::abs(ray.origin), glm::max(glm::abs(b.lower), glm::abs(b.upper)));
  return kToleranceUlp * ulp(max_component(largest));
}

/// The part of v at right angles to the direction d.
dvec3 across(const dvec3& v, const dvec3& d) { return v - d * (glm::dot(v, d) / glm::dot(d, d)); }

double distance_to_edge(const dvec3& origin, const dvec3& direction, const dvec3& p, const dvec3& q) {
  const dvec3 start = across(p - origin, direction);
  const dvec3 edge = across(q - p, direction);
  const double length_squared = glm::dot(edge, edge);
  const double s = length_squared > 0.0 ? std::clamp(-glm::dot(start, edge) / length_squared, 0.0, 1.0) : 0.0;
  return glm::length(start + s * edge);
}

dvec3 normal_at(const Ray& ray, const Geometry& geometry, const Hit& hit) {
  if (geometry.is_sphere(hit.geometry)) {
    const dvec3 p = dvec3(ray.origin) + static_cast<double>(hit.t) * dvec3(ray.direction);
    return p - dvec3(geometry.spheres[hit.primitive].center);
  }
  const Triangle t = triangle_corners(geometry.meshes[hit.geometry], hit.primitive);
  return glm::cross(dvec3(t.p1) - dvec3(t.p0), dvec3(t.p2) - dvec3(t.p0));
}

/// How far t may be off for the surface to be off by the tolerance along its normal.
double t_tolerance(const Ray& ray, const Geometry& geometry, const Hit& hit) {
  const dvec3 n = normal_at(ray, geometry, hit);
  const double speed = std::abs(glm::dot(n, dvec3(ray.direction))) / glm::length(n);
  return tolerance(ray, geometry, {hit.geometry, hit.primitive}) / speed;
}

/// Whether floats may decide either way that this is a hit.
bool is_doubtful(const Ray& ray, const Geometry& geometry, const Hit& hit) {
  const PrimitiveId id{hit.geometry, hit.primitive};
  if (distance_to_outline(ray, geometry, id) <= tolerance(ray, geometry, id)) return true;
  const double slack = t_tolerance(ray, geometry, hit);
  const double t = hit.t;
  return std::abs(t - ray.t_min) <= slack || std::abs(ray.t_max - t) <= slack;
}

/// Whether the primitive that a hit names is there, at the t it gives: of two that coincide either will do.
bool is_where_it_says(const Ray& ray, const Geometry& geometry, const Hit& hit) {
  const PrimitiveId id{hit.geometry, hit.primitive};
  if (id.geometry > geometry.sphere_geometry()) return false;
  const bool is_sphere = geometry.is_sphere(id.geometry);
  const std::size_t count = is_sphere ? geometry.spheres.size() : geometry.meshes[id.geometry].triangles.size();
  if (id.primitive >= count) return false;
  if (is_sphere ? !is_valid_sphere(geometry.spheres[id.primitive])
                : !is_valid_triangle(geometry.meshes[id.geometry], id.primitive)) {
    return false;
  }
  if (distance_to_outline(ray, geometry, id) <= tolerance(ray, geometry, id)) return true;
  const auto slack = static_cast<float>(t_tolerance(ray, geometry, hit));
  const PrimitiveTest<Intersector::watertight> test(ray);
  return test(geometry, id, hit.t - 2.0f * slack, hit.t + 2.0f * slack).has_value();
}

/// The t of the hit before it was rounded, where the exact ray meets that primitive.
double exact_t(const Ray& ray, const Geometry& geometry, const Hit& hit) {
  const auto crossing = ExactTest(geometry, ray)({hit.geometry, hit.primitive});
  return crossing ? crossing->t : static_cast<double>(hit.t);
}

void add(Finding& finding, const Disagreement& d) {
  if (finding.count++ == 0) finding.first = d;
}

void add(Finding& finding, const Finding& later) {
  if (finding.count == 0) finding.first = later.first;
  finding.count += later.count;
}

/// A report in the making: the errors in t still one by one.
struct Partial {
  AgreementReport report;
  std::vector<double> t_errors;
};

void compare(const Accelerator& tested, const Accelerator& judge, const Geometry& geometry, const Ray& ray,
             Partial& partial) {
  AgreementReport& report = partial.report;
  const Disagreement d{ray, tested.intersect(ray), judge.intersect(ray)};
  report.rays += 1;
  report.hits += d.judged.has_value() ? 1 : 0;
  if (tested.occluded(ray) != d.tested.has_value()) add(report.occlusion, d);
  if (!d.tested && !d.judged) return;

  const bool both = d.tested && d.judged;
  if (both) {
    const double error = std::abs(static_cast<double>(d.tested->t) - exact_t(ray, geometry, *d.judged));
    const bool same = d.tested->primitive == d.judged->primitive && d.tested->geometry == d.judged->geometry;
    if (!same && !is_where_it_says(ray, geometry, *d.tested)) {
      add(report.wrong_primitives, d);
      return;
    }
    const bool near = error <= t_tolerance(ray, geometry, *d.judged);
    if (same || near) partial.t_errors.push_back(error / ulp(d.judged->t));
    if (near) return;
  }
  const Hit& nearer = both ? (d.tested->t < d.judged->t ? *d.tested : *d.judged) : d.tested ? *d.tested : *d.judged;
  if (is_doubtful(ray, geometry, nearer)) {
    report.undecided += 1;
  } else {
    add(both ? report.wrong_primitives : d.tested ? report.false_hits : report.false_misses, d);
  }
}

UlpError distribution(std::vector<double>& errors) {
  if (errors.empty()) return {};
  std::sort(errors.begin(), errors.end());
  const auto at = [&](double share) {
    return errors[static_cast<std::size_t>(share * static_cast<double>(errors.size() - 1))];
  };
  return {at(0.5), at(0.99), errors.back()};
}

}  // namespace

double distance_to_outline(const Ray& ray, const Geometry& geometry, const PrimitiveId& id) {
  const dvec3 origin(ray.origin);
  const dvec3 direction(ray.direction);
  if (geometry.is_sphere(id.geometry)) {
    const Sphere& s = geometry.spheres[id.primitive];
    return std::abs(glm::length(across(dvec3(s.center) - origin, direction)) - static_cast<double>(s.radius));
  }
  const Triangle t = triangle_corners(geometry.meshes[id.geometry], id.primitive);
  const double edge0 = distance_to_edge(origin, direction, dvec3(t.p0), dvec3(t.p1));
  const double edge1 = distance_to_edge(origin, direction, dvec3(t.p1), dvec3(t.p2));
  return std::min({edge0, edge1, distance_to_edge(origin, direction, dvec3(t.p2), dvec3(t.p0))});
}

AgreementReport compare_hits(const Accelerator& tested, const Accelerator& judge, const Geometry& geometry,
                             std::span<const Ray> rays) {
  constexpr std::size_t kBlock = 512;
  std::vector<Partial> partials((rays.size() + kBlock - 1) / kBlock);
  parallel_for(partials.size(), [&](std::size_t i) {
    const std::size_t start = i * kBlock;
    for (const Ray& ray : rays.subspan(start, std::min(kBlock, rays.size() - start))) {
      compare(tested, judge, geometry, ray, partials[i]);
    }
  });
  AgreementReport all;
  std::vector<double> t_errors;
  for (const Partial& p : partials) {
    all.rays += p.report.rays;
    all.hits += p.report.hits;
    all.undecided += p.report.undecided;
    add(all.false_misses, p.report.false_misses);
    add(all.false_hits, p.report.false_hits);
    add(all.wrong_primitives, p.report.wrong_primitives);
    add(all.occlusion, p.report.occlusion);
    t_errors.insert(t_errors.end(), p.t_errors.begin(), p.t_errors.end());
  }
  all.t_error_ulp = distribution(t_errors);
  return all;
}

Finding different_batches(const Accelerator& tested, std::span<const Ray> rays) {
  constexpr std::size_t kMost = 1500;
  const FlushDenormals flush;
  const RayArrays arrays(rays);
  Finding different;
  std::size_t count = 0;
  for (std::size_t first = 0; first < rays.size(); first += count) {
    count = std::min({count + count / 2 + 1, rays.size() - first, kMost});  // 1, 2, 4, 7, 11, ...
    HitArrays hits(count);
    std::vector<std::uint8_t> occluded(count, 2);
    tested.intersect_batch(arrays.batch(first, count), hits.batch());
    tested.occluded_batch(arrays.batch(first, count), occluded.data());
    for (std::size_t i = 0; i < count; ++i) {
      const Ray& ray = rays[first + i];
      const std::optional<Hit> single = tested.intersect(ray);
      if (hits[i] == single && occluded[i] == (tested.occluded(ray) ? 1 : 0)) continue;
      add(different, Disagreement{ray, hits[i], single});
    }
  }
  return different;
}

Finding find_leaks(const Accelerator& tested, std::span<const Ray> rays_from_inside) {
  std::vector<char> leaked(rays_from_inside.size());
  parallel_for(leaked.size(), [&](std::size_t i) { leaked[i] = !tested.intersect(rays_from_inside[i]); });
  Finding leaks;
  for (std::size_t i = 0; i < leaked.size(); ++i) {
    if (leaked[i]) add(leaks, Disagreement{rays_from_inside[i], std::nullopt, std::nullopt});
  }
  return leaks;
}

}  // namespace raylab
