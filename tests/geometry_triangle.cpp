// The triangle tests against analytic values, where floats run out.
#include <cfloat>

#include "catch.hpp"
#include "geometry/primitive_test.hpp"
#include "raylab/core/parallel.hpp"
#include "raylab/measure/ray_sets.hpp"

using namespace raylab;

namespace {

constexpr float kUlp = FLT_EPSILON;

template <Intersector kind>
std::optional<TriangleHit> hit(const Ray& ray, const Triangle& triangle) {
  return PrimitiveTest<kind>(ray).triangle(triangle, ray.t_min, ray.t_max);
}

std::optional<TriangleHit> watertight(const Ray& ray, const Triangle& t) {
  return hit<Intersector::watertight>(ray, t);
}
std::optional<TriangleHit> book(const Ray& ray, const Triangle& t) { return hit<Intersector::book>(ray, t); }

/// Right-angled at the origin, with legs of length s along x and y.
Triangle right_angled(float s) { return {{0, 0, 0}, {s, 0, 0}, {0, s, 0}}; }

}  // namespace

TEST_CASE("every triangle test finds t, u and v of a plain hit", "[unit]") {
  const Triangle triangle{{1, 1, 5}, {3, 1, 5}, {1, 4, 8}};
  const float u = 0.25f;
  const float v = 0.5f;
  const vec3 point = (1 - u - v) * triangle.p0 + u * triangle.p1 + v * triangle.p2;
  const Ray ray{{0, 0, 0}, point / 4.0f};
  for (const auto& found : {book(ray, triangle), hit<Intersector::fast>(ray, triangle), watertight(ray, triangle)}) {
    REQUIRE(found);
    CHECK(found->t == Approx(4.0f).epsilon(4 * kUlp));
    CHECK(found->u == Approx(u).margin(4 * kUlp));
    CHECK(found->v == Approx(v).margin(4 * kUlp));
  }
}

TEST_CASE("a triangle is hit from both sides and in the open interval only", "[unit]") {
  const Triangle triangle = right_angled(1);
  for (const float side : {-1.0f, 1.0f}) {
    Ray ray{{0.25f, 0.25f, 2 * side}, {0, 0, -side}};
    REQUIRE(watertight(ray, triangle));
    CHECK(watertight(ray, triangle)->t == 2.0f);
    ray.t_max = 2.0f;
    CHECK_FALSE(watertight(ray, triangle));
    ray.t_max = next_float_up(2.0f);
    CHECK(watertight(ray, triangle));
    ray.t_min = 2.0f;
    CHECK_FALSE(watertight(ray, triangle));
    ray.t_min = next_float_down(2.0f);
    CHECK(watertight(ray, triangle));
  }
}

TEST_CASE("watertight hits triangles of any size, where the book's epsilon loses them", "[stability]") {
  const FlushDenormals flush;
  std::size_t lost_by_book = 0;
  // FLT_MIN over 3 is where coordinates themselves end; above 1e18 primitives are not valid.
  for (float s = 1e18f; s > 1e-36f; s *= 0.1f) {
    const Ray ray{{s / 3, s / 3, -1}, {0, 0, 1}};
    const auto found = watertight(ray, right_angled(s));
    INFO("legs of " << s);
    REQUIRE(found);
    CHECK(found->t == 1.0f);
    CHECK(found->u == Approx(1.0f / 3).margin(4 * kUlp));
    CHECK(found->v == Approx(1.0f / 3).margin(4 * kUlp));
    if (s <= 1.0f && !book(ray, right_angled(s))) ++lost_by_book;
  }
  CHECK(lost_by_book > 20);  // all below 1e-4, whose determinant is below 1e-8
}

TEST_CASE("watertight finds no hit beyond a triangle along which the ray runs up to rounding", "[stability]") {
  // Of the bunny: the ray goes to the last corner, 4e-9 past it, and meets the plane at t = 1.004.
  const Triangle edge_on{{-0x1.4874ap-1f, 0x1.4f7bd4p-3f, -0x1.290802p-2f},
                         {-0x1.d41458p-1f, 0x1.6c91fap-4f, -0x1.b163aep-2f},
                         {-0x1.bb3368p-1f, 0x1.5562bep-5f, -0x1.62058ap-1f}};
  const Ray ray{{-0x1.83b624p-1f, 0x1.001ccep-3f, -0x1.85724ep-2f}, {-0x1.bbea2p-4f, -0x1.55883cp-4f, -0x1.3e98c6p-2f}};
  const auto hit = intersect_triangle(Intersector::watertight, ray, edge_on, 0.0f, kInfinity);
  REQUIRE(hit.has_value());
  CHECK(std::abs(hit->t - 1.0f) <= 0x1p-22f);
}

TEST_CASE("watertight gives one hit and t · length for directions of any length", "[stability]") {
  const FlushDenormals flush;
  std::size_t lost_by_book = 0;
  for (int k = -120; k <= 120; ++k) {
    const float length = std::ldexp(1.0f, k);
    const Ray ray{{0.25f, 0.3f, -2.0f}, vec3(0.1f, 0.05f, 1.0f) * length};
    const auto found = watertight(ray, right_angled(1));
    INFO("direction of length 2^" << k);
    REQUIRE(found);
    CHECK(found->t * length == 2.0f);
    if (std::abs(k) <= 30 && !book(ray, right_angled(1))) ++lost_by_book;
  }
  CHECK(lost_by_book > 0);
}

TEST_CASE("a ray along an axis has the analytic t whatever the signs of its zeros", "[stability]") {
  for (int axis = 0; axis < 3; ++axis) {
    for (int signs = 0; signs < 8; ++signs) {
      vec3 direction(signs & 1 ? -0.0f : 0.0f, signs & 2 ? -0.0f : 0.0f, signs & 4 ? -0.0f : 0.0f);
      direction[axis] = signs & (1 << axis) ? -1.0f : 1.0f;
      // A triangle across the axis at distance 3, the ray through its inside.
      Triangle triangle{};
      for (int k = 0; k < 3; ++k) triangle.p0[k] = k == axis ? 3.0f * direction[axis] : -1.0f;
      triangle.p1 = triangle.p2 = triangle.p0;
      triangle.p1[(axis + 1) % 3] = 4.0f;
      triangle.p2[(axis + 2) % 3] = 4.0f;
      const auto found = watertight({vec3(0.0f), direction}, triangle);
      REQUIRE(found);
      CHECK(found->t == 3.0f);
    }
  }
}

TEST_CASE("direction components too small to matter count as zero", "[stability]") {
  const FlushDenormals flush;
  for (const float tiny : {1e-19f, 1e-25f, 1e-37f, 1e-40f, 1e-45f}) {
    for (const float sign : {-1.0f, 1.0f}) {
      const auto found = watertight({{0.25f, 0.25f, -3}, {sign * tiny, -sign * tiny, 1}}, right_angled(1));
      REQUIRE(found);
      CHECK(found->t == 3.0f);
    }
  }
}

TEST_CASE("a ray through a shared edge or vertex hits at least one of the triangles that meet there", "[stability]") {
  const FlushDenormals flush;
  // A fan of four triangles around a centre, in a slanted plane; 1e-19: areas are no floats any more.
  for (const float scale : {1.0f, 1e-6f, 1e-12f, 1e-19f, 1e12f}) {
    const vec3 center = scale * vec3(0.1f, 0.2f, 0.7f);
    const vec3 rim[4] = {scale * vec3(1, 0.1f, 1), scale * vec3(0, 1, 0.9f), scale * vec3(-1, 0, 0.3f),
                         scale * vec3(0.2f, -1, 0.4f)};
    std::size_t misses_of_book = 0;
    for (int i = 0; i < 4000; ++i) {
      const vec3 toward = center + static_cast<float>(i % 100) / 128.0f * (rim[i / 1000] - center);
      const vec3 origin = scale * vec3(0.003f * static_cast<float>(i % 17), 0.002f * static_cast<float>(i % 23), -1);
      const Ray ray{origin, toward - origin};
      int hits = 0, hits_of_book = 0;
      for (int k = 0; k < 4; ++k) {
        const Triangle triangle{center, rim[k], rim[(k + 1) % 4]};
        hits += watertight(ray, triangle).has_value();
        hits_of_book += book(ray, triangle).has_value();
      }
      REQUIRE(hits > 0);
      misses_of_book += hits_of_book == 0;
    }
    CHECK(misses_of_book > 0);
  }
}

TEST_CASE("a long thin triangle nearly along the ray is not hit outside its box", "[stability]") {
  // Half a degree off the ray, 1e4 long and 1e-3 wide.
  const float slope = std::tan(0.5f * kPi / 180.0f);
  const Triangle sliver{{0, 0, 0}, {1e4f, 0, 1e4f * slope}, {1e4f, 1e-3f, 1e4f * slope}};
  for (int i = 1; i < 1000; ++i) {
    const float x = 10.0f * static_cast<float>(i);
    const Ray ray{{x - 100.0f, 5e-8f * x, (x - 100.0f) * slope + 100.0f * slope}, {1, 0, 0}};
    if (const auto found = watertight(ray, sliver)) {
      const float hit_x = ray.at(found->t).x;
      CHECK(hit_x > -0.1f);
      CHECK(hit_x < 1e4f + 0.1f);
    }
  }
}

TEST_CASE("the distance of a hit is within 8 ulp, however steeply the triangle stands against the ray", "[unit]") {
  // Seen from the origin down the x axis, through its middle, off which it leans by less and less.
  UniformFloats random(17);
  int hits = 0;
  for (int i = 0; i < 100'000; ++i) {
    const float lean = std::exp2(random(-12.0f, 0.0f));
    const vec3 middle{random(1.0f, 2.0f), random(-1.0f, 1.0f), random(-1.0f, 1.0f)};
    const vec3 along{random(0.1f, 0.2f), lean * random(-0.1f, 0.1f), lean * random(-0.1f, 0.1f)};
    const vec3 across{0.0f, random(0.01f, 0.1f), random(0.01f, 0.1f)};
    const Triangle triangle{middle - along - across, middle + along - across, middle + across};
    const Ray ray{vec3(0.0f), middle + 0.3f * random(-1.0f, 1.0f) * across};
    const auto found = watertight(ray, triangle);
    if (!found) continue;
    ++hits;
    const dvec3 n = glm::cross(dvec3(triangle.p1) - dvec3(triangle.p0), dvec3(triangle.p2) - dvec3(triangle.p0));
    const double t = glm::dot(dvec3(triangle.p0), n) / glm::dot(dvec3(ray.direction), n);
    CAPTURE(i);
    REQUIRE(std::abs(static_cast<double>(found->t) - t) <= 8.0 * static_cast<double>(kUlp) * t / 2.0);
  }
  CHECK(hits > 50'000);
}

TEST_CASE("degenerate triangles are never hit", "[unit]") {
  const vec3 p(0.5f, 0.25f, 3.0f);
  for (const Triangle& t :
       {Triangle{p, p, p}, Triangle{p, p, {1, 1, 3}}, Triangle{p, p + vec3(1, 0, 0), p + vec3(2, 0, 0)}}) {
    CHECK_FALSE(watertight({vec3(0.0f), p}, t));
    CHECK_FALSE(watertight({p - vec3(0, 0, 1), {0, 0, 1}}, t));
  }
}
