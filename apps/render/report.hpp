#pragma once
#include <string>

#include "options.hpp"
#include "raylab/io/scene_file.hpp"

namespace raylab {

/// All there is to say of a render once it has ended.
struct RenderReport {
  const RenderCommand& command;
  const LoadedScene& loaded;
  const RenderOptions& options;
  const BuildReport& build;
  RenderStats stats;
  const SceneNeeds& needs;
  std::size_t light_count;
  std::size_t light_bytes;
  std::size_t mirror_chains, sphere_chains;
  double load_seconds;
  RelmseEstimate error;
  bool partial;
  std::string stopped_by;  ///< what ended it: "samples", "--time-limit", "--target-error" or "interrupt"
  SampleRange taken;       ///< the fewest and the most of a pixel that was rendered
  double seconds_before;   ///< of the runs that it went on from
};

/// The accelerator and how it is built.
std::string accelerator_text(const RenderCommand& command);

/// What `--check` prints.
std::string check_text(const RenderCommand& command, const LoadedScene& loaded, const RenderOptions& options,
                       double load_seconds);

/// The closing lines of a render.
std::string report_text(const RenderReport& report);

/// The same figures for `--stats`.
std::string report_json(const RenderReport& report);

/// The command that renders the first dropped sample again, and nothing else; of every view or frame, if there are
/// some.
std::string replay_command(const RenderReport& report);

}  // namespace raylab
