// The sphere test against analytic values, where the quadratic formula in floats fails.
#include <cfloat>
#include <cmath>

#include "catch.hpp"
#include "raylab/core/parallel.hpp"
#include "raylab/geometry/intersect.hpp"

using namespace raylab;

namespace {

std::optional<float> ours(const Ray& ray, const Sphere& s) {
  return intersect_sphere(Intersector::watertight, ray, s, ray.t_min, ray.t_max);
}
std::optional<float> book(const Ray& ray, const Sphere& s) {
  return intersect_sphere(Intersector::book, ray, s, ray.t_min, ray.t_max);
}

}  // namespace

TEST_CASE("a sphere is hit at its near side from outside and at its far side from inside", "[unit]") {
  const Sphere sphere{{1, 2, 3}, 2};
  CHECK(ours({{1, 2, -7}, {0, 0, 2}}, sphere) == 4.0f);
  CHECK(ours({{1, 2, 3}, {0, 4, 0}}, sphere) == 0.5f);
  CHECK(ours({{1, 2, -7}, {0, 0, 1}, 8.0f}, sphere) == 12.0f);
  CHECK_FALSE(ours({{1, 2, -7}, {0, 0, -1}}, sphere));
  CHECK_FALSE(ours({{1, 2, -7}, {0, 0, 1}, 0.0f, 8.0f}, sphere));
  CHECK_FALSE(ours({{1, 2, -7}, {0, 0, 1}, 12.0f}, sphere));
}

TEST_CASE("a distant unit sphere is hit exactly when the impact parameter is below one", "[stability]") {
  std::size_t wrong_by_book = 0;
  for (const float distance : {10.0f, 1e2f, 1e3f, 4096.0f, 1e4f, 1e5f}) {
    for (int i = 0; i <= 1200; ++i) {
      const float impact = static_cast<float>(i) / 1000.0f;
      const Ray ray{{-distance, impact, 0}, {1, 0, 0}};
      INFO("distance " << distance << ", impact " << impact);
      CHECK(ours(ray, {vec3(0.0f), 1.0f}).has_value() == (impact <= 1.0f));
      if (book(ray, {vec3(0.0f), 1.0f}).has_value() != (impact <= 1.0f)) ++wrong_by_book;
    }
  }
  CHECK(wrong_by_book > 500);
}

TEST_CASE("the ground sphere is hit at the right distance whatever its radius", "[stability]") {
  double worst_of_book = 0.0;
  for (const float radius : {1e3f, 1e4f, 1e5f, 1e6f, 1e7f}) {
    const Sphere ground{{0, -radius, 0}, radius};
    for (int degrees = 10; degrees <= 90; degrees += 5) {
      const double angle = degrees * 3.14159265358979 / 180.0;
      const Ray ray{{0, 1, 0}, {static_cast<float>(std::cos(angle)), static_cast<float>(-std::sin(angle)), 0}};
      // Of the float ray, in long double: t² a - 2 b t + c = 0.
      const long double dx = ray.direction.x, dy = ray.direction.y, r = radius;
      const long double a = dx * dx + dy * dy, b = -dy * (r + 1), c = 2 * r + 1;
      const auto exact = static_cast<double>(c / (b + std::sqrt(b * b - a * c)));
      const auto found = ours(ray, ground);
      REQUIRE(found);
      CHECK(std::abs(*found - exact) <= 1e-6 * exact);
      const auto naive = book(ray, ground);
      worst_of_book = std::max(worst_of_book, naive ? std::abs(*naive - exact) / exact : 1.0);
    }
  }
  CHECK(worst_of_book > 0.05);
}

TEST_CASE("tiny spheres have two ordered roots", "[stability]") {
  const FlushDenormals flush;
  int wrong_by_book = 0;
  for (float radius = 1e-4f; radius > 1e-37f; radius *= 0.1f) {
    const Sphere sphere{vec3(0.0f), radius};
    INFO("radius " << radius);
    for (const float distance : {3.0f * radius, 100.0f * radius}) {
      const auto roots = sphere_roots({{0, 0, -distance}, {0, 0, 1}}, sphere);
      REQUIRE(roots);
      CHECK(roots->first <= roots->second);
      CHECK(roots->first == Approx(distance - radius).epsilon(2 * FLT_EPSILON));
      CHECK(roots->second == Approx(distance + radius).epsilon(2 * FLT_EPSILON));
      const auto naive = book({{0, 0, -distance}, {0, 0, 1}}, sphere);
      if (!naive || std::abs(*naive - roots->first) > 0.1f * radius) ++wrong_by_book;
    }
  }
  CHECK(wrong_by_book > 10);  // from where the square of the radius is no float any more
}

TEST_CASE("a sphere is hit alike with directions of any length", "[stability]") {
  const FlushDenormals flush;
  const Sphere sphere{{0.5f, 0.25f, 4.0f}, 1.0f};
  const float expected = *ours({vec3(0.0f), {0.1f, 0.1f, 1.0f}}, sphere);
  for (int k = -120; k <= 120; ++k) {
    const float length = std::ldexp(1.0f, k);
    const auto found = ours({vec3(0.0f), vec3(0.1f, 0.1f, 1.0f) * length}, sphere);
    REQUIRE(found);
    CHECK(*found * length == expected);
  }
  const auto naive = book({vec3(0.0f), vec3(0.1f, 0.1f, 1.0f) * 1e-25f}, sphere);
  CHECK((!naive || std::abs(*naive * 1e-25f - expected) > 0.01f));
}

TEST_CASE("the bounds of a sphere hold all of it, and a sphere far out is hit within them", "[stability]") {
  const Sphere far{{1e7f, -1e7f, 1e7f}, 1.0f};
  const Bounds b = sphere_bounds(far);
  for (int axis = 0; axis < 3; ++axis) {
    CHECK(static_cast<double>(b.lower[axis]) <= static_cast<double>(far.center[axis]) - 1.0);
    CHECK(static_cast<double>(b.upper[axis]) >= static_cast<double>(far.center[axis]) + 1.0);
  }
  CHECK(ours({{1e7f, -1e7f, 1e7f - 10.0f}, {0, 0, 1}}, far) == 9.0f);
  CHECK_FALSE(ours({{1e7f + 2.0f, -1e7f, 1e7f - 10.0f}, {0, 0, 1}}, far));
}
