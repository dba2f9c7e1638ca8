#include "raylab/measure/ray_timing.hpp"

#include <algorithm>
#include <cstdint>

#include "raylab/core/parallel.hpp"
#include "raylab/core/timing.hpp"

namespace raylab {

namespace {

// What was found, kept so that no query can be left out.
volatile float sink;

void send(const Accelerator& accelerator, std::span<const Ray> rays, Query query) {
  float sum = 0.0f;
  if (query == Query::occluded) {
    for (const Ray& ray : rays) sum += accelerator.occluded(ray) ? 1.0f : 0.0f;
  } else {
    for (const Ray& ray : rays) {
      const std::optional<Hit> hit = accelerator.intersect(ray);
      sum += hit ? hit->t : 0.0f;
    }
  }
  sink = sum;
}

}  // namespace

std::vector<std::size_t> turn_order(std::span<const int> shares) {
  std::vector<std::size_t> order;
  const std::int64_t rounds = shares.empty() ? 0 : *std::max_element(shares.begin(), shares.end());
  for (std::int64_t round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < shares.size(); ++i) {
      if ((round + 1) * shares[i] / rounds > round * shares[i] / rounds) order.push_back(i);
    }
  }
  return order;
}

std::vector<QueryTimes> time_in_turns(std::size_t count, const Turns& turns,
                                      const std::function<void(std::size_t)>& pass,
                                      const std::function<bool()>& stopped) {
  constexpr int kMost = 200;
  std::vector<QueryTimes> times(count);
  std::vector<int> shares(count);
  const FlushDenormals flush;
  for (std::size_t i = 0; i < count; ++i) {
    if (stopped && stopped()) return times;
    const CpuStopwatch warm_up(CpuClock::thread);
    pass(i);
    shares[i] =
        std::max(turns.least, static_cast<int>(std::min<double>(kMost, turns.seconds / warm_up.seconds())));
  }
  for (const std::size_t i : turn_order(shares)) {
    if (stopped && stopped()) return times;
    const CpuStopwatch cpu(CpuClock::thread);
    const Stopwatch wall;
    pass(i);
    times[i].cpu.push_back(cpu.seconds());
    times[i].wall.push_back(wall.seconds());
  }
  return times;
}

std::vector<QueryTimes> time_queries(std::span<const Accelerator* const> accelerators, std::span<const Ray> rays,
                                     Query query, const Turns& turns, const std::function<bool()>& stopped) {
  return time_in_turns(
      accelerators.size(), turns, [&](std::size_t i) { send(*accelerators[i], rays, query); }, stopped);
}

}  // namespace raylab
