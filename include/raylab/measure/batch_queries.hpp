#pragma once
// Rays side by side, as the renderer sends them: timed, and their answers kept to be judged.
#include <array>
#include <span>
#include <unordered_map>
#include <vector>

#include "raylab/accel/accelerator.hpp"
#include "raylab/measure/ray_key.hpp"
#include "raylab/measure/ray_timing.hpp"

namespace raylab {

/// Rays as the batch queries take them, in batches of up to kMost, which is what the renderer sends at once.
class BatchedRays {
 public:
  static constexpr std::size_t kMost = 512;

  explicit BatchedRays(std::span<const Ray> rays);

  std::size_t size() const { return components_[0].size(); }
  std::size_t batches() const { return (size() + kMost - 1) / kMost; }
  RayBatch batch(std::size_t index) const;

 private:
  std::array<std::vector<float>, 8> components_;  ///< origin, direction, t_min, t_max
};

/// As time_queries(), with batch queries.
std::vector<QueryTimes> time_batch_queries(std::span<const Accelerator* const> accelerators, const BatchedRays& rays,
                                           Query query, const Repeats& repeats,
                                           const std::function<bool()>& stopped = {});

/// Answers single rays as another accelerator answered them in batches, so that batches can be judged like
/// anything else. Knows the rays it was made with, and must be asked for no others.
class BatchAnswers final : public Accelerator {
 public:
  BatchAnswers(const Accelerator& accelerator, std::span<const Ray> rays);

  std::optional<Hit> intersect(const Ray& ray) const noexcept override;
  bool occluded(const Ray& ray) const noexcept override;
  const BuildReport& build_report() const noexcept override { return accelerator_.build_report(); }

  /// Rays to which the accelerator's own single queries give another answer, be it by a bit.
  std::size_t differences() const { return differences_; }

 private:
  struct Answer {
    std::optional<Hit> hit;
    bool occluded = false;
  };
  const Accelerator& accelerator_;
  std::unordered_map<Ray, Answer, RayHash, RayEqual> answers_;
  std::size_t differences_ = 0;
};

}  // namespace raylab
