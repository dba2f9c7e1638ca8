#pragma once
#include <algorithm>
#include <vector>

#include "catch.hpp"
#include "raylab/accel/accelerator.hpp"
#include "raylab/core/numeric.hpp"
#include "raylab/measure/ray_sets.hpp"

namespace raylab::test {

/// Batches of any size give the answers of single rays, and occlusion is a hit, intervals that end at a hit
/// included.
inline void check_batches(const Accelerator& accelerator, std::vector<Ray> rays) {
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto hit = accelerator.intersect(rays[i]);
    if (!hit || i % 3 == 0) continue;
    if (i % 3 == 1) rays[i].t_max = i % 2 == 0 ? hit->t : next_float_up(hit->t);
    if (i % 3 == 2) rays[i].t_min = i % 2 == 0 ? hit->t : next_float_down(hit->t);
  }
  const RayArrays arrays(rays);
  const auto check = [&](std::size_t first, std::size_t count) {
    HitArrays hits(count);
    std::vector<std::uint8_t> occluded(count, 7);
    accelerator.intersect_batch(arrays.batch(first, count), hits.batch());
    accelerator.occluded_batch(arrays.batch(first, count), occluded.data());
    for (std::size_t i = 0; i < count; ++i) {
      INFO("ray " << first + i << ", " << i << " of a batch of " << count);
      const auto single = accelerator.intersect(rays[first + i]);
      REQUIRE(hits[i] == single);
      REQUIRE(accelerator.occluded(rays[first + i]) == single.has_value());
      REQUIRE(occluded[i] == (single ? 1 : 0));
    }
  };
  std::size_t first = 0;
  for (std::size_t size = 1; first < rays.size(); size = size % 50 + 1) {
    const std::size_t count = std::min(size, rays.size() - first);
    check(first, count);
    first += count;
  }
  check(0, rays.size());
}

}  // namespace raylab::test
