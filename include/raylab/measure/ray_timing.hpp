#pragma once
#include <span>
#include <vector>

#include "raylab/accel/accelerator.hpp"

namespace raylab {

enum class Query { intersect, occluded };

/// Seconds that one accelerator took for all rays, one for each repeat.
struct QueryTimes {
  std::vector<double> cpu;  ///< of the querying thread: what other programs took does not count
  std::vector<double> wall;
};

/// Sends all rays through each accelerator, on this thread, `repeats` times after a warm-up. The accelerators take
/// turns, so that a machine whose speed drifts slows all of them alike. Ends early, with fewer repeats, once
/// `stopped` says so.
std::vector<QueryTimes> time_queries(std::span<const Accelerator* const> accelerators, std::span<const Ray> rays,
                                     Query query, int repeats, const std::function<bool()>& stopped = {});

}  // namespace raylab
