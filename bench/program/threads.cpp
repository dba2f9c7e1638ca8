// raylab-bench threads: what threads give a render, beside what the machine gives processes that share nothing.
#include <future>

#include "commands.hpp"
#include "raylab/core/parallel.hpp"
#include "raylab/core/scratch_folder.hpp"
#include "render_process.hpp"
#include "rendering.hpp"

namespace raylab::bench {

namespace {

/// Renders in several processes of one thread each at the same time. Returns the first one's run, its seconds
/// being the mean over the processes: the time of the slowest would count the moment in which it runs alone.
Row run_at_once(const std::string& program, const std::vector<std::string>& arguments, int processes,
                const ScratchFolder& scratch) {
  std::vector<std::future<Row>> running;
  for (int i = 0; i < processes; ++i) {
    running.push_back(std::async(std::launch::async, [&, i] {
      return run_render_process(program, arguments, scratch / ("picture" + std::to_string(i) + ".exr"));
    }));
  }
  std::vector<Row> runs;
  for (std::future<Row>& run : running) runs.push_back(run.get());
  double sum = 0.0;
  for (const Row& run : runs) sum += run["seconds"].get<double>();
  runs[0]["seconds"] = sum / processes;
  return runs[0];
}

void measure(Suite& suite, const std::string& program, const std::string& file, const Variant& variant, int threads,
             const ProcessOptions& options) {
  const ScratchFolder scratch("raylab-bench");
  const auto arguments_on = [&](int count) {
    std::vector<std::string> arguments = render_arguments(file, variant, options);
    arguments.insert(arguments.end(), {"--threads", std::to_string(count)});
    return arguments;
  };
  std::vector<Row> single, parallel, at_once;
  // They take turns, so that a machine whose speed drifts changes no ratio.
  for (int run = 0; run < options.repeats; ++run) {
    single.push_back(run_render_process(program, arguments_on(1), scratch / "picture.exr"));
    suite.check();
    parallel.push_back(run_render_process(program, arguments_on(threads), scratch / "picture.exr"));
    suite.check();
    at_once.push_back(run_at_once(program, arguments_on(1), threads, scratch));
    suite.advance(1.0);
    suite.check();
  }
  const auto add = [&](const std::vector<Row>& runs, int processes) {
    Row row = render_process_row("threads", file, variant, options, runs);
    row["processes"] = processes;
    Spread speedup = spread_of_ratios(single, runs, "seconds");
    for (double* value : {&speedup.median, &speedup.min, &speedup.max}) *value *= processes;
    row["speedup"] = to_row(speedup);
    suite.add({row}, {format("%-12s %-18s processes %d, threads of each %d: %.3f s, speed-up %.3f (%.3f to %.3f); "
                             "estimated relMSE %.4f",
                             row["scene"].get<std::string>().c_str(), variant.name().c_str(), processes,
                             row["threads"].get<int>(), row["seconds"].get<double>(), speedup.median, speedup.min,
                             speedup.max, row.value("estimated_relmse", kInfinity))});
  };
  add(single, 1);
  if (threads == 1) return;
  add(parallel, 1);
  add(at_once, threads);
}

}  // namespace

int threads(const ProcessOptions& options) {
  const std::string program = find_render_program(options.render_program);
  const std::vector<Variant> all = variants_or_default(options);
  const int threads = options.threads > 0 ? options.threads : hardware_threads();
  Suite suite(options, "threads");
  const InterruptGuard guard;
  suite.expect(static_cast<double>(options.scenes.size() * all.size()) * options.repeats);
  for (const std::string& file : options.scenes) {
    load(suite, file, options.overrides);  // tells its warnings, and whether it is that of a resumed run
    for (const Variant& variant : all) {
      const std::string part = file + " " + variant.name();
      if (suite.measured(part, options.repeats)) continue;
      measure(suite, program, file, variant, threads, options);
      suite.end_part(part);
    }
  }
  suite.finish();
  return 0;
}

}  // namespace raylab::bench
