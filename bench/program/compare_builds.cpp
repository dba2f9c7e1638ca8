// raylab-bench compare --build OLD --build NEW: whether renders of one build take longer than those of another.
#include <algorithm>
#include <cstdio>

#include "commands.hpp"
#include "raylab/core/error.hpp"
#include "raylab/core/scratch_folder.hpp"
#include "raylab/core/timing.hpp"
#include "render_process.hpp"
#include "verdicts.hpp"

namespace raylab::bench {

namespace {

namespace fs = std::filesystem;

/// The chance of a false alarm in all that one run of the command judges.
constexpr double kFalseAlarms = 0.01;
/// So many blocks of which all are slower make no more of them.
constexpr std::size_t kFewestBlocks = 8;
/// Seconds of one process: short, so that a machine whose speed drifts drifts little within a block.
constexpr double kRunSeconds = 0.12;

std::string render_program_of(const std::string& build) {
  std::error_code unknown;
  return find_render_program(fs::is_directory(build, unknown) ? (fs::path(build) / "raylab-render").string() : build);
}

struct ComparedScene {
  std::string name;
  std::vector<std::string> arguments;
  std::vector<double> ratios;  ///< new seconds over old ones, of each block
};

struct Comparison {
  std::string programs[2];
  ScratchFolder scratch{"raylab-bench"};

  double cpu_seconds(int program, const std::vector<std::string>& arguments) const {
    return run_render_process(programs[program], arguments, scratch / "picture.exr")["process_cpu_seconds"];
  }

  /// Chooses the samples per pixel for runs of kRunSeconds, or one where that takes longer.
  ComparedScene prepare(const std::string& file, int width) const {
    std::vector<std::string> arguments{file, "--quiet", "--threads", "1", "--width", std::to_string(width), "--spp"};
    const auto with = [&](int spp) {
      std::vector<std::string> all = arguments;
      all.push_back(std::to_string(spp));
      return all;
    };
    const double one = cpu_seconds(0, with(1));
    const double nine = cpu_seconds(0, with(9));
    const double sample = std::max((nine - one) / 8.0, 1e-5);
    const int spp = static_cast<int>(std::clamp((kRunSeconds - one) / sample, 1.0, 1e6));
    return {fs::path(file).stem().string(), with(spp), {}};
  }

  /// Old, new, new, old, or the other way round: what drifts evenly cancels.
  double ratio_of_block(const ComparedScene& scene, bool old_first) const {
    double seconds[2] = {};
    for (const int turn : {0, 1, 1, 0}) {
      const int program = old_first ? turn : 1 - turn;
      seconds[program] += cpu_seconds(program, scene.arguments);
    }
    return seconds[1] / seconds[0];
  }
};

}  // namespace

int compare_builds(const CompareOptions& options) {
  const FailOn fail_on = parse_fail_on(options.fail_on);
  if (fail_on.wrong)
    throw Error(ErrorKind::usage, "--fail-on",
                "wrong: two builds are compared by their seconds; `rays --fail-on wrong` judges answers");
  if (options.scenes.empty()) throw Error(ErrorKind::usage, "--scene", "no scene to render");
  const InterruptGuard guard;
  const Comparison comparison{{render_program_of(options.builds[0]), render_program_of(options.builds[1])}};
  std::vector<ComparedScene> scenes;
  for (const std::string& file : options.scenes) scenes.push_back(comparison.prepare(file, options.width));
  Progress progress(ProgressKind::automatic);
  const Stopwatch watch;
  for (std::size_t block = 0; block < kFewestBlocks * scenes.size() || watch.seconds() < options.seconds; ++block) {
    ComparedScene& scene = scenes[block % scenes.size()];
    scene.ratios.push_back(comparison.ratio_of_block(scene, block / scenes.size() % 2 == 0));
    progress.update(std::min(1.0, watch.seconds() / options.seconds));
    if (InterruptGuard::interrupted()) throw Interrupted{};
  }
  progress.finish(1.0);

  // A change that all scenes share shows best in all of them together.
  if (scenes.size() > 1) {
    ComparedScene all{"all", {}, {}};
    for (const ComparedScene& scene : scenes)
      all.ratios.insert(all.ratios.end(), scene.ratios.begin(), scene.ratios.end());
    scenes.push_back(std::move(all));
  }
  std::vector<double> chances;
  for (const ComparedScene& scene : scenes) chances.push_back(sign_test_above(scene.ratios, 1.0));
  chances = holm_corrected(chances);
  std::vector<Verdict> verdicts;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const double median = spread_of(scenes[i].ratios).median;
    const Interval interval = median_interval(scenes[i].ratios, 0.95);
    const std::string text = format("%.3f times the seconds (95%%: %.3f to %.3f), %zu blocks", median, interval.low,
                                    interval.high, scenes[i].ratios.size());
    std::printf("%-14s %s\n", scenes[i].name.c_str(), text.c_str());
    // Half the share asked for parts builds that are slower by it from builds that are not.
    const bool failed = fail_on.slower && chances[i] < kFalseAlarms && median > 1.0 + 0.5 * *fail_on.slower;
    verdicts.push_back({scenes[i].name, failed ? "slower: " + text : ""});
  }
  return conclude("compare", verdicts, options.junit);
}

}  // namespace raylab::bench
