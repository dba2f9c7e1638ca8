#include "render_process.hpp"

#include <fstream>

#include "raylab/core/error.hpp"
#include "raylab/core/timing.hpp"
#include "rendering.hpp"
#include "subprocess.hpp"

namespace raylab::bench {

namespace fs = std::filesystem;

std::string find_render_program(const std::string& given) {
  std::error_code unknown;
  const fs::path program =
      given.empty() ? fs::read_symlink("/proc/self/exe", unknown).parent_path() / "raylab-render" : fs::path(given);
  if (!fs::exists(program, unknown))
    throw Error(ErrorKind::usage, "--render-program", "there is no " + program.string());
  return program.string();
}

std::vector<std::string> render_arguments(const std::string& scene_file, const Variant& variant,
                                          const ProcessOptions& options) {
  std::vector<std::string> arguments{scene_file, "--quiet"};
  const auto add = [&](const char* name, const std::string& value) {
    arguments.insert(arguments.end(), {name, value});
  };
  for (const std::string& argument : variant.arguments()) arguments.push_back(argument);
  if (options.width > 0) add("--width", std::to_string(options.width));
  if (options.spp > 0) add("--spp", std::to_string(options.spp));
  add("--seed", std::to_string(options.seed));
  for (const std::string& setting : options.overrides) add("--set", setting);
  return arguments;
}

Row run_render_process(const std::string& program, std::vector<std::string> arguments, const fs::path& picture) {
  fs::path stats = picture;
  stats.replace_extension(".json");
  arguments.insert(arguments.begin(), program);
  arguments.insert(arguments.end(), {"-o", picture.string(), "--stats", stats.string()});
  const Stopwatch watch;
  double cpu_seconds = 0.0;
  const int exit_code = run_program(arguments, true, &cpu_seconds);
  const double seconds = watch.seconds();
  if (exit_code == kInterrupted) throw Interrupted{};
  if (exit_code != 0) {
    const bool has_kind =
        exit_code >= static_cast<int>(ErrorKind::failure) && exit_code <= static_cast<int>(ErrorKind::output);
    throw Error(has_kind ? static_cast<ErrorKind>(exit_code) : ErrorKind::failure, program,
                "ended with exit code " + std::to_string(exit_code) + " (see above)");
  }
  std::ifstream stream(stats);
  Row run = Row::parse(stream);
  run["process_seconds"] = seconds;
  run["process_cpu_seconds"] = cpu_seconds;
  return run;
}

Row render_process_row(const std::string& suite, const std::string& scene_file, const Variant& variant,
                       const ProcessOptions& options, const std::vector<Row>& runs) {
  const Row& first = runs.front();
  Row row{{"suite", suite}, {"scene", fs::path(scene_file).stem().string()}};
  add_fields(row, variant);
  for (const char* field :
       {"integrator", "sampler", "threads", "triangles", "width", "height", "spp", "max_depth", "spheres",
        "scene_bytes", "light_bytes", "dropped_bytes", "isa", "bytes", "estimated_relmse"}) {
    if (first.contains(field) && first[field] != "") row[field] = first[field];
  }
  if (first["sah_cost"] > 0.0) row["sah_cost"] = first["sah_cost"];
  std::string overrides;
  for (const std::string& setting : options.overrides) overrides += (overrides.empty() ? "" : " ") + setting;
  if (!overrides.empty()) row["overrides"] = overrides;
  row["process_seconds"] = to_row(spread_of_field(runs, "process_seconds"));
  row["load_seconds"] = to_row(spread_of_field(runs, "load_seconds"));
  add_build_times(row, spread_of_field(runs, "build_seconds"));
  std::vector<double> seconds;
  for (const Row& run : runs) seconds.push_back(run["seconds"]);
  add_times(row, seconds, first["width"].get<double>() * first["height"].get<double>() * first["spp"].get<double>());
  return row;
}

Spread spread_of_field(const std::vector<Row>& runs, const char* field) {
  std::vector<double> values;
  for (const Row& run : runs) values.push_back(run[field]);
  return spread_of(values);
}

Spread spread_of_ratios(const std::vector<Row>& numerators, const std::vector<Row>& denominators, const char* field) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < numerators.size(); ++i)
    ratios.push_back(numerators[i][field].get<double>() / denominators[i][field].get<double>());
  return spread_of(ratios);
}

}  // namespace raylab::bench
