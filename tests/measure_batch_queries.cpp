#include <algorithm>

#include "catch.hpp"
#include "raylab/core/parallel.hpp"
#include "raylab/measure/batch_queries.hpp"
#include "raylab/measure/judge.hpp"
#include "raylab/measure/ray_sets.hpp"
#include "raylab/measure/shapes.hpp"

using namespace raylab;

namespace {

/// Answers batches as another accelerator does single rays, but for every nth ray, which hits nothing.
class LosesInBatches final : public Accelerator {
 public:
  LosesInBatches(const Accelerator& accelerator, std::size_t every) : accelerator_(accelerator), every_(every) {}
  std::optional<Hit> intersect(const Ray& ray) const noexcept override { return accelerator_.intersect(ray); }
  bool occluded(const Ray& ray) const noexcept override { return accelerator_.occluded(ray); }
  void intersect_batch(const RayBatch& rays, const HitBatch& hits) const noexcept override {
    for (std::size_t i = 0; i < rays.count; ++i) {
      hits.set(i, count_++ % every_ == 0 ? std::nullopt : accelerator_.intersect(rays.ray(i)));
    }
  }
  const BuildReport& build_report() const noexcept override { return accelerator_.build_report(); }

 private:
  const Accelerator& accelerator_;
  std::size_t every_;
  mutable std::size_t count_ = 0;
};

}  // namespace

TEST_CASE("batched rays are the rays, in batches of up to 512", "[unit][measure]") {
  const std::vector<Ray> rays = random_rays(triangle_bounds({vec3(0.0f), vec3(1.0f), vec3(2.0f)}), 1100, 1);
  const BatchedRays batched(rays);
  REQUIRE(batched.batches() == 3);
  CHECK(batched.batch(0).count == 512);
  CHECK(batched.batch(2).count == 76);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Ray ray = batched.batch(i / 512).ray(i % 512);
    CHECK(ray.origin == rays[i].origin);
    CHECK(ray.direction == rays[i].direction);
    CHECK(ray.t_max == rays[i].t_max);
  }
}

TEST_CASE("rays that only batches lose are found by the judge", "[unit][measure]") {
  Geometry geometry;
  geometry.meshes.push_back(icosphere(vec3(0.0f), 1.0f, 3));
  const auto right = make_accelerator("bvh", geometry);
  const auto exact = make_accelerator("exact", geometry);
  // From the middle to the middle of triangles: every one hits, clear of all edges.
  std::vector<Ray> rays;
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const Triangle t = triangle_corners(geometry.meshes[0], i);
    rays.push_back({vec3(0.0f), (t.p0 + t.p1 + t.p2) / 3.0f});
  }
  const LosesInBatches loses(*right, 100);
  CHECK(judge_hits(geometry, loses, *exact, rays, Surface::closed).false_misses.count == 0);
  const BatchAnswers answers(loses, rays);
  CHECK(answers.differences() == 10);
  const HitErrors errors = judge_hits(geometry, answers, *exact, rays, Surface::closed);
  CHECK(errors.false_misses.count == 10);
  CHECK(errors.leaks.count == 10);
  CHECK(BatchAnswers(*right, rays).differences() == 0);
}
