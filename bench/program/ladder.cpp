// raylab-bench ladder: what each step from the book's tree to `bvh` buys.
#include "ladder_steps.hpp"
#include "ray_measurement.hpp"

namespace raylab::bench {

namespace {

struct Step {
  const char* name;
  const char* accel;        ///< what the row calls it
  AcceleratorFactory make;  ///< absent: by that name
  AcceleratorOptions options;
};

std::vector<Step> steps() {
  // The last two change the tree of step 6.
  return {
      {"1 book", "rtiow", {}, {.intersector = Intersector::book}},
      {"2 flat nodes", "flat", make_flat, {}},
      {"3 surface areas", "heuristic", make_heuristic, {}},
      {"4 wide nodes", "wide", make_wide, {}},
      {"5 SIMD leaves", "bvh", {}, {.intersector = Intersector::book, .quality = BuildQuality::balanced}},
      {"6 watertight", "bvh", {}, {.intersector = Intersector::watertight, .quality = BuildQuality::balanced}},
      {"7 fast tree", "bvh", {}, {.intersector = Intersector::watertight, .quality = BuildQuality::fast}},
      {"8 best tree", "bvh", {}, {.intersector = Intersector::watertight, .quality = BuildQuality::best}},
  };
}

Built build(const Step& step, const Geometry& geometry) {
  AcceleratorOptions options = step.options;
  options.threads = 1;
  const Variant variant{step.accel, std::string(intersector_name(options.intersector.value_or(Intersector::book))),
                        options.quality};
  return build(
      variant,
      step.make ? step.make
                : [&](const Geometry& g, const AcceleratorOptions& o) { return make_accelerator(step.accel, g, o); },
      geometry, options);
}

std::string line_of(const Row& row) {
  return format("%-12s %-8s %-16s build %7.4f s %6.1f bytes/primitive %7.2f areas %s",
                row["scene"].get<std::string>().c_str(), row["rays"].get<std::string>().c_str(),
                row["step"].get<std::string>().c_str(), row["build_seconds"].get<double>(),
                row["bytes"].get<double>() / (row["triangles"].get<double>() + row["spheres"].get<double>()),
                row.value("sah_cost", 0.0), speed_text(row).c_str());
}

}  // namespace

int ladder(const RaysOptions& options) {
  const std::vector<Step> all = steps();
  const auto build_all = [&](const Geometry& geometry, Suite& suite) {
    std::vector<Built> built;
    for (const Step& step : all) {
      built.push_back(build(step, geometry));
      suite.check();
    }
    return built;
  };
  return run_ray_suite("ladder", options, build_all, [&](std::size_t index, Row& row) {
    row["step"] = all[index].name;
    return line_of(row);
  });
}

}  // namespace raylab::bench
