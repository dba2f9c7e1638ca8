// Which light is chosen, of few and of many.
#include <algorithm>
#include <cmath>

#include "catch.hpp"
#include "render/lights.hpp"
#include "test_scenes.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

/// Which triangle a number chooses.
std::uint32_t chosen_triangle(const Lights& lights, std::uint64_t select) {
  const auto high = static_cast<std::uint32_t>(select >> 32), low = static_cast<std::uint32_t>(select);
  const float zero = 0.0f;
  LightLanes out;
  lights.sample(1u, &high, &low, &zero, {&zero, &zero, &zero}, out);
  REQUIRE(out.triangles == 1u);
  return out.emitter[0];
}

/// The part of all numbers that choose triangle i.
double frequency_of_choice(const Lights& lights, std::uint32_t i) {
  const auto least = [&](std::uint32_t wanted) {  // that chooses this one or a later one
    std::uint64_t found = 0;
    for (std::uint64_t bit = 1ull << 63; bit != 0; bit >>= 1) {
      if (chosen_triangle(lights, found + bit - 1) < wanted) found += bit;
    }
    return found;
  };
  const std::uint64_t begin = i == 0 ? 0 : least(i);
  const std::uint64_t end = i + 1 == lights.count() ? 0 : least(i + 1);  // 0: 2^64
  return static_cast<double>(end - begin) * 0x1p-64;
}

/// The probability that the density of triangle i's points amounts to.
double density_of_choice(const Lights& lights, std::uint32_t i) {
  const TriangleEmitter& t = lights.emitting_triangles()[i];
  return t.pdf_area * 0.5 * glm::length(glm::cross(dvec3(t.e1), dvec3(t.e2)));
}

/// Triangle lights of one material and of powers from 1 to `ratio`.
Scene lights_up_to(double ratio, std::uint32_t count) {
  Scene scene;
  add_triangle(scene, {}, light(grey(1.0f)));
  TriangleMesh& mesh = scene.geometry.meshes[0];
  mesh = {};
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto edge = static_cast<float>(std::pow(ratio, 0.5 * i / (count - 1)));
    mesh.positions.insert(mesh.positions.end(), {vec3(0, 0, 1), vec3(edge, 0, 1), vec3(0, edge, 1)});
    mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
  }
  return scene;
}

}  // namespace

TEST_CASE("every light of a million is chosen as often as its density says", "[unit][lights]") {
  for (const double ratio : {1.0, 1e9}) {
    const std::uint32_t count = 1000000;
    const Scene scene = lights_up_to(ratio, count);
    const Lights lights(scene, scene_needs(scene));
    REQUIRE(lights.count() == count);
    double worst = 0.0;
    for (std::uint32_t i = 0; i < count; i += 3571) {
      for (const std::uint32_t k : {i, count - 1 - i}) {
        worst = std::max(worst, std::abs(frequency_of_choice(lights, k) / density_of_choice(lights, k) - 1.0));
      }
    }
    INFO("powers from 1 to " << ratio);
    CHECK(worst < 1e-5);
  }
}

TEST_CASE("few lights are chosen as often as their densities say", "[unit][lights]") {
  for (const double ratio : {1.0, 30.0, 1e4, 1e9}) {
    for (const std::uint32_t count : {2u, 3u, 16u, 17u}) {
      const Scene scene = lights_up_to(ratio, count);
      const Lights lights(scene, scene_needs(scene));
      INFO(count << " lights, powers from 1 to " << ratio);
      double worst = 0.0;
      for (std::uint32_t i = 0; i < count; ++i) {
        worst = std::max(worst, std::abs(frequency_of_choice(lights, i) / density_of_choice(lights, i) - 1.0));
      }
      CHECK(worst < 0x1p-14);
      // Both ways to choose lead to the same one, at the borders between two too.
      const LightTable& table = lights.table();
      CHECK((table.count != 0) == (count <= 16 && ratio < 100.0));
      int different = 0;
      for (int i = 1; i < table.count; ++i) {
        const auto border = static_cast<std::uint32_t>(table.first[i] * 0x1p24f);
        for (const std::uint32_t number : {border - 1, border, border + 1}) {
          const auto by_table =
              std::upper_bound(table.first, table.first + table.count, number * 0x1p-24f) - table.first - 1;
          different += chosen_triangle(lights, static_cast<std::uint64_t>(number) << 40) != by_table;
        }
      }
      CHECK(different == 0);
    }
  }
}

TEST_CASE("what gives no light is no light", "[unit][lights]") {
  Scene scene;
  CHECK(Lights(scene, scene_needs(scene)).empty());
  add_sphere(scene, vec3(0.0f), 1.0f, light(grey(0.0f)));
  add_triangle(scene, {vec3(0), vec3(1), vec3(2)}, light(grey(1.0f)));  // no area
  add_triangle(scene, {vec3(0), vec3(std::nanf("")), vec3(2, 0, 0)}, light(grey(1.0f)));
  add_sphere(scene, vec3(0.0f), -1.0f, light(grey(1.0f)));
  add_quad(scene, vec3(0.0f), {1, 0, 0}, {0, 1, 0}, lambertian(grey(1.0f)));
  CHECK(Lights(scene, scene_needs(scene)).empty());
  set_sky(scene, Rgb(1.0f));
  CHECK(Lights(scene, scene_needs(scene)).empty());  // seen, but not worth aiming at
  add_quad(scene, vec3(0.0f), {1, 0, 0}, {0, 1, 0}, light(grey(1.0f)));
  CHECK(Lights(scene, scene_needs(scene)).count() == 2);
}
