#pragma once
// What the suites have in common that measure single rays and batches of the rays a scene sends.
#include <span>
#include <vector>

#include "commands.hpp"
#include "judged.hpp"
#include "raylab/measure/path_rays.hpp"
#include "suite.hpp"

namespace raylab::bench {

/// The rays of the scene's own paths, and rays at its edges and vertices: a set for each kind, some perhaps empty.
std::vector<RaySet> scene_ray_sets(const Scene& scene, const RaysOptions& options);

/// All accelerators on one set of rays, timed in turns, then checked: a row for each, of the suite.
std::vector<Row> measure_rays(Suite& suite, const std::string& suite_name, const Scene& scene, const RaySet& set,
                              std::span<const Built> built, const Judge& judge, const RaysOptions& options);

/// Speeds and errors of such a row, for people.
std::string speed_text(const Row& row);

}  // namespace raylab::bench
