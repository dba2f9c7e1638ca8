#pragma once
// Ways to a picture of one scene that take turns at rendering: configurations of Raylab, and other renderers.
#include <string>
#include <vector>

#include "peer.hpp"
#include "raylab/measure/convergence.hpp"
#include "rendering.hpp"

namespace raylab::bench {

/// What a scene is rendered with.
struct Configuration {
  Variant variant;
  std::string integrator = "path";
  std::string sampler = "sobol";
  std::string ray_offset = "bounds";
};

/// Holds what all measurements of one scene have in common.
struct SceneContext {
  const std::string& file;
  const LoadedScene& loaded;
  const Reference& reference;
  const RenderSuiteOptions& options;
  int threads;
};

RenderOptions options_for(const SceneContext& context, const Configuration& configuration, int spp, int run);

Row scene_row(const SceneContext& context);

/// How often to render with so many samples per pixel.
int runs_of(const RenderSuiteOptions& options, int spp);

/// A peer's picture is taken where rendering is measured, not its launch: at this width and so many seconds a point.
constexpr int kPeerWidth = 400;
constexpr double kPeerSeconds = 1.0;

/// Renders in each way with one number of samples after the other, the largest first, and adds a row for each, then one
/// for each that says when it reaches the target error, and how many times as long that takes as in the first
/// configuration. In every round each way renders once, in every second one in reverse order, so that what else the
/// machine does, and its drift, meets all. A peer that fails is left out by name.
void measure_in_turns(Suite& suite, const SceneContext& context, const std::vector<Configuration>& configurations,
                      const std::vector<Built>& built, const std::vector<Peer>& peers);

}  // namespace raylab::bench
