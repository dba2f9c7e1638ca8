// raylab-bench rays: speed and accuracy of single rays.
#include <algorithm>

#include "commands.hpp"
#include "judged.hpp"
#include "raylab/measure/batch_queries.hpp"
#include "raylab/measure/path_rays.hpp"
#include "raylab/measure/ray_timing.hpp"
#include "suite.hpp"

namespace raylab::bench {

namespace {

// Beyond this, testing every primitive takes minutes and tells nothing new.
constexpr std::size_t kMostForBruteForce = 1000;

std::vector<Variant> worthwhile(const std::vector<Variant>& all, const Geometry& geometry, Suite& suite) {
  std::vector<Variant> kept;
  bool left_out = false;
  for (const Variant& v : all) {
    if (is_brute_force(v) && geometry.primitive_count() > kMostForBruteForce) {
      left_out = true;
    } else {
      kept.push_back(v);
    }
  }
  if (left_out)
    suite.note(format("list left out: %zu primitives are too many for it", geometry.primitive_count()));
  return kept;
}

Row mega_per_second(std::size_t rays, const std::vector<double>& seconds) {
  std::vector<double> speeds;
  for (const double s : seconds) speeds.push_back(1e-6 * static_cast<double>(rays) / s);
  return to_row(spread_of(speeds));
}

/// Repeats that give each accelerator a twentieth of a second, and no fewer than asked for: on small scenes a pass
/// takes so little that the machine's moods would show.
int enough_repeats(std::span<const Accelerator* const> accelerators, std::span<const Ray> rays, Query query,
                   int least) {
  constexpr double kSeconds = 0.05;
  constexpr int kMost = 100;
  constexpr std::size_t kShare = 8;
  const std::span<const Ray> some = rays.first(std::max<std::size_t>(1, rays.size() / kShare));
  double fastest = kSeconds;
  for (const QueryTimes& times : time_queries(accelerators, some, query, 1)) {
    fastest =
        std::min(fastest, times.cpu.front() * static_cast<double>(rays.size()) / static_cast<double>(some.size()));
  }
  return std::max(least, std::min(kMost, static_cast<int>(kSeconds / fastest)));
}

std::string line_of(const Row& row) {
  const Row& speed = row["mrays_per_second"];
  return format("%-12s %-8s %-26s %7.2f Mrays/s (%.2f to %.2f), in batches %.2f; %s",
                row["scene"].get<std::string>().c_str(), row["rays"].get<std::string>().c_str(),
                (row["accel"].get<std::string>() + " " + row.value("intersector", "")).c_str(),
                speed["median"].get<double>(), speed["min"].get<double>(), speed["max"].get<double>(),
                row["mrays_per_second_batch"]["median"].get<double>(), judgement_text(row).c_str());
}

/// All accelerators on one set of rays: timed in turns, then checked.
void measure(Suite& suite, const Scene& scene, const RaySet& set, const std::vector<Variant>& variants,
             const std::vector<Built>& built, const Judge& judge, const RaysOptions& options) {
  std::vector<const Accelerator*> accelerators;
  for (const Built& b : built) accelerators.push_back(b.accelerator.get());
  const Query query = set.kind == RayKind::shadow ? Query::occluded : Query::intersect;
  const int repeats = enough_repeats(accelerators, set.rays, query, options.repeats);
  const auto times = time_queries(accelerators, set.rays, query, repeats, [&] {
    suite.check();
    return false;
  });
  const auto batch_times = time_batch_queries(accelerators, BatchedRays(set.rays), query, repeats, [&] {
    suite.check();
    return false;
  });
  const std::vector<Judgement> judgements = judge(accelerators, set, options.checked, suite);
  std::vector<Row> rows;
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < built.size(); ++i) {
    Row row{{"suite", "rays"}, {"scene", scene.name}, {"rays", ray_kind_name(set.kind)}, {"threads", 1}};
    add_fields(row, variants[i], scene.geometry, built[i]);
    row["mrays_per_second"] = mega_per_second(set.rays.size(), times[i].cpu);
    row["mrays_per_second_wall"] = mega_per_second(set.rays.size(), times[i].wall);
    row["mrays_per_second_batch"] = mega_per_second(set.rays.size(), batch_times[i].cpu);
    row["rays_timed"] = set.rays.size();
    row["runs"] = times[i].cpu.size();
    add_fields(row, judgements[i]);
    lines.push_back(line_of(row));
    rows.push_back(std::move(row));
  }
  suite.add(rows, lines);
}

}  // namespace

int rays(const RaysOptions& options) {
  const std::vector<Variant> all = variants(options.accels, options.intersectors);
  Suite suite(options.out, "rays", options.command_line);
  const InterruptGuard guard;
  constexpr double kKinds = 5.0;
  suite.expect(kKinds * static_cast<double>(options.scenes.size()));
  for (const std::string& file : options.scenes) {
    const LoadedScene loaded = load(suite, file);
    const Scene& scene = loaded.scene;
    const std::vector<Variant> variants = worthwhile(all, scene.geometry, suite);
    std::vector<Built> built;
    for (const Variant& v : variants) {
      built.push_back(build(v, scene.geometry, 1));
      suite.check();
    }
    const Judge judge(scene.geometry);
    const auto walker = make_accelerator("bvh", scene.geometry);
    IntegratorSettings settings;
    settings.max_depth = scene.render.max_depth;
    std::vector<RaySet> sets = path_ray_sets(scene, *walker, settings, options.rays, options.seed);
    std::vector<Ray> origins = sets[0].rays;
    origins.insert(origins.end(), sets[1].rays.begin(), sets[1].rays.end());
    for (RaySet& set : outline_ray_sets(scene.geometry, *walker, origins, options.rays, options.seed)) {
      sets.push_back(std::move(set));
    }
    for (const RaySet& set : sets) {
      if (set.rays.empty()) {
        suite.note(scene.name + " has no " + std::string(ray_kind_name(set.kind)) + " rays");
      } else {
        measure(suite, scene, set, variants, built, judge, options);
      }
      suite.advance(1.0);
    }
  }
  suite.finish();
  return 0;
}

}  // namespace raylab::bench
