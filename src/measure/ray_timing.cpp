#include "raylab/measure/ray_timing.hpp"

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

std::vector<QueryTimes> time_queries(std::span<const Accelerator* const> accelerators, std::span<const Ray> rays,
                                     Query query, int repeats, const std::function<bool()>& stopped) {
  std::vector<QueryTimes> times(accelerators.size());
  const FlushDenormals flush;
  for (int repeat = -1; repeat < repeats; ++repeat) {
    for (std::size_t i = 0; i < accelerators.size(); ++i) {
      if (stopped && stopped()) return times;
      const CpuStopwatch cpu(CpuClock::thread);
      const Stopwatch wall;
      send(*accelerators[i], rays, query);
      if (repeat < 0) continue;
      times[i].cpu.push_back(cpu.seconds());
      times[i].wall.push_back(wall.seconds());
    }
  }
  return times;
}

}  // namespace raylab
