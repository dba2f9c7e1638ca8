// raylab-bench process: whole processes of raylab-render, from their start to the picture on disk.
#include <algorithm>
#include <functional>

#include "commands.hpp"
#include "raylab/core/scratch_folder.hpp"
#include "raylab/image/image_file.hpp"
#include "render_process.hpp"
#include "rendering.hpp"

namespace raylab::bench {

namespace {

/// What one variant is rendered with, and what came of it.
struct Configuration {
  Variant variant;
  std::string needs;
  std::vector<Row> runs;
  Image image;
};

std::string line_of(const Row& row) {
  const auto median = [&](const char* field) { return row[field]["median"].get<double>(); };
  std::string line =
      format("%-12s %-18s needs %-5s process %7.3f s: load %.3f, build %.3f, render %.3f; estimated relMSE %.4f",
             row["scene"].get<std::string>().c_str(), variant_name(row).c_str(), row.value("needs", "scene").c_str(),
             median("process_seconds"), median("load_seconds"), row["build_seconds"].get<double>(),
             row["seconds"].get<double>(), row.value("estimated_relmse", kInfinity));
  if (row.contains("seconds_ratio"))
    line += format("; %.3f times the seconds, %zu pixels differ", median("seconds_ratio"),
                   row["different_pixels"].get<std::size_t>());
  return line;
}

void measure(Suite& suite, const std::string& program, const std::string& file, const ProcessOptions& options) {
  const ScratchFolder scratch("raylab-bench");
  std::vector<Configuration> configurations;
  for (const Variant& variant : variants_or_default(options)) {
    for (const std::string& needs : options.needs) configurations.push_back({variant, needs, {}, {}});
  }
  // The configurations take turns, so that a machine whose speed drifts changes no ratio.
  for (int run = 0; run < options.repeats; ++run) {
    for (Configuration& c : configurations) {
      std::vector<std::string> arguments = render_arguments(file, c.variant, options);
      arguments.insert(arguments.end(), {"--needs", c.needs, "--threads", std::to_string(options.threads)});
      c.runs.push_back(run_render_process(program, arguments, scratch / "picture.exr"));
      if (run == 0) c.image = read_exr(scratch / "picture.exr");
      suite.advance(1.0);
      suite.check();
    }
  }
  const Configuration* minimal = nullptr;
  for (const Configuration& c : configurations) {
    Row row = render_process_row("process", file, c.variant, options, c.runs);
    if (c.needs == "scene") {
      minimal = &c;
    } else {
      row["needs"] = c.needs;
      if (minimal != nullptr && minimal->variant.name() == c.variant.name()) {
        row["seconds_ratio"] = to_row(spread_of_ratios(c.runs, minimal->runs, "seconds"));
        row["different_pixels"] = different_pixels(c.image, minimal->image);
        row["pixels"] = c.image.pixels.size();
      }
    }
    suite.add({row}, {line_of(row)});
  }
}

}  // namespace

int process(const ProcessOptions& given) {
  ProcessOptions options = given;
  std::sort(options.needs.begin(), options.needs.end(),
            std::greater<>());  // "scene" first, which "all" is compared with
  const std::string program = find_render_program(options.render_program);
  const std::size_t variants = variants_or_default(options).size();
  Suite suite(options, "process");
  const InterruptGuard guard;
  const double runs = static_cast<double>(variants * options.needs.size()) * options.repeats;
  suite.expect(runs * static_cast<double>(options.scenes.size()));
  for (const std::string& file : options.scenes) {
    load(suite, file, options.overrides);  // tells its warnings, and whether it is that of a resumed run
    if (suite.measured(file, runs)) continue;
    measure(suite, program, file, options);
    suite.end_part(file);
  }
  suite.finish();
  return 0;
}

}  // namespace raylab::bench
