#include "ray_measurement.hpp"

#include <optional>

#include "raylab/measure/batch_queries.hpp"
#include "raylab/measure/ray_timing.hpp"

namespace raylab::bench {

namespace {

Row mega_per_second(std::size_t rays, const std::vector<double>& seconds) {
  std::vector<double> speeds;
  for (const double s : seconds) speeds.push_back(1e-6 * static_cast<double>(rays) / s);
  return to_row(spread_of(speeds));
}

/// The rays of the scene's own paths, and rays at its edges and vertices: a set for each kind, some perhaps empty.
std::vector<RaySet> scene_ray_sets(const LoadedScene& loaded, const RaysOptions& options) {
  const Scene& scene = loaded.scene;
  const auto accelerator = make_accelerator(kDefaultAccelerator, scene.geometry);
  IntegratorSettings settings;
  settings.max_depth = scene.render.max_depth;
  std::vector<RaySet> sets = path_ray_sets(scene, loaded.camera, *accelerator, settings, options.rays, options.seed);
  std::vector<Ray> origins = sets[0].rays;
  origins.insert(origins.end(), sets[1].rays.begin(), sets[1].rays.end());
  for (RaySet& set : outline_ray_sets(scene.geometry, *accelerator, origins, options.rays, options.seed)) {
    sets.push_back(std::move(set));
  }
  return sets;
}

std::vector<Row> measure_rays(Suite& suite, const std::string& suite_name, const Scene& scene, const RaySet& set,
                              std::span<const Built> built, const HitChecker& check_hits, const RaysOptions& options) {
  std::vector<const Accelerator*> accelerators;
  for (const Built& b : built) accelerators.push_back(b.accelerator.get());
  const Query query = set.kind == RayKind::shadow ? Query::occluded : Query::intersect;
  const Repeats repeats{options.repeats};
  const auto stopped = [&] {
    suite.check();
    return false;
  };
  const auto times = time_queries(accelerators, set.rays, query, repeats, stopped);
  const auto batch_times = time_batch_queries(accelerators, BatchedRays(set.rays), query, repeats, stopped);
  const std::vector<HitAccuracy> accuracies = check_hits(accelerators, set, options.checked, suite);
  std::vector<Row> rows;
  for (std::size_t i = 0; i < built.size(); ++i) {
    Row row{{"suite", suite_name}, {"scene", scene.name}, {"rays", ray_kind_name(set.kind)}, {"threads", 1}};
    add_fields(row, built[i].variant, scene.geometry, built[i]);
    row["mrays_per_second"] = mega_per_second(set.rays.size(), times[i].cpu);
    row["mrays_per_second_wall"] = mega_per_second(set.rays.size(), times[i].wall);
    row["mrays_per_second_batch"] = mega_per_second(set.rays.size(), batch_times[i].cpu);
    row["rays_timed"] = set.rays.size();
    row["runs"] = times[i].cpu.size();
    add_fields(row, accuracies[i]);
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

int run_ray_suite(const std::string& name, const RaysOptions& options, const BuildAll& build_all,
                  const Describe& describe, const Known& known) {
  Suite suite(options, name);
  const InterruptGuard guard;
  constexpr double kKinds = 5.0;
  suite.expect(kKinds * static_cast<double>(options.scenes.size()));
  for (const std::string& file : options.scenes) {
    const LoadedScene loaded = load(suite, file);
    const Scene& scene = loaded.scene;
    // Made once there are rays to be measured.
    std::vector<Built> built;
    std::optional<HitChecker> check_hits;
    for (const RaySet& set : scene_ray_sets(loaded, options)) {
      const std::string part = file + " " + std::string(ray_kind_name(set.kind));
      if (set.rays.empty()) {
        suite.note(scene.name + " has no " + std::string(ray_kind_name(set.kind)) + " rays");
      } else if (suite.measured(part)) {
        const Row of_part{{"suite", name},
                          {"scene", scene.name},
                          {"rays", ray_kind_name(set.kind)},
                          {"triangles", scene.geometry.triangle_count()},
                          {"spheres", scene.geometry.spheres.size()}};
        for (const Row& row : suite.folder().results().rows) {
          if (has_values(row, of_part)) known(row);
        }
      } else {
        if (built.empty()) {
          built = build_all(scene.geometry, suite);
          check_hits.emplace(scene.geometry);
        }
        std::vector<Row> rows = measure_rays(suite, name, scene, set, built, *check_hits, options);
        std::vector<std::string> lines;
        for (std::size_t i = 0; i < rows.size(); ++i) lines.push_back(describe(i, rows[i]));
        suite.add(rows, lines, part);
      }
      suite.advance(1.0);
    }
  }
  suite.finish();
  return 0;
}

std::string speed_text(const Row& row) {
  const Row& speed = row["mrays_per_second"];
  return format("%7.2f Mrays/s (%.2f to %.2f), in batches %.2f; %s", speed["median"].get<double>(),
                speed["min"].get<double>(), speed["max"].get<double>(),
                row["mrays_per_second_batch"]["median"].get<double>(), accuracy_text(row).c_str());
}

}  // namespace raylab::bench
