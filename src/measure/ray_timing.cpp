#include "raylab/measure/ray_timing.hpp"

#include <algorithm>
#include <cstdint>

#include "raylab/core/parallel.hpp"
#include "raylab/core/timing.hpp"

namespace raylab {

namespace {

// It keeps what was found, so that the compiler can leave no query out.
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

std::vector<std::size_t> interleaved_order(std::span<const int> shares) {
  std::vector<std::size_t> order;
  const std::int64_t rounds = shares.empty() ? 0 : *std::max_element(shares.begin(), shares.end());
  for (std::int64_t round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < shares.size(); ++i) {
      if ((round + 1) * shares[i] / rounds > round * shares[i] / rounds) order.push_back(i);
    }
  }
  return order;
}

std::vector<QueryTimes> time_interleaved(std::size_t count, const Repeats& repeats,
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
    shares[i] = std::max(repeats.least, static_cast<int>(std::min<double>(kMost, repeats.seconds / warm_up.seconds())));
  }
  for (const std::size_t i : interleaved_order(shares)) {
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
                                     Query query, const Repeats& repeats, const std::function<bool()>& stopped) {
  return time_interleaved(
      accelerators.size(), repeats, [&](std::size_t i) { send(*accelerators[i], rays, query); }, stopped);
}

}  // namespace raylab
