#include "raylab/measure/batch_queries.hpp"

#include <algorithm>

#include "raylab/core/check.hpp"
#include "raylab/core/parallel.hpp"

namespace raylab {

namespace {

/// Room for the answers to one batch.
struct Answers {
  std::array<float, BatchedRays::kMost> t, u, v;
  std::array<std::uint32_t, BatchedRays::kMost> geometry, primitive;
  std::array<std::uint8_t, BatchedRays::kMost> occluded;

  HitBatch hits() { return {t.data(), u.data(), v.data(), geometry.data(), primitive.data()}; }
};

}  // namespace

BatchedRays::BatchedRays(std::span<const Ray> rays) {
  for (const Ray& ray : rays) {
    const auto values = components_of(ray);
    for (std::size_t k = 0; k < values.size(); ++k) components_[k].push_back(values[k]);
  }
}

RayBatch BatchedRays::batch(std::size_t index) const {
  const std::size_t start = index * kMost;
  const auto at = [&](std::size_t k) { return components_[k].data() + start; };
  return {std::min(kMost, size() - start), {at(0), at(1), at(2)}, {at(3), at(4), at(5)}, at(6), at(7)};
}

std::vector<QueryTimes> time_batch_queries(std::span<const Accelerator* const> accelerators, const BatchedRays& rays,
                                           Query query, const Repeats& repeats, const std::function<bool()>& stopped) {
  Answers answers;
  const auto pass = [&](std::size_t i) {
    for (std::size_t b = 0; b < rays.batches(); ++b) {
      if (query == Query::occluded) {
        accelerators[i]->occluded_batch(rays.batch(b), answers.occluded.data());
      } else {
        accelerators[i]->intersect_batch(rays.batch(b), answers.hits());
      }
    }
  };
  return time_interleaved(accelerators.size(), repeats, pass, stopped);
}

BatchAnswers::BatchAnswers(const Accelerator& accelerator, std::span<const Ray> rays) : accelerator_(accelerator) {
  const FlushDenormals flush;
  const BatchedRays batched(rays);
  Answers answers;
  for (std::size_t b = 0; b < batched.batches(); ++b) {
    const RayBatch batch = batched.batch(b);
    accelerator.intersect_batch(batch, answers.hits());
    accelerator.occluded_batch(batch, answers.occluded.data());
    for (std::size_t i = 0; i < batch.count; ++i) {
      Answer answer;
      if (answers.geometry[i] != HitBatch::kNoHit) {
        answer.hit = Hit{answers.t[i], answers.u[i], answers.v[i], answers.geometry[i], answers.primitive[i]};
      }
      answer.occluded = answers.occluded[i] != 0;
      const Ray& ray = rays[b * BatchedRays::kMost + i];
      if (accelerator.intersect(ray) != answer.hit || accelerator.occluded(ray) != answer.occluded) ++differences_;
      answers_.emplace(ray, answer);
    }
  }
}

std::optional<Hit> BatchAnswers::intersect(const Ray& ray) const noexcept {
  const auto found = answers_.find(ray);
  RAYLAB_CHECK(found != answers_.end());
  return found->second.hit;
}

bool BatchAnswers::occluded(const Ray& ray) const noexcept {
  const auto found = answers_.find(ray);
  RAYLAB_CHECK(found != answers_.end());
  return found->second.occluded;
}

}  // namespace raylab
