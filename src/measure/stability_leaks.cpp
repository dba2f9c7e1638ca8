// Closed meshes and height fields: no ray may go through.
#include <algorithm>

#include "raylab/core/parallel.hpp"
#include "stability_cases.hpp"

namespace raylab {

namespace {

using RaysAt = std::vector<Ray> (*)(const TriangleMesh&, const vec3&, float, std::size_t, std::uint64_t);

StabilityTrial inside_ball(RaysAt rays_at, const vec3& center, double radius, std::size_t count, std::uint64_t seed) {
  TriangleMesh ball = icosphere(center, static_cast<float>(radius), 2);
  std::vector<Ray> rays = rays_at(ball, center, 0.3f * static_cast<float>(radius), count, seed);
  return try_all_hit({{std::move(ball)}, {}}, std::move(rays));
}

/// Far out the ball's corners are few, and some origins may lie outside: what the exact answer says counts.
StabilityTrial inside_far_ball(RaysAt rays_at, double offset, std::size_t count, std::uint64_t seed) {
  const vec3 center = static_cast<float>(offset) * vec3(0.55f, 0.003f, -0.83f);
  KnownRays known{{{icosphere(center, 2.0f, 2)}, {}}, {}, {}};
  known.rays = rays_at(known.geometry.meshes[0], center, 0.6f, count, seed);
  std::erase_if(known.rays, [](const Ray& ray) { return ray.direction == vec3(0.0f); });
  known.expected = exact_presence(known.geometry, known.rays);
  return try_known(std::move(known));
}

StabilityTrial height_field(double spacing, std::size_t count, std::uint64_t seed) {
  constexpr std::uint32_t kSide = 12;
  const auto s = static_cast<float>(spacing);
  UniformFloats uniform(seed);
  TriangleMesh field;
  for (std::uint32_t i = 0; i < kSide * kSide; ++i) {
    const auto height = static_cast<float>(uniform.below(5));
    const glm::uvec2 place(i % kSide, i / kSide);
    field.positions.push_back(s * vec3(place.x, height, place.y));
  }
  for (std::uint32_t z = 0; z + 1 < kSide; ++z) {
    for (std::uint32_t x = 0; x + 1 < kSide; ++x) {
      const std::uint32_t i = z * kSide + x;
      field.triangles.insert(field.triangles.end(), {{i, i + kSide, i + 1}, {i + 1, i + kSide, i + kSide + 1}});
    }
  }
  field.pad_positions();
  KnownRays known{{{std::move(field)}, {}}, {}, {}};
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t x = 1 + uniform.below(kSide - 2), z = 1 + uniform.below(kSide - 2);
    const vec3 p = known.geometry.meshes[0].positions[z * kSide + x];
    const float top = 10.0f * s;
    known.add({{p.x, top, p.z}, {0, -1, 0}},
              {true, static_cast<double>(top) - static_cast<double>(p.y), 1e-5 * spacing});
  }
  return try_known(std::move(known));
}

/// From outside to vertices and edges that face the eye: what is met lies there, not on the back.
StabilityTrial outside_ball(double radius, std::size_t count, std::uint64_t seed) {
  const auto r = static_cast<float>(radius);
  KnownRays known{{{icosphere(vec3(0.0f), r, 2)}, {}}, {}, {}};
  UniformFloats uniform(seed);
  for (std::uint64_t round = 0; known.rays.size() < count; ++round) {
    const RaysAt rays_at = round % 2 == 0 ? rays_at_vertices : rays_at_edges;
    for (const Ray& aim : rays_at(known.geometry.meshes[0], vec3(0.0f), 0.0f, count, seed + round)) {
      const vec3 target = aim.direction;  // from the centre
      const vec3 eye = 5.0f * r * glm::normalize(uniform.in_box(vec3(-1.0f), vec3(1.0f)));
      const vec3 direction = target - eye;
      if (glm::dot(glm::normalize(direction), glm::normalize(target)) > -0.3f) continue;
      known.add({eye, direction}, {true, 1.0, 0.01});
      if (known.rays.size() == count) break;
    }
  }
  return try_known(std::move(known));
}

/// A closed double cone whose tips are shared by so many slivers.
TriangleMesh double_cone(std::uint32_t slivers, float radius) {
  TriangleMesh mesh;
  mesh.positions = {{0, radius, 0}, {0, -radius, 0}};
  for (std::uint32_t i = 0; i < slivers; ++i) {
    const double angle = 2.0 * 3.14159265358979323846 * i / slivers;
    mesh.positions.push_back(radius * vec3(dvec3(std::cos(angle), 0.0, std::sin(angle))));
    const std::uint32_t here = 2 + i, next = 2 + (i + 1) % slivers;
    mesh.triangles.emplace_back(0u, next, here);
    mesh.triangles.emplace_back(1u, here, next);
  }
  mesh.pad_positions();
  return mesh;
}

StabilityTrial fan(double slivers, std::size_t count, std::uint64_t seed) {
  TriangleMesh mesh = double_cone(static_cast<std::uint32_t>(slivers), 1.0f);
  // Every other ray at a tip itself, where all of a fan meet.
  // Fewer where brute force tests so many.
  const std::size_t few = std::clamp(static_cast<std::size_t>(1e7 / slivers), std::size_t{100}, count);
  std::vector<Ray> rays = rays_at_edges(mesh, vec3(0.0f), 0.2f, few, seed);
  for (std::size_t i = 0; i < rays.size(); i += 2) {
    rays[i].direction = mesh.positions[i / 2 % 2] - rays[i].origin;
  }
  return try_all_hit({{std::move(mesh)}, {}}, std::move(rays));
}

}  // namespace

std::vector<StabilityCase> stability_leak_cases() {
  using enum StabilityMethods;
  const std::vector<double> radii = powers_of_ten(-18, 17, 5);
  const std::vector<double> distances = powers_of_ten(0, 7);
  const std::string through = "the ray goes through";
  return {
      {4, "vertices", "From within a closed mesh to its vertices", through, "radius", queries, radii, 1e-18, 1e17,
       "list book",
       [](double r, std::size_t n, std::uint64_t seed) {
         return inside_ball(rays_at_vertices, vec3(0.0f), r, n, seed);
       }},
      {5, "edges", "From within a closed mesh to its edges", through, "radius", queries, radii, 1e-18, 1e17,
       "list book",
       [](double r, std::size_t n, std::uint64_t seed) { return inside_ball(rays_at_edges, vec3(0.0f), r, n, seed); }},
      {6, "far-vertices", "From within a closed mesh of radius 2 to its vertices", through, "distance from the origin",
       queries, distances, 1, 1e7, "list book",
       [](double d, std::size_t n, std::uint64_t seed) { return inside_far_ball(rays_at_vertices, d, n, seed); }},
      {7, "far-edges", "From within a closed mesh of radius 2 to its edges", through, "distance from the origin",
       queries, distances, 1, 1e7, "list book",
       [](double d, std::size_t n, std::uint64_t seed) { return inside_far_ball(rays_at_edges, d, n, seed); }},
      {8, "height-field", "Straight down on the vertices of a field of heights that are whole numbers of its spacing",
       "missed, or at another height", "spacing", queries, powers_of_ten(-6, 6, 2), 1e-6, 1e6, "list book",
       height_field},
      {34, "from-outside", "From outside to vertices and edges that face the eye", "missed, or met on the back",
       "radius", queries, radii, 1e-18, 1e17, "list book", outside_ball},
      {41, "fan", "To the tips and edges of a closed double cone", through, "slivers that share a tip", queries,
       values(10, 100, 1000, 10000), 10, 10000, "rtiow book", fan},
  };
}

}  // namespace raylab
