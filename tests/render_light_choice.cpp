// Which light is chosen, of few and of many.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "catch.hpp"
#include "core/low_discrepancy.hpp"
#include "core_statistics.hpp"
#include "render/light_choice.hpp"
#include "render/lights.hpp"
#include "test_scenes.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

/// Which triangle a number chooses, as seen from the origin.
std::uint32_t chosen_triangle(const Lights& lights, std::uint64_t select) {
  if (!lights.tree().empty()) return choose_light<float>(lights.tree_view(), {vec3(0.0f), vec3(0.0f)}, select).at;
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

float probability_in_tree(const Lights& lights, std::size_t i, const vec3& p, const vec3& ng = vec3(0.0f)) {
  const EmitterId id = lights.tree().emitters()[i];
  return light_probability<float>(lights.tree_view(), {p, ng}, lights.tree().place(id.geometry, id.primitive));
}

/// The probability that the density of triangle i's points amounts to.
double density_of_choice(const Lights& lights, std::uint32_t i) {
  if (!lights.tree().empty()) return probability_in_tree(lights, i, vec3(0.0f));
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

/// Numbers and points, the same each time.
std::uint64_t number(std::uint64_t i) { return mix_bits(mix_bits(i + 99) + i); }
float unit(std::uint64_t i) { return bits_to_unit(static_cast<std::uint32_t>(number(i))); }
vec3 point_in_box(std::uint64_t i, float size) {
  return size * (2.0f * vec3(unit(3 * i), unit(3 * i + 1), unit(3 * i + 2)) - 1.0f);
}

/// Spheres and triangles in a box, with powers of five decades, and a bright sky if so asked.
Scene many_lamps(std::uint32_t count, bool sky) {
  Scene scene;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Material lamp = light(grey(std::pow(10.0f, 3.0f * unit(7000 + i))));
    const vec3 at = point_in_box(5000 + i, 2.0f);
    const float size = 0.02f * std::pow(10.0f, unit(9000 + i));
    if (i % 3 == 0) {
      add_sphere(scene, at, size, lamp);
    } else {
      add_triangle(scene,
                   {at, at + size * point_in_box(20000 + 2 * i, 1.0f), at + size * point_in_box(20001 + 2 * i, 1.0f)},
                   lamp);
    }
  }
  if (sky) set_sky(scene, 8, 4, [](int x, int y) { return Rgb(x == 3 ? 2000.0f : 100.0f, 0.2f, 300.0f * y); });
  return scene;
}

/// Whether some point of an emitter lies above the plane through p with normal ng; 0: every point does.
bool reaches_above(const Scene& scene, const EmitterId& id, const vec3& p, const vec3& ng) {
  if (ng == vec3(0.0f)) return true;
  if (scene.geometry.is_sphere(id.geometry)) {
    const Sphere& s = scene.geometry.spheres[id.primitive];
    return glm::dot(ng, s.center - p) + s.radius > 0.0f;
  }
  const Triangle t = triangle_corners(scene.geometry.meshes[id.geometry], id.primitive);
  return std::max({glm::dot(ng, t.p0 - p), glm::dot(ng, t.p1 - p), glm::dot(ng, t.p2 - p)}) > 0.0f;
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

TEST_CASE("the probabilities of a tree's lights are all positive and add up to 1", "[unit][lights]") {
  for (const bool sky : {false, true}) {
    for (const std::uint32_t count : {17u, 256u, 257u, 1000u, 5000u}) {
      const Scene scene = many_lamps(count, sky);
      const Lights lights(scene, scene_needs(scene));
      REQUIRE(lights.tree().emitters().size() == count);
      REQUIRE(lights.count() == count + (sky ? 1 : 0));
      for (std::uint64_t k = 0; k < 20; ++k) {
        // Among the lamps, on one of them, and far away.
        const vec3 p = k == 0 ? scene.geometry.spheres[0].center : point_in_box(100 + k, k % 2 == 0 ? 2.0f : 500.0f);
        double sum = sky ? 1.0 - lights.tree_view().probability : 0.0;
        // Surfaces have no use for what lies beneath them.
        const vec3 ng = k % 3 == 0 ? vec3(0.0f) : glm::normalize(point_in_box(200 + k, 1.0f));
        bool all = true;
        for (std::size_t i = 0; i < count; ++i) {
          const float probability = probability_in_tree(lights, i, p, ng);
          all &= probability > 0.0f || !reaches_above(scene, lights.tree().emitters()[i], p, ng);
          sum += probability;
        }
        INFO(count << " lamps, point " << k);
        CHECK(all);
        // A sphere about lamps may reach above a surface where none of them does: such numbers choose nothing.
        CHECK(sum < 1.0 + 1e-6);
        if (ng == vec3(0.0f)) CHECK(sum == Approx(1.0).epsilon(1e-6));
      }
    }
  }
}

TEST_CASE("a tree's lights are chosen as often as their probabilities say", "[statistical][lights]") {
  for (const bool sky : {false, true}) {
    const std::uint32_t count = 1000;
    const Scene scene = many_lamps(count, sky);
    const Lights lights(scene, scene_needs(scene));
    for (std::uint64_t k = 0; k < 4; ++k) {
      const vec3 p = point_in_box(300 + k, 2.0f);
      const std::uint64_t draws = 200000;
      const vec3 ng = k < 2 ? vec3(0.0f) : glm::normalize(point_in_box(400 + k, 1.0f));
      std::vector<double> expected(count + 2), counted(count + 2, 0.0);
      expected[count] = sky ? (1.0 - lights.tree_view().probability) * draws : 0.0;
      for (std::size_t i = 0; i < count; ++i) expected[i] = probability_in_tree(lights, i, p, ng) * draws;
      expected[count + 1] = std::max(0.0, draws - std::accumulate(expected.begin(), expected.end() - 1, 0.0));
      int different = 0;
      for (std::uint64_t i = 0; i < draws; ++i) {
        const LightChoice choice = choose_light<float>(lights.tree_view(), {p, ng}, number((k << 32) + i));
        if (!(choice.probability > 0.0)) {
          ++counted[count + 1];
          continue;
        }
        const bool from_sky = choice.at == LightChoice::kNotOfTree;
        REQUIRE((choice.u() >= 0.0f && choice.u() < 1.0f));
        ++counted[from_sky ? count : choice.at];
        different += !from_sky && std::abs(choice.probability * draws / expected[choice.at] - 1.0) > 1e-6;
      }
      CHECK(different == 0);
      CHECK(chi_square_z(counted, expected) < kLimitZ);
    }
  }
}

TEST_CASE("what is left of a number that a tree has used is spread evenly", "[statistical][lights]") {
  const Scene scene = many_lamps(100, false);
  const Lights lights(scene, scene_needs(scene));
  std::vector<double> counted(64, 0.0);
  const std::uint64_t draws = 1u << 16;
  for (std::uint64_t i = 0; i < draws; ++i) {
    ++counted[static_cast<std::size_t>(
        64.0f * choose_light<float>(lights.tree_view(), {vec3(0.3f), vec3(0.0f)}, number(i)).u())];
  }
  CHECK(chi_square_z(counted, std::vector<double>(64, draws / 64.0)) < kLimitZ);
}

TEST_CASE("of two lights alike a tree favours the nearer, and that which faces the point", "[unit][lights]") {
  Scene scene;
  const auto lamp = [&](const vec3& at, const vec3& e1, const vec3& e2) {
    add_triangle(scene, {at, at + e1, at + e2}, light(grey(1.0f)));
  };
  lamp({0, 1, 0}, {0.01f, 0, 0}, {0, 0, 0.01f});
  lamp({0, 0, 10}, {0.01f, 0, 0}, {0, 0.01f, 0});
  lamp({1, 0, 0}, {0.01f, 0, 0}, {0, 0, 0.01f});  // on edge
  for (int i = 0; i < 20; ++i) lamp({0, -1000.0f - i, 0}, {0.01f, 0, 0}, {0, 0, 0.01f});
  const Lights lights(scene, scene_needs(scene));
  const auto probability = [&](std::uint32_t mesh) {
    return light_probability<float>(lights.tree_view(), {vec3(0.0f), vec3(0.0f)}, lights.tree().place(mesh, 0));
  };
  CHECK(probability(0) / probability(1) == Approx(100.0).epsilon(0.03));
  CHECK(probability(2) < 0.02f * probability(0));
}

TEST_CASE("lights take at most 40 bytes each where there are many", "[unit][lights]") {
  for (const std::uint32_t count : {1000u, 20000u, 100000u}) {
    const Scene scene = lights_up_to(1e3, count);
    const Lights lights(scene, scene_needs(scene));
    INFO(count << " triangles");
    CHECK(lights.bytes() <= 40 * count);
  }
}
