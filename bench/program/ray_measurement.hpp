#pragma once
// What the suites have in common that measure single rays and batches of the rays a scene sends.
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "commands.hpp"
#include "hit_accuracy.hpp"
#include "raylab/measure/path_rays.hpp"
#include "suite.hpp"

namespace raylab::bench {

/// The accelerators of a suite, built for one scene.
using BuildAll = std::function<std::vector<Built>(const Geometry& geometry, Suite& suite)>;
/// What a suite adds to the row of the accelerator with that index; the line that people read of it.
using Describe = std::function<std::string(std::size_t index, Row& row)>;
/// What a suite makes of a row that was measured before the run was interrupted.
using Known = std::function<void(const Row& row)>;

/// A suite over the rays that the scenes' own paths send, and rays at their edges and vertices: for each kind of
/// rays all accelerators, timed in turns, then checked, and a row for each of them. Returns the exit code.
int run_ray_suite(
    const std::string& name, const RaysOptions& options, const BuildAll& build_all, const Describe& describe,
    const Known& known = [](const Row&) {});

/// Speeds and errors of such a row, for people.
std::string speed_text(const Row& row);

}  // namespace raylab::bench
