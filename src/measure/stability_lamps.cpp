// Lamps nearly touched, seen from their plane, from within, in numbers.
#include <algorithm>

#include "raylab/core/text.hpp"
#include "stability_cases.hpp"

namespace raylab {

namespace {

using namespace made;

constexpr double kPiD = 3.14159265358979323846;
constexpr double kAlbedo = 0.6, kRadiance = 7.0;

Material white() { return lambertian(grey(static_cast<float>(kAlbedo))); }
Material lamp() { return light(grey(static_cast<float>(kRadiance))); }

/// A scene seen in one point, and its radiance after one reflection.
StabilityTrial direct_light(SeenScene scene, double expected, std::size_t count, std::uint64_t seed,
                            double tolerance = 1e-3) {
  return [=, scene = std::move(scene)](const StabilityMethod& method) {
    const RenderOptions options = stability_render_options(method, 4 * count, 256, seed, 2);
    return rows_off(stability_render(scene, options, method), expected, tolerance);
  };
}

/// A ceiling so far above a lamp.
StabilityTrial coplanar(double gap, std::size_t count, std::uint64_t seed) {
  LampOverFloor made = lamp_over_floor();
  const auto height = static_cast<float>(1.5 + gap);
  add_quad(made.scene, {-2, height, -2}, {4, 0, 0}, {0, 0, 4}, lambertian(grey(0.0f)));
  return direct_light(std::move(made.scene), made.expected, count, seed);
}

/// A sphere lamp of radius 1 so far above the floor, seen from beneath it.
StabilityTrial sphere_gap(double gap, std::size_t count, std::uint64_t seed) {
  SeenScene scene;
  const auto height = static_cast<float>(1.0 + gap);
  add_quad(scene, {-4, 0, -4}, {0, 0, 8}, {8, 0, 0}, white());
  add_sphere(scene, {0, height, 0}, 1.0f, lamp());
  const double x = std::sqrt(2.0 * gap);  // half as high there as the lamp
  look(scene, vec3(dvec3(x, 0.5 * gap, 0.0)), vec3(0.0f), 0.02f);
  const double d = height;
  return direct_light(std::move(scene), kAlbedo * kRadiance / (d * d), count, seed);
}

/// A piece of floor within a sphere lamp, so far from its centre: it sees the lamp everywhere.
StabilityTrial inside_lamp(double place, std::size_t count, std::uint64_t seed) {
  SeenScene scene;
  const auto z = static_cast<float>(place);
  add_sphere(scene, vec3(0.0f), 1.0f, lamp());
  const auto a = static_cast<float>(0.1 * (1.0 - place));
  add_quad(scene, {-a, 0, z - a}, {0, 0, 2 * a}, {2 * a, 0, 0}, white());
  look(scene, {a, 2 * a, z}, {0, 0, z}, 0.02f);
  return direct_light(std::move(scene), kAlbedo * kRadiance, count, seed);
}

/// The floor so far from the foot of a lamp that stands on it.
StabilityTrial foot_of_lamp(double distance, std::size_t count, std::uint64_t seed) {
  SeenScene scene;
  const auto x = static_cast<float>(distance);
  add_quad(scene, {-1, 0, -2}, {0, 0, 4}, {4, 0, 0}, white());
  add_quad(scene, {0, 0, -1}, {0, 0, 2}, {0, 1, 0}, lamp());
  add_triangle(scene, {{1, 1, 0}, {2, 2, 0}, {3, 3, 0}}, lamp());  // without area
  look(scene, {2 * x, x, 0}, {x, 0, 0}, 0.02f);
  const double c = x, far = std::sqrt(1.0 + c * c);
  const double factor = (std::atan(1.0 / c) - c / far * std::atan(1.0 / far)) / kPiD;
  return direct_light(std::move(scene), kAlbedo * kRadiance * factor, count, seed);
}

/// As many small lamps on a hemisphere as asked, their powers from 1 to 1e9, above a point of the floor.
StabilityTrial many_lamps(double number, std::size_t count, std::uint64_t seed) {
  constexpr std::size_t kPowers = 10;
  UniformFloats uniform(seed);
  SeenScene scene;
  add_quad(scene, {-2, 0, -2}, {0, 0, 4}, {4, 0, 0}, white());
  const float size = 1e-4f;
  double irradiance = 0.0;
  for (std::size_t power = 0; power < kPowers; ++power) {
    TriangleMesh mesh;
    const double radiance = std::pow(10.0, static_cast<double>(power));
    const std::size_t lamps = std::max<std::size_t>(1, static_cast<std::size_t>(number) / kPowers);
    for (std::uint32_t i = 0; i < lamps; ++i) {
      vec3 n = glm::normalize(uniform.in_box({-1, 0.3f, -1}, {1, 1, 1}));
      const vec3 x = glm::normalize(glm::cross(n, std::abs(n.x) < 0.5f ? vec3(1, 0, 0) : vec3(0, 0, 1)));
      const vec3 y = glm::cross(n, x);
      mesh.positions.insert(mesh.positions.end(), {n - size * x, n + size * x, n + size * y});
      mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
      irradiance += radiance * static_cast<double>(size) * static_cast<double>(size) * static_cast<double>(n.y);
    }
    mesh.pad_positions();
    scene.geometry.meshes.push_back(std::move(mesh));
    scene.mesh_names.push_back(format("lamps of power %zu", power));
    scene.materials.push_back(light(grey(static_cast<float>(radiance))));
    scene.mesh_materials.push_back({static_cast<std::uint32_t>(scene.materials.size() - 1), {}});
  }
  look(scene, {0.5f, 0.1f, 0.5f}, vec3(0.0f), 0.02f);
  return direct_light(std::move(scene), kAlbedo / kPiD * irradiance, count, seed);
}

/// Two walls and a lamp that meet in an edge, seen so far from it: no single path brings more than the lamp.
StabilityTrial tiny_distances(double distance, std::size_t count, std::uint64_t seed) {
  SeenScene scene;
  const auto d = static_cast<float>(distance);
  add_quad(scene, {0, 0, -1}, {0, 0, 2}, {1, 0, 0}, lambertian(grey(0.9f)));
  add_quad(scene, {0, 0, -1}, {0, 0, 2}, {0, 1, 0}, lamp());
  add_quad(scene, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, lambertian(grey(0.9f)));
  look(scene, {4 * d, 3 * d, 4 * d}, {d, 0, d}, 20.0f);
  return [=](const StabilityMethod& method) {
    const Film film = stability_render(scene, stability_render_options(method, count, 1, seed, 4), method);
    StabilityCount found{0, static_cast<std::size_t>(film.width()) * static_cast<std::size_t>(film.height())};
    // Two strategies for each of three reflections, joined by the balance heuristic: each adds no more than the lamp.
    const auto most = static_cast<float>(4.0 * kRadiance);
    for (int y = 0; y < film.height(); ++y) {
      for (int x = 0; x < film.width(); ++x) {
        found.failures += film.samples(x, y) != 1 || !(max_component(film.mean(x, y)) <= most);
      }
    }
    return found;
  };
}

}  // namespace

std::vector<StabilityCase> stability_lamp_cases() {
  using enum StabilityMethods;
  const std::string rows = "a row of pixels off by 4.5 standard errors and 0.1%";
  return {
      {43, "coplanar-lamp", "A lamp just below a ceiling, against its form factor", rows, "gap", renders,
       powers_of_ten(-8, -1), 1e-8, 0.1, "", coplanar},
      // At 1e-7 radii the lamp is one step of floats away.
      {47, "sphere-lamp-gap", "A sphere lamp that nearly touches the floor", rows, "gap in radii", renders,
       powers_of_ten(-7, 0), 1e-6, 1, "", sphere_gap},
      {48, "inside-lamp", "A piece of floor within a sphere lamp", rows, "distance from the centre in radii", renders,
       values(0, 0.5, 0.9, 0.99, 0.999), 0, 0.999, "", inside_lamp},
      {49, "foot-of-lamp", "The floor at the foot of a lamp, against its form factor", rows, "distance from the foot",
       renders, powers_of_ten(-6, 0), 1e-6, 1, "", foot_of_lamp},
      {50, "many-lamps", "Small lamps of powers from 1 to 1e9", rows, "number of lamps", paths, powers_of_ten(1, 6), 10,
       1e6, "", many_lamps},
      {54, "tiny-distances", "Walls and a lamp that meet in an edge, seen closely",
       "a path of more than four times the lamp, or of no number", "distance from the edge", renders,
       powers_of_ten(-6, 0), 1e-6, 1, "", tiny_distances},
  };
}

}  // namespace raylab
