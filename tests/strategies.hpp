#pragma once
// What a strategy of finding light is worth.
#include <cmath>

#include "catch.hpp"
#include "test_scenes.hpp"

namespace raylab::test {

/// Checks that a small picture of independent samples has the mean that it has without the strategy, and at most that
/// share of the error at as many samples.
inline void check_strategy(const SeenScene& scene, bool Strategies::*strategy, int max_depth, double share_of_error) {
  RenderOptions options = render_options(16, 16, 64, max_depth);
  options.sampler = SamplerKind::independent;
  const Estimate with = mean_luminance(render(scene, options));
  options.integrator.strategies.*strategy = false;
  options.samples_per_pixel = 1024;
  const Estimate without = mean_luminance(render(scene, options));
  INFO(with.mean << " ± " << with.error << ", without " << without.mean << " ± " << without.error);
  CHECK(std::abs(difference_z(with, without)) < 4.0);
  CHECK(with.error < share_of_error * 4.0 * without.error);  // of a sixteenth of the samples
}

}  // namespace raylab::test
