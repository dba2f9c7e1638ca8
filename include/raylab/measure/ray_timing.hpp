#pragma once
#include <functional>
#include <span>
#include <vector>

#include "raylab/accel/accelerator.hpp"

namespace raylab {

enum class Query { intersect, occluded };

/// Seconds that one accelerator took for all rays, one for each of its turns.
struct QueryTimes {
  std::vector<double> cpu;  ///< of the querying thread: what other programs took does not count
  std::vector<double> wall;
};

/// How often each of what is measured runs: `least` times, and on until it has had about that many seconds, since
/// on small scenes a pass takes so little that the machine's moods would show; 200 times at most.
struct Turns {
  int least;
  double seconds = 0.3;
};

/// Who runs when, i as often as shares[i] says, the turns of each spread evenly over the whole: a machine whose
/// speed drifts then slows all of them alike, however many turns they take.
std::vector<std::size_t> turn_order(std::span<const int> shares);

/// Times pass(i), on this thread, for i from 0 to count - 1, in turns after a warm-up of each. Ends early, with
/// fewer turns, once `stopped` says so.
std::vector<QueryTimes> time_in_turns(std::size_t count, const Turns& turns,
                                      const std::function<void(std::size_t)>& pass,
                                      const std::function<bool()>& stopped = {});

/// Sends all rays through each accelerator, in turns.
std::vector<QueryTimes> time_queries(std::span<const Accelerator* const> accelerators, std::span<const Ray> rays,
                                     Query query, const Turns& turns, const std::function<bool()>& stopped = {});

}  // namespace raylab
