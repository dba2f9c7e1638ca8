#pragma once
// Whole pictures: made once, timed, and measured against a reference.
#include <filesystem>

#include "raylab/measure/convergence.hpp"
#include "raylab/render/render_session.hpp"
#include "suite.hpp"

namespace raylab::bench {

struct Rendered {
  Image image;
  double seconds = 0.0;      ///< wall clock, rendering alone
  double cpu_seconds = 0.0;  ///< of all threads
  RayCounts rays;
  RelmseEstimate error;  ///< from the picture's own samples
};

/// Samples of all pixels: the unit of a suite's progress.
double work_of(const RenderOptions& options);

/// Renders, showing progress and advancing the suite by work_of(options).
Rendered render_once(Suite& suite, const Scene& scene, const Accelerator& accelerator, const RenderOptions& options);

/// The scene file's settings at a picture `width` wide, or as wide as the scene says if 0.
RenderOptions options_of(const LoadedScene& loaded, int width);

/// The picture that options_of() leads to, with `spp` samples of random numbers that no measured run uses. Kept in
/// `cache` under the scene's hash and all that it depends on, and taken from there the next time.
Reference reference_of(Suite& suite, const LoadedScene& loaded, const Accelerator& accelerator,
                       const RenderOptions& options, int spp, const std::filesystem::path& cache);

/// Pixels of which a channel differs by more than 0.1%, which is more than a half-precision file rounds away.
std::size_t different_pixels(const Image& image, const Image& expected);

/// Fields of a row that the settings of a render give.
void add_fields(Row& row, const RenderOptions& options);
/// Those of them that other renderers have too: the picture's size, samples and path segments.
void add_size(Row& row, const RenderOptions& options);
void add_fields(Row& row, const RunErrors& errors, const Reference& reference);

/// Seconds, median and range, and paths per second of several runs.
void add_times(Row& row, const std::vector<double>& seconds, double paths);

}  // namespace raylab::bench
