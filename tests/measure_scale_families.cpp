#include <algorithm>

#include "catch.hpp"
#include "expect_error.hpp"
#include "raylab/measure/scale_families.hpp"

using namespace raylab;
using namespace raylab::test;

TEST_CASE("a scale family has about the triangles asked for, all valid, and its rays", "[unit][measure]") {
  for (const std::string_view name : scale_family_names()) {
    for (const std::size_t size : {100u, 1000u, 20000u}) {
      const ScaleFamily family = make_scale_family(name, size, 50, 1);
      INFO(name << " of " << size);
      // Spheres come in powers of four; the stadium's bowl has 200 more.
      const std::size_t count = family.geometry.triangle_count() - (name == "stadium" ? 200 : 0);
      CHECK(count >= size / 2);
      CHECK(count <= size * 2);
      CHECK(valid_primitives(family.geometry).size() == family.geometry.triangle_count());
      CHECK(family.rays.size() == 50);
    }
  }
}

TEST_CASE("thin triangles are ten thousand times as long as wide", "[unit][measure]") {
  const ScaleFamily family = make_scale_family("thin", 100, 1, 1);
  const Triangle t = triangle_corners(family.geometry.meshes[0], 5);
  CHECK(glm::length(t.p1 - t.p0) == Approx(1.0).epsilon(0.01));
  CHECK(glm::length(t.p2 - t.p0) <= 1.1e-4f);
}

TEST_CASE("an unknown family is refused by name", "[unit][measure]") {
  expect_error(ErrorKind::usage, "--family", {"\"cube\"", "stadium"},
               [] { (void)make_scale_family("cube", 100, 1, 1); });
}
