#pragma once
// The subcommands of raylab-bench, each with its options. They return the exit code, throw Error, and throw
// Interrupted once they were interrupted.
#include <cstdint>
#include <string>
#include <vector>

namespace raylab::bench {

struct CommonOptions {
  std::vector<std::string> scenes;
  std::string out = "bench-results";
  std::vector<std::string> accels, intersectors, qualities;
  bool compact = false;
  int repeats = 5;
  std::uint32_t seed = 0;
  bool resume = false;
  std::string command_line;
};

struct RaysOptions : CommonOptions {
  std::size_t rays = 1 << 17;
  std::size_t checked = 20000;
  std::vector<std::string> fail_on;  ///< see parse_fail_on; of the suite rays alone, as is the next
  std::string junit;                 ///< empty, or the file for the verdicts
};

struct RenderSuiteOptions : CommonOptions {
  std::vector<std::string> integrators, samplers, ray_offsets;
  std::vector<int> spp{4, 16, 64};
  int width = 128;
  int threads = 0;
  int reference_spp = 1024;
  std::string cache;
  double target_error = 0.01;
  std::string peer_python;
  std::vector<std::string> peers;
  double peer_minutes = 30.0;  ///< for which a peer may be silent
};

struct NeedsOptions : CommonOptions {
  int spp = 16;  ///< of the measurements that choose
  int width = 96;
  int threads = 0;
  int reference_spp = 1024;
  std::string cache;
  double target_error = 0.01;
};

struct ScaleOptions : CommonOptions {
  std::vector<std::string> families;
  std::size_t largest = 1000000;  ///< triangles
  std::size_t rays = 1 << 16;
  std::size_t checked = 2000;
};

/// Of the suites that run raylab-render.
struct ProcessOptions : CommonOptions {
  std::vector<std::string> needs{"scene"};  ///< as --needs of raylab-render; of the suite process alone
  std::vector<std::string> overrides;       ///< as --set of raylab-render
  int width = 0;                            ///< 0: the scene's
  int spp = 0;                              ///< 0: the scene's
  int threads = 0;                          ///< 0: all
  std::string render_program;               ///< empty: raylab-render beside this program
};

struct ProfileOptions : CommonOptions {
  int width = 0;  ///< 0: the scene's
  int spp = 0;    ///< 0: the scene's
};

struct StabilityOptions : CommonOptions {
  std::vector<std::string> cases;  ///< names or numbers; none: all
  std::vector<std::string> isas;
  std::size_t rays = 20000;
  bool quick = false;
};

struct ReportOptions {
  std::string folder;
  std::string python;  ///< empty: found
  bool png = false;
};

struct CompareOptions {
  std::string before, after;  ///< folders of results
  bool any_machine = false;
  std::vector<std::string> fail_on;  ///< see parse_fail_on
  std::string junit;                 ///< empty, or the file for the verdicts
  std::vector<std::string> builds;   ///< instead of folders: the old build and the new one
  std::vector<std::string> scenes;   ///< what the builds render
  int width = 200;
  double seconds = 60.0;
};

int compare(const CompareOptions& options);
int compare_builds(const CompareOptions& options);
int rays(const RaysOptions& options);
int embree(const RaysOptions& options);
int ladder(const RaysOptions& options);
int report(const ReportOptions& options);
int scale(const ScaleOptions& options);
int needs(const NeedsOptions& options);
int render(const RenderSuiteOptions& options);
int process(const ProcessOptions& options);
int threads(const ProcessOptions& options);
int profile(const ProfileOptions& options);
int stability(const StabilityOptions& options);

}  // namespace raylab::bench
