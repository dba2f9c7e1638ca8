// The comparison itself: it must find faults that are planted, and excuse what floats cannot decide.
#include "catch.hpp"
#include "changed_answers.hpp"
#include "raylab/measure/agreement.hpp"
#include "raylab/measure/ray_sets.hpp"
#include "raylab/measure/shapes.hpp"

using namespace raylab;
using raylab::test::ChangedAnswers;

namespace {

/// One triangle across the z axis at z = 4.
Geometry one_triangle() {
  return {{TriangleMesh{{{-1, -1, 4}, {3, -1, 4}, {-1, 3, 4}}, {{0, 1, 2}}, {}, {}, {}, {}}}, {}};
}

const Ray kThrough{{0, 0, 0}, {0, 0, 1}};
const Ray kPast{{-2, 0, 0}, {0, 0, 1}};

}  // namespace

TEST_CASE("planted misses, hits, wrong distances and wrong occlusion are each found and shown", "[unit]") {
  const Geometry geometry = one_triangle();
  const auto judge = make_accelerator("list", geometry);
  const std::vector<Ray> rays = {kPast, kThrough, kThrough};

  const auto miss = [](const Ray&, const std::optional<Hit>&) { return std::optional<Hit>(); };
  AgreementReport report = compare_hits(ChangedAnswers(*judge, miss), *judge, geometry, rays);
  CHECK(report.false_misses.count == 2);
  CHECK(report.false_hits.count + report.wrong_primitives.count + report.occlusion.count == 0);
  CHECK(report.hits == 2);
  CHECK(report.false_misses.first->ray.origin == kThrough.origin);

  const auto hit = [](const Ray&, const std::optional<Hit>&) { return std::optional(Hit{4, 0, 0, 0, 0}); };
  report = compare_hits(ChangedAnswers(*judge, hit), *judge, geometry, rays);
  CHECK(report.false_hits.count == 1);
  CHECK(report.false_misses.count + report.wrong_primitives.count == 0);

  const auto shift = [](int ulps) {
    return [ulps](const Ray&, std::optional<Hit> h) {
      for (int i = 0; h && i < ulps; ++i) h->t = next_float_up(h->t);
      return h;
    };
  };
  report = compare_hits(ChangedAnswers(*judge, shift(9)), *judge, geometry, rays);
  CHECK(report.wrong_primitives.count == 2);
  CHECK(report.t_error_ulp.max == 9.0);
  report = compare_hits(ChangedAnswers(*judge, shift(8)), *judge, geometry, rays);
  CHECK(report.agrees());
  CHECK(report.t_error_ulp.p50 == 8.0);

  const auto rename = [](const Ray&, std::optional<Hit> h) {
    if (h) h->geometry = 1;  // the spheres, of which there are none
    return h;
  };
  report = compare_hits(ChangedAnswers(*judge, rename), *judge, geometry, rays);
  CHECK(report.wrong_primitives.count == 2);

  const auto truth = [](const Ray&, std::optional<Hit> h) { return h; };
  report = compare_hits(ChangedAnswers(*judge, truth, true), *judge, geometry, rays);
  CHECK(report.occlusion.count == 1);
  CHECK_FALSE(report.agrees());
  CHECK(compare_hits(*judge, *judge, geometry, rays).agrees());
}

TEST_CASE("of two triangles that coincide either may be named, but no third", "[unit]") {
  Geometry geometry = one_triangle();
  geometry.meshes[0].triangles = {{0, 1, 2}, {0, 1, 2}, {3, 4, 5}};
  for (int k = 0; k < 3; ++k) geometry.meshes[0].positions.push_back(geometry.meshes[0].positions[k] + vec3(0, 0, 1));
  const auto judge = make_accelerator("list", geometry);
  for (const std::uint32_t named : {0u, 1u, 2u}) {
    const ChangedAnswers tested(*judge, [named](const Ray&, std::optional<Hit> h) {
      if (h) h->primitive = named;
      return h;
    });
    CHECK(compare_hits(tested, *judge, geometry, std::span(&kThrough, 1)).agrees() == (named != 2));
  }
}

TEST_CASE("what happens within 8 ulp of an outline or an end of the interval is undecided", "[unit]") {
  const Geometry geometry{one_triangle().meshes, {{{20, 0, 4}, 2}}};
  const auto judge = make_accelerator("list", geometry);
  const auto miss = [](const Ray&, const std::optional<Hit>&) { return std::optional<Hit>(); };
  const ChangedAnswers tested(*judge, miss);
  const auto undecided = [&](const Ray& ray) {
    REQUIRE(judge->intersect(ray));
    const AgreementReport report = compare_hits(tested, *judge, geometry, std::span(&ray, 1));
    CHECK(report.undecided + report.false_misses.count == 1);
    return report.undecided == 1;
  };
  // The largest coordinate is 4 for the triangle and 22 for the sphere.
  const float ulp4 = 0x1p-21f;
  const float ulp22 = 0x1p-19f;
  CHECK(undecided({{-1 + 7 * ulp4, 0, 0}, {0, 0, 1}}));
  CHECK_FALSE(undecided({{-1 + 9 * ulp4, 0, 0}, {0, 0, 1}}));
  CHECK(undecided({{22 - 7 * ulp22, 0, 0}, {0, 0, 1}}));
  CHECK_FALSE(undecided({{22 - 9 * ulp22, 0, 0}, {0, 0, 1}}));
  CHECK(undecided({{0, 0, 0}, {0, 0, 1}, 0, 4 + 7 * ulp4}));
  CHECK_FALSE(undecided({{0, 0, 0}, {0, 0, 1}, 0, 4 + 9 * ulp4}));
}

TEST_CASE("the distance to the outline is that of the line to edges and silhouettes", "[unit]") {
  const Geometry geometry{one_triangle().meshes, {{{20, 0, 4}, 2}}};
  CHECK(distance_to_outline(kThrough, geometry, {0, 0}) == Approx(1.0));
  CHECK(distance_to_outline(kPast, geometry, {0, 0}) == Approx(1.0));
  CHECK(distance_to_outline({{-4, -5, 0}, {0, 0, 1e-20f}}, geometry, {0, 0}) == Approx(5.0));
  CHECK(distance_to_outline({{21, 0, 0}, {0, 0, 1}}, geometry, {1, 0}) == Approx(1.0));
  CHECK(distance_to_outline({{25, 0, 0}, {0, 0, 1}}, geometry, {1, 0}) == Approx(3.0));
}

TEST_CASE("a disagreement is told with floats that replay it", "[unit]") {
  const std::string text = to_string(Disagreement{{{0.1f, 0, 0}, {0, 0, 1}}, std::nullopt, Hit{2, 0, 0, 3, 5}});
  CHECK(text.find("0x1.99999ap-4f") != std::string::npos);
  CHECK(text.find("tested hits nothing") != std::string::npos);
  CHECK(text.find("geometry 3, primitive 5") != std::string::npos);
}

TEST_CASE("ray sets are the same for the same seed, and do what they say", "[unit]") {
  const Bounds bounds{vec3(-1.0f), vec3(1.0f, 2.0f, 3.0f)};
  const auto same = [](const std::vector<Ray>& a, const std::vector<Ray>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const Ray& x, const Ray& y) { return x.origin == y.origin && x.direction == y.direction; });
  };
  CHECK(same(random_rays(bounds, 100, 1), random_rays(bounds, 100, 1)));
  CHECK_FALSE(same(random_rays(bounds, 100, 1), random_rays(bounds, 100, 2)));
  int negative_zeros = 0;
  for (const Ray& ray : axis_aligned_rays(bounds, 1000, 1)) {
    int zeros = 0;
    for (int k = 0; k < 3; ++k) {
      zeros += ray.direction[k] == 0.0f;
      negative_zeros += ray.direction[k] == 0.0f && std::signbit(ray.direction[k]);
    }
    CHECK(zeros == 2);
  }
  CHECK(negative_zeros > 900);
  CHECK(negative_zeros < 1100);

  const TriangleMesh ball = icosphere(vec3(1, 2, 3), 2.0f, 2);
  CHECK(ball.triangles.size() == 320);
  CHECK(ball.positions.size() == 162);  // Euler: shared, or there would be more
  for (const Ray& ray : rays_at_vertices(ball, vec3(1, 2, 3), 0.5f, 100, 1)) {
    CHECK(glm::length(ray.at(1.0f) - vec3(1, 2, 3)) == Approx(2.0f));
    CHECK(max_component(glm::abs(ray.origin - vec3(1, 2, 3))) <= 0.5f);
  }
}
