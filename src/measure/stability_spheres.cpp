// Spheres: far away, large, small, and seen closely.
#include "stability_cases.hpp"

namespace raylab {

namespace {

dvec3 across(UniformFloats& uniform, const dvec3& axis) {
  const dvec3 any(uniform.in_box(vec3(-1.0f), vec3(1.0f)));
  return glm::normalize(glm::cross(axis, any));
}

/// Rays at a unit sphere from a distance, that would pass its centre at up to 1.2.
StabilityTrial from_distance(double distance, std::size_t count, std::uint64_t seed) {
  UniformFloats uniform(seed);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i) {
    const dvec3 axis = glm::normalize(dvec3(uniform.in_box(vec3(-1.0f), vec3(1.0f))));
    const dvec3 target = static_cast<double>(uniform(0.0f, 1.2f)) * across(uniform, axis);
    rays.push_back({vec3(target - distance * axis), vec3(axis)});
  }
  return try_against_exact({{}, {{vec3(0.0f), 1.0f}}}, std::move(rays));
}

/// A sphere as the ground below an eye at height 1; t as solved in long double.
StabilityTrial ground(double radius, std::size_t count, std::uint64_t seed) {
  KnownRays known{{{}, {{{0.0f, -static_cast<float>(radius), 0.0f}, static_cast<float>(radius)}}}, {}, {}};
  UniformFloats uniform(seed);
  while (known.rays.size() < count) {
    const vec3 direction = glm::normalize(uniform.in_box({-1, -1, -1}, {1, -0.05f, 1}));
    if (!(direction.y < -0.05f)) continue;
    using Long = long double;
    const Long dx = direction.x, dy = direction.y, dz = direction.z, height = 1.0L + radius;
    const Long a = dx * dx + dy * dy + dz * dz, half_b = dy * height;
    const Long c = 2.0L * radius + 1.0L;  // height² - radius²
    const Long root = half_b * half_b - a * c;
    if (!(root > 0.0L)) continue;
    const auto t = static_cast<double>(c / (-half_b + std::sqrt(root)));
    known.add({{0, 1, 0}, direction}, {true, t, 1e-6 * t});
  }
  return try_known(std::move(known));
}

StabilityTrial small(double radius, std::size_t count, std::uint64_t seed) {
  const auto r = static_cast<float>(radius);
  Geometry geometry{{}, sphere_soup(100, 10.0f * r, r, seed)};
  std::vector<Ray> rays = random_rays(geometry.bounds(), count, seed + 1);
  return try_against_exact(std::move(geometry), std::move(rays));
}

StabilityTrial far_away(double offset, std::size_t count, std::uint64_t seed) {
  Geometry geometry{{}, sphere_soup(100, 50.0f, 5.0f, seed)};
  for (Sphere& s : geometry.spheres) s.center += static_cast<float>(offset) * vec3(0.55f, 0.003f, -0.83f);
  std::vector<Ray> rays = random_rays(geometry.bounds(), count, seed + 1);
  return try_against_exact(std::move(geometry), std::move(rays));
}

}  // namespace

std::vector<StabilityCase> stability_sphere_cases() {
  using enum StabilityMethods;
  const std::string differs = "differs from the exact answer";
  return {
      {13, "sphere-distance", "A unit sphere from a distance, passed at 0 to 1.2 radii", differs, "distance", queries,
       powers_of_ten(1, 7), 10, 1e7, "list book", from_distance},
      {14, "ground-sphere", "A sphere as ground, the eye 1 above", "missed, or t off by more than 1e-6 of it", "radius",
       queries, powers_of_ten(1, 8), 10, 1e8, "list book", ground},
      {15, "small-spheres", "A hundred spheres of a tenth of the scene", differs, "radius", queries,
       powers_of_ten(-20, -2, 2), 1e-20, 1e-2, "list book", small},
      {16, "far-spheres", "A hundred spheres far from the origin", differs, "distance from the origin", queries,
       powers_of_ten(1, 8), 10, 1e8, "list book", far_away},
  };
}

}  // namespace raylab
