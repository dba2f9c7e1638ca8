#include "suite.hpp"

#include <algorithm>
#include <cstdarg>
#include <cstdio>

#include "raylab/core/error.hpp"
#include "raylab/core/parallel.hpp"
#include "raylab/core/timing.hpp"

namespace raylab::bench {

namespace {

bool has_choice_of_intersector(const std::string& accel) {
  AcceleratorOptions options;
  options.intersector = Intersector::watertight;
  try {
    (void)make_accelerator(accel, Geometry(), options);
    return true;
  } catch (const Error&) {
    return false;
  }
}

}  // namespace

void Suite::check(double ahead) {
  progress_.update(expected_ > 0.0 ? std::min(1.0, (done_ + ahead) / expected_) : 0.0);
  if (InterruptGuard::interrupted()) throw Interrupted{};
}

void Suite::add(const std::vector<Row>& rows, const std::vector<std::string>& lines) {
  folder_.add(rows);
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

LoadedScene load(Suite& suite, const std::string& file) {
  LoadedScene loaded = load_scene(file);
  loaded.scene.name = std::filesystem::path(file).stem().string();
  for (const std::string& warning : loaded.warnings) suite.note("warning: " + warning);
  return loaded;
}

std::vector<Variant> variants(const std::vector<std::string>& accels,
                              const std::vector<std::string>& intersectors) {
  std::vector<std::string> names = accels;
  if (names.empty()) {
    for (const AcceleratorEntry& entry : accelerators()) {
      if (entry.name != "exact") names.push_back(entry.name);
    }
  }
  std::vector<std::string> tests = intersectors;
  if (tests.empty()) tests = {"book", "fast", "watertight"};
  for (const std::string& test : tests) (void)parse_intersector(test);
  std::vector<Variant> all;
  for (const std::string& name : names) {
    (void)make_accelerator(name, Geometry());  // an unknown name is known now, and not after an hour
    if (!has_choice_of_intersector(name)) {
      all.push_back({name, ""});
    } else {
      for (const std::string& test : tests) all.push_back({name, test});
    }
  }
  return all;
}

bool is_brute_force(const Variant& variant) { return variant.accel == "list"; }

Built build(const Variant& variant, const Geometry& geometry, int threads) {
  AcceleratorOptions options;
  options.threads = threads;
  if (!variant.intersector.empty()) options.intersector = parse_intersector(variant.intersector);
  const auto make = [&](const Geometry& g, const AcceleratorOptions& o) {
    return make_accelerator(variant.accel, g, o);
  };
  return build(variant, make, geometry, options);
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

void add_fields(Row& row, const Variant& variant, const Geometry& geometry, const Built& built) {
  const BuildReport& report = built.accelerator->build_report();
  row["accel"] = variant.accel;
  if (!variant.intersector.empty()) row["intersector"] = variant.intersector;
  row["triangles"] = geometry.triangle_count();
  row["spheres"] = geometry.spheres.size();
  if (!report.isa.empty()) row["isa"] = report.isa;
  row["build_seconds"] = built.build_seconds.median;
  row["build_seconds_min"] = built.build_seconds.min;
  row["build_seconds_max"] = built.build_seconds.max;
  row["bytes"] = report.bytes;
  if (report.sah_cost > 0.0) row["sah_cost"] = report.sah_cost;
}

Row to_row(const Spread& spread) { return {{"median", spread.median}, {"min", spread.min}, {"max", spread.max}}; }

std::string format(const char* pattern, ...) {
  std::va_list args;
  va_start(args, pattern);
  char buffer[1024];
  std::vsnprintf(buffer, sizeof buffer, pattern, args);
  va_end(args);
  return buffer;
}

}  // namespace raylab::bench
