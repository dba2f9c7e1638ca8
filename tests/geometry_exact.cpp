// Exact decisions: cases worked out by hand, and balls and integers against rational arithmetic.
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>

#include "catch.hpp"
#include "raylab/core/parallel.hpp"
#include "raylab/geometry/exact.hpp"
#include "raylab/measure/ray_sets.hpp"

using namespace raylab;

namespace {

using Rational = boost::multiprecision::cpp_rational;
constexpr float kTiny = std::numeric_limits<float>::min();

Geometry of_triangle(const vec3& a, const vec3& b, const vec3& c) {
  return {{TriangleMesh{{a, b, c}, {{0, 1, 2}}, {}, {}, {}, {}}}, {}};
}
Geometry of_spheres(std::vector<Sphere> spheres) { return {{}, std::move(spheres)}; }

/// The answer for primitive 0 of geometry 0, the same both ways.
std::optional<Hit> hit_of(const Geometry& geometry, const Ray& ray) {
  std::array<std::optional<Hit>, 2> hits;
  for (const auto arithmetic : {ExactTest::Arithmetic::adaptive, ExactTest::Arithmetic::integers}) {
    const ExactTest test(geometry, ray, arithmetic);
    const auto crossing = test({0, 0});
    if (crossing) hits[static_cast<std::size_t>(arithmetic)] = test.to_hit(*crossing);
  }
  REQUIRE(hits[0] == hits[1]);
  return hits[0];
}

struct RationalHit {
  Rational t, u, v;
};

/// Möller and Trumbore's formulas without rounding: another way to the answer than the volumes of ExactTest.
std::optional<RationalHit> rational_hit(const Ray& ray, const Triangle& tri) {
  using Vector = std::array<Rational, 3>;
  const auto vector = [](const vec3& v) { return Vector{Rational(v.x), Rational(v.y), Rational(v.z)}; };
  const auto minus = [](const Vector& a, const Vector& b) { return Vector{a[0] - b[0], a[1] - b[1], a[2] - b[2]}; };
  const auto cross = [](const Vector& a, const Vector& b) {
    return Vector{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  };
  const auto dot = [](const Vector& a, const Vector& b) -> Rational { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
  const Vector d = vector(ray.direction), p0 = vector(tri.p0);
  const Vector e1 = minus(vector(tri.p1), p0), e2 = minus(vector(tri.p2), p0), s = minus(vector(ray.origin), p0);
  const Vector p = cross(d, e2), q = cross(s, e1);
  const Rational det = dot(e1, p);
  if (det == 0) return std::nullopt;
  const RationalHit hit{dot(e2, q) / det, dot(s, p) / det, dot(d, q) / det};
  if (hit.u < 0 || hit.v < 0 || hit.u + hit.v > 1) return std::nullopt;
  if (hit.t <= Rational(ray.t_min) || hit.t < Rational(kTiny)) return std::nullopt;
  if (hit.t > Rational(std::numeric_limits<float>::max())) return std::nullopt;
  if (ray.t_max < kInfinity && hit.t >= Rational(ray.t_max)) return std::nullopt;
  return hit;
}

/// Whether no float is nearer to x.
bool is_nearest(float f, const Rational& x) {
  const auto distance = [&](float g) { return Rational(abs(Rational(g) - x)); };
  return distance(f) <= distance(next_float_up(f)) && distance(f) <= distance(next_float_down(f));
}

/// Triangles and rays that floats cannot tell: aimed at vertices, at points of edges and inside, on a coarse grid
/// or at full precision, thin, far out, and with components that are 0, -0 or tiny.
struct Awkward {
  Triangle triangle;
  Ray ray;
};
Awkward awkward(UniformFloats& uniform, int kind) {
  const bool grid = kind % 2 == 0;
  const float scales[] = {1.0f, 1e-12f, 1e10f, 0x1p-30f, 1e17f};
  const float scale = scales[kind / 2 % 5];
  const vec3 offset = kind / 10 % 3 == 1 ? scale * vec3(1e5f, -2e5f, 3e4f) : vec3(0.0f);
  const auto point = [&] {
    vec3 p = uniform.in_box(vec3(-4.0f), vec3(4.0f));
    if (grid) p = glm::round(p);
    return scale * p + offset;
  };
  Awkward a{{point(), point(), point()}, {point(), vec3(0.0f)}};
  Triangle& t = a.triangle;
  if (kind % 7 == 3) t.p2 = t.p0 + (t.p1 - t.p0) * 0.75f + vec3(0, scale * 1e-6f, 0);  // a needle
  vec3 target = point();
  switch (uniform.below(4)) {
    case 0:
      target = t.p1;
      break;
    case 1:
      target = t.p0 + 0.5f * (t.p2 - t.p0);
      break;
    case 2:
      target = (t.p0 + t.p1 + t.p2) / 3.0f;
      break;
    default:
      break;
  }
  a.ray.direction = target - a.ray.origin;
  if (kind % 11 == 5) {
    const float odd[] = {0.0f, -0.0f, 1e-40f, -1e-30f};
    a.ray.direction[static_cast<int>(uniform.below(3))] = odd[uniform.below(4)];
  }
  if (a.ray.direction == vec3(0.0f)) a.ray.direction.z = scale;
  return a;
}

}  // namespace

TEST_CASE("exactly: edges and vertices belong to a triangle, the next float beyond does not", "[unit]") {
  const Geometry geometry = of_triangle({0, 0, 1}, {1, 0, 1}, {0, 1, 1});
  const auto hit = [&](float x, float y) { return hit_of(geometry, {{x, y, 0}, {0, 0, 1}}); };
  for (const auto& [x, y] : {std::pair(0.0f, 0.0f),
                             {1.0f, 0.0f},
                             {0.0f, 1.0f},
                             {0.25f, 0.0f},
                             {0.0f, 0.25f},
                             {0.75f, 0.25f},
                             {0.3f, 0.3f}}) {
    INFO(x << ", " << y);
    CHECK(hit(x, y) == Hit{1, x, y, 0, 0});
  }
  CHECK(hit(kTiny, 0.25f) == Hit{1, kTiny, 0.25f, 0, 0});
  CHECK_FALSE(hit(-kTiny, 0.25f));
  CHECK_FALSE(hit(0.25f, -kTiny));
  CHECK(hit(next_float_down(0.75f), 0.25f));
  CHECK_FALSE(hit(next_float_up(0.75f), 0.25f));
  CHECK_FALSE(hit(1.0f, kTiny));
}

TEST_CASE("exactly: the same with a slanting ray, whose numbers are not round", "[unit]") {
  // From p through the middle of an edge: both ends of the direction are known without rounding.
  const Geometry geometry = of_triangle({-3, 1, 2}, {5, 3, 2}, {0, 9, 7});
  const vec3 middle{1, 2, 2};
  const vec3 direction{0.1f, -0.7f, 0.3f};
  const auto from = [&](float lift) {
    vec3 p = middle - 4.0f * direction;  // 4: a power of two, so only the difference rounds
    p.y += lift;
    return p;
  };
  const vec3 exact_direction = 0.25f * (middle - from(0.0f));
  const auto on_edge = hit_of(geometry, {from(0.0f), exact_direction});
  REQUIRE(on_edge);
  CHECK(on_edge->t == 4.0f);
  CHECK(on_edge->u == 0.5f);
  CHECK(on_edge->v == 0.0f);
  const float ulp = next_float_up(from(0.0f).y) - from(0.0f).y;
  CHECK(hit_of(geometry, {from(ulp), exact_direction}).has_value() !=
        hit_of(geometry, {from(-ulp), exact_direction}).has_value());
}

TEST_CASE("exactly: triangles without area, and those along the ray, are not met", "[unit]") {
  const Ray along_z{{0.25f, 0.25f, 0}, {0, 0, 1}};
  CHECK_FALSE(hit_of(of_triangle({0, 0, 1}, {1, 1, 1}, {0.25f, 0.25f, 1}), along_z));
  CHECK_FALSE(hit_of(of_triangle({0.25f, 0.25f, 1}, {0.25f, 0.25f, 1}, {0, 1, 1}), along_z));
  CHECK_FALSE(hit_of(of_triangle({0.25f, 0, 1}, {0.25f, 1, 1}, {0.25f, 0.5f, 3}), along_z));
  CHECK_FALSE(hit_of(of_triangle({0.25f, 0.25f, 1}, {0.25f, 0.25f, 2}, {0, 1, 1}), along_z));
}

TEST_CASE("exactly: the ends of the interval are open, and compared with t before it is rounded", "[unit]") {
  const Geometry geometry = of_triangle({-9, -9, 1}, {9, -9, 1}, {0, 9, 1});
  const auto hit = [&](float speed, float t_min, float t_max) {
    return hit_of(geometry, {{0, 0, 0}, {0, 0, speed}, t_min, t_max});
  };
  CHECK_FALSE(hit(0.5f, 0, 2));
  CHECK_FALSE(hit(0.5f, 2, kInfinity));
  CHECK(hit(0.5f, 0, next_float_up(2.0f))->t == 2.0f);
  CHECK(hit(0.5f, next_float_down(2.0f), 3)->t == 2.0f);
  const float third = 1.0f / 3.0f;  // above 1/3
  REQUIRE(3.0 * static_cast<double>(third) > 1.0);
  CHECK(hit(3, 0, 1)->t == third);
  CHECK(hit(3, 0, third)->t == next_float_down(third));
  CHECK_FALSE(hit(3, third, 1));
  CHECK(hit(3, next_float_down(third), 1)->t == third);
  CHECK_FALSE(hit(3, next_float_down(third), third));  // 1/3 lies between, but no float
  CHECK_FALSE(hit(3, 0, next_float_down(third)));
  CHECK_FALSE(hit(-1, 0, kInfinity));
  CHECK_FALSE(hit(3, 1, 0));
}

TEST_CASE("exactly: denormals count as zero, in coordinates, directions and t", "[unit]") {
  const Geometry geometry = of_triangle({0, 0, 1}, {1, 0, 1}, {0, 1, 1});
  const float denormal = 1e-40f;
  const auto both_ways = [&](const Ray& ray) {
    const auto plain = hit_of(geometry, ray);
    const FlushDenormals flush;
    CHECK(hit_of(geometry, ray) == plain);
    return plain;
  };
  CHECK(both_ways({{-denormal, 0.25f, 0}, {0, 0, 1}}));
  CHECK(both_ways({{0, 0.25f, 0}, {-denormal, 0, 1}}) == Hit{1, 0, 0.25f, 0, 0});
  CHECK_FALSE(both_ways({{0.1f, 0.25f, 0}, {0, 0, denormal}}));
  const Geometry near = of_triangle({-1, -1, kTiny}, {1, -1, kTiny}, {0, 1, kTiny});
  CHECK(hit_of(near, {vec3(0.0f), {0, 0, 1}})->t == kTiny);
  CHECK_FALSE(hit_of(near, {vec3(0.0f), {0, 0, 2}}));
}

TEST_CASE("exactly: a line that touches a sphere meets it, the next float beyond does not", "[unit]") {
  const Geometry geometry = of_spheres({{{0, 0, 0}, 5}});
  const auto hit = [&](float x, float y, float z, float t_min = 0) {
    return hit_of(geometry, {{x, y, z}, {0, 0, 1}, t_min});
  };
  CHECK(hit(5, 0, -10)->t == 10.0f);
  CHECK(hit(3, 4, -10)->t == 10.0f);  // 3² + 4² = 5²
  CHECK_FALSE(hit(next_float_up(3.0f), 4, -10));
  CHECK_FALSE(hit(5, kTiny, -10));
  REQUIRE(hit(next_float_down(3.0f), 4, -10));
  CHECK(hit(next_float_down(3.0f), 4, -10)->t < 10.0f);
  // Its two roots are irrational, and so close that one float lies between them and 10.
  CHECK(hit(next_float_down(3.0f), 4, -10, 10.0f)->t > 10.0f);
  CHECK(hit(0, 0, 0)->t == 5.0f);
  CHECK(hit(0, 0, -5)->t == 10.0f);  // starts on it: the root 0 is not in the interval
  CHECK_FALSE(hit(0, 0, 5));
  CHECK(hit(3, 0, -10)->t == 6.0f);
}

TEST_CASE("exactly: the nearer of spheres and triangles is told where their distances differ in no float", "[unit]") {
  // The sphere is met at z = -√0.75, the triangle at the float above or below.
  const float below = -std::sqrt(0.75f);
  const bool is_below = static_cast<double>(below) * static_cast<double>(below) > 0.75;
  for (const bool triangle_first : {true, false}) {
    const float z = triangle_first == is_below ? below : triangle_first ? next_float_down(below) : next_float_up(below);
    Geometry geometry = of_triangle({-9, -9, z}, {9, -9, z}, {0, 9, z});
    geometry.spheres = {{{0, 0, 0}, 1}};
    for (const auto arithmetic : {ExactTest::Arithmetic::adaptive, ExactTest::Arithmetic::integers}) {
      const ExactTest test(geometry, {{0.5f, 0, -4}, {0, 0, 1}}, arithmetic);
      const auto triangle = test({0, 0}), sphere = test({1, 0});
      REQUIRE((triangle && sphere));
      CHECK(test.before(*triangle, *sphere) == triangle_first);
      CHECK(test.before(*sphere, *triangle) != triangle_first);
    }
  }
  // The triangle touches the sphere at z = -1: the smaller id comes first. So with equal spheres.
  Geometry touching = of_triangle({-9, -9, -1}, {9, -9, -1}, {0, 9, -1});
  touching.spheres = {{{0, 0, 0}, 1}, {{0, 0, 0}, 1}, {{0, 0, 0.5f}, next_float_up(1.5f)}, {{0, 0, 0.5f}, 1.5f}};
  const ExactTest test(touching, {{0, 0, -4}, {0, 0, 1}});
  CHECK(test.before(*test({0, 0}), *test({1, 0})));
  CHECK_FALSE(test.before(*test({1, 0}), *test({0, 0})));
  CHECK(test.before(*test({1, 0}), *test({1, 1})));
  CHECK(test.before(*test({1, 1}), *test({1, 3})));
  CHECK(test.before(*test({1, 2}), *test({0, 0})));
  const ExactTest aside(touching, {{0.7f, 0.1f, -4}, {0, 0, 1}});
  CHECK(aside.before(*aside({1, 0}), *aside({1, 1})));
  CHECK_FALSE(aside.before(*aside({1, 1}), *aside({1, 0})));
}

TEST_CASE("balls never contradict integers, nor either of them rational arithmetic", "[agreement]") {
  UniformFloats uniform(1);
  int hits = 0, on_outline = 0;
  for (int i = 0; i < 30'000; ++i) {
    const auto [t, ray] = awkward(uniform, i % 2310);
    INFO("case " << i);
    const auto hit = hit_of(of_triangle(t.p0, t.p1, t.p2), ray);
    hits += hit.has_value();
    on_outline += hit && (hit->u == 0.0f || hit->v == 0.0f);
    if (i % 5 != 0 || std::abs(ray.direction.x) == 1e-40f || std::abs(ray.direction.y) == 1e-40f ||
        std::abs(ray.direction.z) == 1e-40f) {
      continue;
    }
    const auto expected = rational_hit(ray, t);
    REQUIRE(hit.has_value() == expected.has_value());
    if (!hit) continue;
    CHECK(is_nearest(hit->t, expected->t));
    CHECK((is_nearest(hit->u, expected->u) || expected->u < Rational(kTiny)));
    CHECK((is_nearest(hit->v, expected->v) || expected->v < Rational(kTiny)));
  }
  CHECK(hits > 5'000);
  CHECK(on_outline > 1'000);
}

TEST_CASE("balls never contradict integers on spheres, nor in the order of hits", "[agreement]") {
  UniformFloats uniform(2);
  int hits = 0, ordered = 0;
  for (int i = 0; i < 10'000; ++i) {
    const float scale = std::ldexp(1.0f, 10 * (i % 9) - 40);
    const auto point = [&] { return scale * glm::round(uniform.in_box(vec3(-6.0f), vec3(6.0f))); };
    Geometry geometry{{TriangleMesh{{point(), point(), point()}, {{0, 1, 2}}, {}, {}, {}, {}}}, {}};
    for (int k = 0; k < 4; ++k) geometry.spheres.push_back({point(), scale * std::ceil(uniform(0.1f, 9.0f))});
    if (i % 3 == 0) geometry.spheres[1].radius *= 1e6f;
    const Ray ray{point(), i % 2 == 0 ? glm::round(uniform.in_box(vec3(-2), vec3(2))) + vec3(0, 0, 0.5f)
                                      : uniform.in_box(vec3(-1), vec3(1))};
    const ExactTest balls(geometry, ray);
    const ExactTest integers(geometry, ray, ExactTest::Arithmetic::integers);
    const PrimitiveId ids[] = {{0, 0}, {1, 0}, {1, 1}, {1, 2}, {1, 3}};
    std::vector<Crossing> crossings;
    for (const PrimitiveId& id : ids) {
      const auto a = balls(id), b = integers(id);
      INFO("case " << i << ", primitive " << id.primitive);
      REQUIRE(a.has_value() == b.has_value());
      if (!a) continue;
      ++hits;
      REQUIRE(a->root == b->root);
      REQUIRE(std::abs(a->t - b->t) <= a->error + b->error);
      REQUIRE(balls.to_hit(*a) == integers.to_hit(*b));
      crossings.push_back(*a);
    }
    for (const Crossing& a : crossings) {
      for (const Crossing& b : crossings) {
        ++ordered;
        REQUIRE(balls.before(a, b) == integers.before(a, b));
        REQUIRE((a.id == b.id || balls.before(a, b) != balls.before(b, a)));
      }
    }
  }
  CHECK(hits > 10'000);
  CHECK(ordered > 20'000);
}

TEST_CASE("exactly: floats of the whole range fit the integers", "[unit]") {
  // An origin as far as a float goes, the largest coordinates, and the smallest beside them.
  const float far = std::numeric_limits<float>::max();
  Geometry geometry = of_triangle({-kLargestCoordinate, -kLargestCoordinate, kTiny},
                                  {kLargestCoordinate, -kLargestCoordinate, kTiny}, {kTiny, kLargestCoordinate, kTiny});
  geometry.spheres = {{{0, kTiny, 0}, kLargestCoordinate}, {{kTiny, 0, 0}, kTiny}, {{0, 0, 3}, 1}};
  for (const vec3& direction : {vec3(0, 0, -far), vec3(0, 0, -1), vec3(kTiny, -kTiny, -far)}) {
    const Ray ray{{0, 0, far}, direction};
    const ExactTest balls(geometry, ray);
    const ExactTest integers(geometry, ray, ExactTest::Arithmetic::integers);
    for (const PrimitiveId& a : {PrimitiveId{0, 0}, {1, 0}, {1, 1}, {1, 2}}) {
      REQUIRE(balls(a).has_value() == integers(a).has_value());
      for (const PrimitiveId& b : {PrimitiveId{0, 0}, {1, 0}, {1, 1}, {1, 2}}) {
        if (!integers(a) || !integers(b)) continue;
        CHECK(balls.before(*balls(a), *balls(b)) == integers.before(*integers(a), *integers(b)));
      }
    }
  }
}
