#pragma once
#include <functional>
#include <span>
#include <vector>

#include "raylab/accel/accelerator.hpp"

namespace raylab {

enum class Query { intersect, occluded };

/// Seconds that one accelerator took for all rays, one for each of its repeats.
struct QueryTimes {
  std::vector<double> cpu;  ///< of the querying thread: what other programs took does not count
  std::vector<double> wall;
};

/// How often each candidate runs: `least` times, and on until it has had about that many seconds, since a pass
/// takes so little on small scenes that noise of the machine would show; 200 times at most.
struct Repeats {
  int least;
  double seconds = 0.3;
};

/// The order in which candidates run, i as often as shares[i] says. The repeats of each are spread evenly over the
/// whole, so that a machine whose speed drifts slows all of them alike, however many repeats they take.
std::vector<std::size_t> interleaved_order(std::span<const int> shares);

/// Times pass(i), on this thread, for i from 0 to count - 1, interleaved, after a warm-up of each. Ends early,
/// with fewer repeats, once `stopped` says so.
std::vector<QueryTimes> time_interleaved(std::size_t count, const Repeats& repeats,
                                         const std::function<void(std::size_t)>& pass,
                                         const std::function<bool()>& stopped = {});

/// Sends all rays through each accelerator, the repeats interleaved.
std::vector<QueryTimes> time_queries(std::span<const Accelerator* const> accelerators, std::span<const Ray> rays,
                                     Query query, const Repeats& repeats, const std::function<bool()>& stopped = {});

}  // namespace raylab
