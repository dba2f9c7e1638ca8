// The judge must count planted errors to the last one, and nothing that floats cannot decide.
#include <array>

#include "catch.hpp"
#include "changed_answers.hpp"
#include "raylab/core/parallel.hpp"
#include "raylab/measure/judge.hpp"
#include "raylab/measure/ray_sets.hpp"
#include "raylab/measure/shapes.hpp"

using namespace raylab;
using raylab::test::ChangedAnswers;

namespace {

/// A closed ball, and rays from its centre through the middle of each triangle that meet it between t = 1 and 2.
/// Their t_max, which nothing reaches, tells them apart: 1000 and their number.
struct Bench {
  Geometry geometry{{icosphere(vec3(0.0f), 1.5f, 3)}, {}};
  std::unique_ptr<Accelerator> exact = make_accelerator("exact", geometry);
  std::vector<Ray> rays;

  Bench() {
    for (std::uint32_t i = 0; i < geometry.meshes[0].triangles.size(); ++i) {
      const Triangle t = triangle_corners(geometry.meshes[0], i);
      rays.push_back({vec3(0.0f), (t.p0 + t.p1 + t.p2) / 4.5f, 0.0f, 1000.0f + static_cast<float>(i)});
    }
  }

  HitErrors judge(ChangedAnswers::Change change, Surface surface = Surface::closed) const {
    return judge_hits(geometry, ChangedAnswers(*exact, std::move(change)), *exact, rays, surface);
  }
};

/// Changes the answers to one ray in `period`.
ChangedAnswers::Change one_in(int period, ChangedAnswers::Change change) {
  return [=](const Ray& ray, const std::optional<Hit>& hit) {
    return static_cast<int>(ray.t_max) % period == 0 ? change(ray, hit) : hit;
  };
}

const auto kDrop = [](const Ray&, const std::optional<Hit>&) { return std::optional<Hit>(); };

ChangedAnswers::Change shift(int ulps) {
  return [ulps](const Ray&, std::optional<Hit> hit) {
    for (int i = 0; hit && i < ulps; ++i) hit->t = next_float_up(hit->t);
    return hit;
  };
}

}  // namespace

TEST_CASE("an accelerator that errs nowhere is found to err nowhere", "[unit]") {
  const Bench bench;
  const HitErrors errors = bench.judge([](const Ray&, const auto& hit) { return hit; });
  CHECK(errors.rays_checked == 1280);
  CHECK(errors.hits == 1280);
  CHECK(errors.leaks.count + errors.false_misses.count + errors.false_hits.count == 0);
  CHECK(errors.wrong_primitives.count + errors.undecided == 0);
  CHECK(errors.t_error_ulp.max <= 0.5);  // what rounding t costs
  CHECK(errors.t_error_ulp.p50 > 0.1);
}

TEST_CASE("dropped rays are leaks and false misses, on an open surface false misses only", "[unit]") {
  const Bench bench;
  for (const int period : {1, 7, 64}) {
    const auto planted = static_cast<std::size_t>((2279 / period) - (999 / period));
    const HitErrors errors = bench.judge(one_in(period, kDrop));
    CHECK(errors.leaks.count == planted);
    CHECK(errors.false_misses.count == planted);
    CHECK(errors.false_hits.count + errors.wrong_primitives.count + errors.undecided == 0);
    CHECK(static_cast<int>(errors.leaks.first->ray.t_max) == (1000 + period - 1) / period * period);
    const HitErrors open = bench.judge(one_in(period, kDrop), Surface::open);
    CHECK(open.leaks.count == 0);
    CHECK(open.false_misses.count == planted);
  }
}

TEST_CASE("t shifted by 16 ulp, and another primitive named, are wrong primitives", "[unit]") {
  const Bench bench;
  HitErrors errors = bench.judge(one_in(10, shift(16)));
  CHECK(errors.wrong_primitives.count == 128);
  CHECK(errors.leaks.count + errors.false_misses.count + errors.false_hits.count + errors.undecided == 0);
  CHECK(errors.t_error_ulp.max > 15.4);
  CHECK(errors.t_error_ulp.max < 16.6);
  CHECK(errors.t_error_ulp.p99 > 15.4);
  CHECK(errors.t_error_ulp.p50 < 0.5);
  errors = bench.judge(one_in(10, shift(2)));
  CHECK(errors.wrong_primitives.count == 0);
  CHECK(errors.t_error_ulp.max > 1.4);

  errors = bench.judge(one_in(10, [](const Ray&, std::optional<Hit> hit) {
    hit->primitive = (hit->primitive + 640) % 1280;
    return hit;
  }));
  CHECK(errors.wrong_primitives.count == 128);
  CHECK(errors.leaks.count + errors.false_misses.count + errors.false_hits.count + errors.undecided == 0);
}

TEST_CASE("hits where there is nothing are false hits", "[unit]") {
  Bench bench;
  for (Ray& ray : bench.rays) ray.origin = 3.0f * ray.direction;
  const HitErrors errors = bench.judge(one_in(10, [](const Ray&, const std::optional<Hit>&) {
    return std::optional(Hit{1.0f, 0.2f, 0.2f, 0, 7});
  }));
  CHECK(errors.hits == 0);
  CHECK(errors.false_hits.count == 128);
  CHECK(errors.leaks.count + errors.false_misses.count + errors.wrong_primitives.count + errors.undecided == 0);
}

TEST_CASE("a ray let through the near wall of a closed surface to the far one is a leak", "[unit]") {
  Bench bench;
  for (Ray& ray : bench.rays) ray.origin = -3.0f * ray.direction;
  const auto through = [&](const Ray& ray, const std::optional<Hit>& hit) {
    Ray rest = ray;
    rest.t_min = hit->t * 1.01f;
    return bench.exact->intersect(rest);
  };
  const HitErrors errors = bench.judge(one_in(10, through));
  CHECK(errors.leaks.count == 128);
  CHECK(errors.false_misses.count + errors.false_hits.count == 0);
  CHECK(errors.wrong_primitives.count == 128);
}

TEST_CASE("rays lost at vertices are leaks, but at the vertices of a silhouette they are undecided", "[unit]") {
  Bench bench;
  bench.rays = rays_at_vertices(bench.geometry.meshes[0], vec3(0.0f), 0.5f, 1000, 1);
  HitErrors errors = bench.judge(kDrop);
  CHECK(errors.hits == 1000);
  CHECK(errors.leaks.count == 1000);
  CHECK(errors.undecided == 1000);
  CHECK(errors.false_misses.count == 0);

  // An octahedron seen along z: four of its edges, and their ends, are the silhouette.
  TriangleMesh octahedron{{{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}, {}, {}, {}, {}, {}};
  for (std::uint32_t i = 0; i < 4; ++i) {
    octahedron.triangles.emplace_back(i, (i + 1) % 4, 4);
    octahedron.triangles.emplace_back((i + 1) % 4, i, 5);
  }
  bench.geometry = {{octahedron}, {}};
  bench.exact = make_accelerator("exact", bench.geometry);
  bench.rays.clear();
  for (float s = 0.0f; s < 1.0f; s += 0.125f) {
    for (const vec3& sign : {vec3(1, 1, 0), vec3(-1, 1, 0), vec3(1, -1, 0), vec3(-1, -1, 0)}) {
      bench.rays.push_back({sign * vec3(s, 1 - s, 0) + vec3(0, 0, -3), {0, 0, 1}});
    }
  }
  errors = bench.judge(kDrop);
  CHECK(errors.hits == bench.rays.size());
  CHECK(errors.leaks.count == 0);
  CHECK(errors.undecided == bench.rays.size());
}

TEST_CASE("a ray from a floor to the corner of an open rim is undecided, not a leak", "[unit]") {
  // A floor, a wall and a ceiling; the front at z = 0 is open. All rays around one to the corner at x = 0, y = 1
  // that pass through the front do so further down, so beside it they would have to start below the floor.
  Bench bench;
  TriangleMesh room{
      {{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}, {0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}}, {}, {}, {}, {}, {}};
  for (const auto& [a, b, c, d] :
       std::initializer_list<std::array<std::uint32_t, 4>>{{0, 1, 2, 3}, {0, 3, 7, 4}, {4, 5, 6, 7}}) {
    room.triangles.emplace_back(a, b, c);
    room.triangles.emplace_back(a, c, d);
  }
  bench.geometry = {{room}, {}};
  bench.exact = make_accelerator("exact", bench.geometry);
  const vec3 origin(0.03125f, 0.0f, 0.34375f);
  bench.rays = {{origin, vec3(0, 1, 0) - origin}};
  const HitErrors errors = bench.judge(kDrop);
  CHECK(errors.hits == 1);
  CHECK(errors.leaks.count == 0);
  CHECK(errors.undecided == 1);
  // Just inside the corner it is a leak.
  bench.rays = {{origin, vec3(0.0f, 0.75f, 0.25f) - origin}};
  CHECK(bench.judge(kDrop).leaks.count == 1);
}

TEST_CASE("a ray lost that starts as near to the wall as floats can tell is a leak like any other", "[unit]") {
  Bench bench;
  const float s = 0x1p50f;
  bench.geometry = {
      {{{{0, 0, 0}, {s, 0, 0}, {0, s, 0}, {0, 0, s}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}, {}, {}, {}, {}}},
      {}};
  bench.exact = make_accelerator("exact", bench.geometry);
  bench.rays.clear();
  for (const float length : {0x1p-60f, 1.0f, 0x1p20f}) {
    bench.rays.push_back({vec3(0.25f * s, 0.25f * s, 0x1p-105f), vec3(0, 0, -length)});
  }
  int not_finite = 0;
  const ChangedAnswers watched(*bench.exact, [&](const Ray& ray, const std::optional<Hit>& hit) {
    not_finite += !is_finite(ray.direction);
    return hit;
  });
  const HitErrors errors =
      judge_hits(bench.geometry, ChangedAnswers(*bench.exact, kDrop), watched, bench.rays, Surface::closed);
  CHECK(errors.leaks.count == 3);
  CHECK(not_finite == 0);
}

TEST_CASE("the judge's report does not depend on the number of threads", "[unit]") {
  const Bench bench;
  const auto report = [&](int threads) {
    const ThreadLimit limit(threads);
    return bench.judge(one_in(3, shift(16)));
  };
  const HitErrors one = report(1), two = report(2);
  CHECK(one.wrong_primitives.count == two.wrong_primitives.count);
  CHECK(one.wrong_primitives.first->ray.direction == two.wrong_primitives.first->ray.direction);
  CHECK(one.t_error_ulp.p50 == two.t_error_ulp.p50);
  CHECK(one.t_error_ulp.p99 == two.t_error_ulp.p99);
  CHECK(one.t_error_ulp.max == two.t_error_ulp.max);
}
