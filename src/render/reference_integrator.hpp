#pragma once
#include "shading_scene.hpp"

namespace raylab {

/// Path by path and ray by ray, as in *Ray Tracing in One Weekend*: with light samples, multiple importance sampling
/// and Russian roulette. It takes the same samples as the wavefront and gives the same bits, several times as slowly;
/// `--integrator reference` chooses it.
class ReferenceIntegrator {
 public:
  explicit ReferenceIntegrator(const ShadingScene& scene) : s_(scene) {}

  /// One sample for each path of the batch.
  void trace(const PathBatch& paths, BatchRadiance& radiance, RayCounts& counts) const;

 private:
  const ShadingScene& s_;
};

}  // namespace raylab
