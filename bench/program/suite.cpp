#include "suite.hpp"

#include <algorithm>
#include <cstdio>

#include "raylab/core/parallel.hpp"
#include "raylab/core/timing.hpp"

namespace raylab::bench {

namespace {
bool written = false;
}  // namespace

bool Suite::any_written() { return written; }

Suite::Suite(const CommonOptions& options, const std::string& name)
    : folder_(options.out, name, options.command_line, options.resume), progress_(ProgressKind::automatic) {
  if (!options.resume) return;
  note(folder_.resumed() ? "goes on with the run that began at " + folder_.results().runs.back().value("date", "?")
                         : "--resume: " + options.out + " has no such run to go on with, so all is measured");
}

void Suite::check(double ahead) {
  progress_.update(expected_ > 0.0 ? std::min(1.0, (done_ + ahead) / expected_) : 0.0);
  if (InterruptGuard::interrupted()) throw Interrupted{};
}

bool Suite::measured(const std::string& part, double work) {
  if (!folder_.measured(part)) return false;
  advance(work);
  return true;
}

void Suite::add(const std::vector<Row>& rows, const std::vector<std::string>& lines, const std::string& part) {
  folder_.add(rows, part);
  written = true;
  progress_.finish(1.0);
  for (const std::string& line : lines) std::printf("%s\n", line.c_str());
  std::fflush(stdout);
}

void Suite::note(const std::string& line) {
  progress_.finish(1.0);
  std::fprintf(stderr, "raylab-bench: %s\n", line.c_str());
}

void Suite::finish() {
  folder_.finish();
  progress_.finish(1.0);
  note("wrote " + (folder_.path() / "results.json").string());
}

LoadedScene load(Suite& suite, const std::string& file, const std::vector<std::string>& overrides) {
  LoadOptions options;
  options.overrides = overrides;
  LoadedScene loaded = load_scene(file, options);
  suite.folder().note_scene(file, loaded.hash);
  loaded.scene.name = std::filesystem::path(file).stem().string();
  for (const std::string& warning : loaded.warnings) suite.note("warning: " + warning);
  return loaded;
}

std::string Variant::name() const {
  Row row;
  add_fields(row, *this);
  return variant_name(row);
}

AcceleratorOptions Variant::options(int threads) const {
  AcceleratorOptions options;
  options.threads = threads;
  if (!intersector.empty()) options.intersector = parse_intersector(intersector);
  options.quality = quality;
  options.compact = compact;
  return options;
}

std::vector<std::string> Variant::arguments() const {
  std::vector<std::string> arguments{"--accel", accel};
  if (!intersector.empty()) arguments.insert(arguments.end(), {"--intersector", intersector});
  if (quality) arguments.insert(arguments.end(), {"--quality", std::string(quality_name(*quality))});
  if (compact) arguments.push_back("--compact");
  return arguments;
}

std::vector<Variant> variants(const CommonOptions& options, bool all_intersectors) {
  std::vector<std::string> names = options.accels;
  if (names.empty()) {
    for (const AcceleratorEntry& entry : accelerators()) {
      if (!entry.capabilities.is_exact) names.push_back(entry.name);
    }
  }
  std::vector<std::string> tests = options.intersectors;
  for (const std::string& test : tests) (void)parse_intersector(test);
  if (tests.empty())
    tests = all_intersectors ? std::vector<std::string>{"book", "fast", "watertight"} : std::vector<std::string>{""};
  std::vector<std::optional<BuildQuality>> qualities;
  for (const std::string& quality : options.qualities) qualities.push_back(parse_quality(quality));
  if (qualities.empty()) qualities = {BuildQuality::balanced};
  std::vector<Variant> all;
  for (const std::string& name : names) {
    const AcceleratorCapabilities can = find_accelerator(name).capabilities;
    for (const auto& quality : can.takes_quality ? qualities : std::vector<std::optional<BuildQuality>>{{}}) {
      for (const std::string& test : can.takes_intersector ? tests : std::vector<std::string>{""}) {
        all.push_back({name, test, quality, options.compact && can.takes_compact});
      }
    }
  }
  return all;
}

std::vector<Variant> variants_or_default(CommonOptions options) {
  if (options.accels.empty()) options.accels = {kDefaultAccelerator};
  return variants(options, false);
}

bool is_fit(const Variant& variant, std::size_t primitives) {
  return primitives <= find_accelerator(variant.accel).capabilities.largest_primitives;
}

Built build(const Variant& variant, const Geometry& geometry, int threads) {
  const auto make = [&](const Geometry& g, const AcceleratorOptions& o) {
    return make_accelerator(variant.accel, g, o);
  };
  return build(variant, make, geometry, variant.options(threads));
}

Built build(const Variant& variant, const AcceleratorFactory& make, const Geometry& geometry,
            const AcceleratorOptions& options) {
  const ThreadLimit limit(options.threads);
  constexpr int kMostBuilds = 5;
  constexpr double kWorthSaving = 1.0;
  std::vector<double> seconds;
  Built built;
  built.variant = variant;
  const Stopwatch watch;
  do {
    built.accelerator.reset();
    built.accelerator = make(geometry, options);
    seconds.push_back(built.accelerator->build_report().seconds);
  } while (seconds.size() < kMostBuilds && watch.seconds() < kWorthSaving);
  built.build_seconds = spread_of(seconds);
  return built;
}

void add_fields(Row& row, const Variant& variant) {
  row["accel"] = variant.accel;
  if (!variant.intersector.empty()) row["intersector"] = variant.intersector;
  if (variant.quality) row["quality"] = quality_name(*variant.quality);
  if (variant.compact) row["compact"] = true;
}

std::string variant_name(const Row& row) {
  const std::string usual(quality_name(BuildQuality::balanced));
  std::string name = row["accel"];
  if (row.contains("intersector")) name += " " + row["intersector"].get<std::string>();
  if (const std::string quality = row.value("quality", usual); quality != usual) name += " " + quality + " quality";
  return row.value("compact", false) ? name + " compact" : name;
}

void add_fields(Row& row, const Variant& variant, const Geometry& geometry, const Built& built) {
  const BuildReport& report = built.accelerator->build_report();
  add_fields(row, variant);
  row["triangles"] = geometry.triangle_count();
  row["spheres"] = geometry.spheres.size();
  if (!report.isa.empty()) row["isa"] = report.isa;
  add_build_times(row, built.build_seconds);
  row["bytes"] = report.bytes;
  if (report.sah_cost > 0.0) row["sah_cost"] = report.sah_cost;
}

void add_build_times(Row& row, const Spread& seconds) {
  row["build_seconds"] = seconds.median;
  row["build_seconds_min"] = seconds.min;
  row["build_seconds_max"] = seconds.max;
}

Row to_row(const Spread& spread) { return {{"median", spread.median}, {"min", spread.min}, {"max", spread.max}}; }

}  // namespace raylab::bench
