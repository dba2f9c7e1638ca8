// Single triangles and floors: sizes, lengths of directions, signs of zeros.
#include "stability_cases.hpp"

namespace raylab {

namespace {

/// Rays along +z from z = -1 at points within the triangle (0,0,0), (s,0,0), (0,s,0), which they meet at t = 1.
StabilityTrial one_triangle(double size, double direction, std::size_t count, std::uint64_t seed) {
  const auto s = static_cast<float>(size);
  const auto length = static_cast<float>(direction);
  KnownRays known{{{make_mesh({{0, 0, 0}, {s, 0, 0}, {0, s, 0}}, {{0, 1, 2}})}, {}}, {}, {}};
  UniformFloats uniform(seed);
  while (known.rays.size() < count) {
    const float u = uniform(0.01f, 0.98f), v = uniform(0.01f, 0.98f);
    if (u + v > 0.99f) continue;
    known.add({{s * u, s * v, -1.0f}, {0, 0, length}}, {true, 1.0 / direction, 1e-6 / direction});
  }
  return try_known(std::move(known));
}

/// A floor of two triangles at y = -height.
TriangleMesh floor_mesh(float height, float half_side) {
  const float a = half_side;
  return make_mesh({{-a, -height, -a}, {a, -height, -a}, {a, -height, a}, {-a, -height, a}}, {{0, 1, 2}, {0, 2, 3}});
}

StabilityTrial straight_down(double height, std::size_t count, std::uint64_t seed) {
  KnownRays known{{{floor_mesh(static_cast<float>(height), 2.0f)}, {}}, {}, {}};
  UniformFloats uniform(seed);
  for (std::size_t i = 0; i < count; ++i) {
    const float x = uniform(-1.9f, 1.9f);
    known.add({{x, 0, uniform(-1.9f, 1.9f)}, {0, -1, 0}}, {true, height, 2e-7 * height});
  }
  return try_known(std::move(known));
}

StabilityTrial along_axes(double scale, std::size_t count, std::uint64_t seed) {
  const auto s = static_cast<float>(scale);
  Geometry geometry{{triangle_soup(200, s, 0.4f * s, seed), box_mesh(vec3(-0.5f * s), vec3(0.25f * s))}, {}};
  std::vector<Ray> rays = axis_aligned_rays(geometry.bounds(), count, seed + 1);
  return try_against_exact(std::move(geometry), std::move(rays));
}

/// Rays along an axis but for one component that is nearly nothing.
StabilityTrial nearly_along_axes(double component, std::size_t count, std::uint64_t seed) {
  Geometry geometry{{triangle_soup(200, 1.0f, 0.4f, seed), box_mesh(vec3(-0.5f), vec3(0.25f))}, {}};
  std::vector<Ray> rays = axis_aligned_rays(geometry.bounds(), count, seed + 1);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    vec3& d = rays[i].direction;
    const int axis = d.x != 0.0f ? 0 : d.y != 0.0f ? 1 : 2;
    d[(axis + 1) % 3] = static_cast<float>(i % 2 == 0 ? component : -component);
  }
  return try_against_exact(std::move(geometry), std::move(rays));
}

/// Long thin triangles around the x axis, and rays half a degree off it that pass far beyond their ends or meet them.
StabilityTrial skinny(double aspect, std::size_t count, std::uint64_t seed) {
  const auto width = static_cast<float>(1.0 / aspect);
  UniformFloats uniform(seed);
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < 32; ++i) {
    const vec3 p = uniform.in_box(vec3(-0.1f), vec3(0.1f));
    mesh.positions.insert(mesh.positions.end(), {p - vec3(1, 0, 0), p + vec3(1, 0, 0), p + vec3(0.3f, width, width)});
    mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
  }
  mesh.pad_positions();
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i) {
    const Triangle t = triangle_corners(mesh, static_cast<std::uint32_t>(uniform.below(mesh.triangles.size())));
    // Half a degree off the long edge, through a point of its line up to five lengths away.
    const vec3 through = 0.5f * (t.p0 + t.p1) + uniform(-5.0f, 5.0f) * (t.p1 - t.p0);
    const float turn = uniform(0.0f, 2.0f * kPi);
    const vec3 direction(1.0f, 0.0087f * std::cos(turn), 0.0087f * std::sin(turn));
    rays.push_back({through - 8.0f * direction, direction});
  }
  return try_against_exact({{std::move(mesh)}, {}}, std::move(rays));
}

/// A ray pushed off one of triangles of all sizes by so much of its size, and shot back.
StabilityTrial pushed_off(double distance, std::size_t count, std::uint64_t seed) {
  UniformFloats uniform(seed);
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < 64; ++i) {
    const float size = std::pow(10.0f, uniform(-6.0f, 3.0f));
    const vec3 corner = 3.0f * size * uniform.in_box(vec3(-1.0f), vec3(1.0f));
    const auto edge = [&] { return size * uniform.in_box(vec3(-1.0f), vec3(1.0f)); };
    mesh.positions.insert(mesh.positions.end(), {corner, corner + edge(), corner + edge()});
    mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
  }
  mesh.pad_positions();
  std::vector<Ray> rays;
  while (rays.size() < count) {
    const Triangle t = triangle_corners(mesh, static_cast<std::uint32_t>(uniform.below(mesh.triangles.size())));
    const vec3 e1 = t.p1 - t.p0, e2 = t.p2 - t.p0;
    const float u = uniform(0.1f, 0.8f), v = uniform(0.1f, 0.8f);
    const vec3 normal = glm::normalize(glm::cross(e1, e2));
    const float push = static_cast<float>(distance) * glm::length(e1);
    if (u + v > 0.9f || !(glm::length(normal) > 0.5f)) continue;
    rays.push_back({t.p0 + u * e1 + v * e2 + push * normal, -normal});
  }
  return try_against_exact({{std::move(mesh)}, {}}, std::move(rays));
}

/// Disks of a hundredth of the picture's height, seen from 100 heights away times `distance` with a narrow view.
StabilityTrial telephoto(double distance, std::size_t count, std::uint64_t seed) {
  UniformFloats uniform(seed);
  TriangleMesh mesh;
  for (int disk = 0; disk < 16; ++disk) {
    const auto middle = static_cast<std::uint32_t>(mesh.positions.size());
    const vec3 center = uniform.in_box({-0.5f, -0.5f, -0.1f}, {0.5f, 0.5f, 0.1f});
    mesh.positions.push_back(center);
    constexpr std::uint32_t kCorners = 24;
    for (std::uint32_t i = 0; i < kCorners; ++i) {
      const float angle = 2.0f * kPi * static_cast<float>(i) / kCorners;
      mesh.positions.push_back(center + 0.05f * vec3(std::cos(angle), std::sin(angle), 0.0f));
      mesh.triangles.emplace_back(middle, middle + 1 + i, middle + 1 + (i + 1) % kCorners);
    }
  }
  mesh.pad_positions();
  CameraSettings settings;
  settings.look_from = vec3(0.0f, 0.0f, static_cast<float>(distance));
  settings.look_at = vec3(0.0f);
  settings.vfov = static_cast<float>(2.0 * std::atan(0.5 / distance) * 180.0 / 3.14159265358979323846);
  settings.focus_distance = static_cast<float>(distance);
  const Camera camera(settings, 1000, 1000);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i) {
    const float x = uniform(0.0f, 1000.0f);
    rays.push_back(camera.ray(x, uniform(0.0f, 1000.0f), vec2(0.5f)));
  }
  return try_against_exact({{std::move(mesh)}, {}}, std::move(rays));
}

}  // namespace

std::vector<StabilityCase> stability_triangle_cases() {
  using enum StabilityMethods;
  return {
      {1, "small-triangle", "A triangle of legs s met from a distance of 1", "missed, or t off by more than 1e-6",
       "legs s", queries, powers_of_ten(-18, 0), 1e-18, 1.0, "list book",
       [](double s, std::size_t n, std::uint64_t seed) { return one_triangle(s, 1.0, n, seed); }},
      {2, "direction-length", "A unit triangle met by a direction of any length",
       "missed, or t off by more than 1e-6 of it", "length of the direction", queries, powers_of_ten(-18, 18, 3), 1e-18,
       1e18, "list book", [](double d, std::size_t n, std::uint64_t seed) { return one_triangle(1.0, d, n, seed); }},
      {3, "large-triangle", "A triangle of legs s met from a distance of 1", "missed, or t off by more than 1e-6",
       "legs s", queries, powers_of_ten(6, 18), 1e6, 1e18, "",
       [](double s, std::size_t n, std::uint64_t seed) { return one_triangle(s, 1.0, n, seed); }},
      {10, "axis-rays", "Rays along the axes, their other components 0 or -0", "differs from the exact answer",
       "scale of the scene", queries, powers_of_ten(-6, 6, 2), 1e-6, 1e6, "rtiow book", along_axes},
      {11, "flat-floor", "A floor straight below", "missed, or t off by more than 2e-7 of it", "height", queries,
       values(1, 1023, 1025, 2000, 1e4, 1e5, 1e6, 1e7), 1, 1e7, "", straight_down},
      {12, "tiny-component", "Rays along an axis but for one component", "differs from the exact answer",
       "that component", queries, powers_of_ten(-45, -3, 3), 1e-45, 1e-3, "", nearly_along_axes},
      {24, "skinny-triangle", "Triangles along rays half a degree off them", "differs from the exact answer",
       "length over width", queries, powers_of_ten(0, 7), 1, 1e7, "", skinny},
      {35, "push-back", "A ray pushed off a triangle and shot back", "differs from the exact answer",
       "distance over the triangle's size", queries, powers_of_ten(-7, 0), 1e-7, 1, "list book", pushed_off},
      {36, "telephoto", "Small disks seen from far away in a narrow view", "differs from the exact answer",
       "distance in heights of the view", queries, powers_of_ten(0, 6), 1, 1e6, "", telephoto},
  };
}

}  // namespace raylab
