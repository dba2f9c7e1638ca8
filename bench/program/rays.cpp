// raylab-bench rays: speed and accuracy of single rays.
#include "ray_measurement.hpp"

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

std::string line_of(const Row& row) {
  return format(
      "%-12s %-8s %-26s %s", row["scene"].get<std::string>().c_str(), row["rays"].get<std::string>().c_str(),
      (row["accel"].get<std::string>() + " " + row.value("intersector", "")).c_str(), speed_text(row).c_str());
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
    std::vector<Built> built;
    for (const Variant& v : worthwhile(all, scene.geometry, suite)) {
      built.push_back(build(v, scene.geometry, 1));
      suite.check();
    }
    const Judge judge(scene.geometry);
    for (const RaySet& set : scene_ray_sets(scene, options)) {
      if (set.rays.empty()) {
        suite.note(scene.name + " has no " + std::string(ray_kind_name(set.kind)) + " rays");
      } else {
        const std::vector<Row> rows = measure_rays(suite, "rays", scene, set, built, judge, options);
        std::vector<std::string> lines;
        for (const Row& row : rows) lines.push_back(line_of(row));
        suite.add(rows, lines);
      }
      suite.advance(1.0);
    }
  }
  suite.finish();
  return 0;
}

}  // namespace raylab::bench
