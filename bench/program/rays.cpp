// raylab-bench rays: speed and accuracy of single rays.
#include "ray_measurement.hpp"

namespace raylab::bench {

namespace {

std::vector<Variant> fit_variants(const std::vector<Variant>& all, const Geometry& geometry, Suite& suite) {
  std::vector<Variant> kept;
  for (const Variant& v : all) {
    if (is_fit(v, geometry.primitive_count())) {
      kept.push_back(v);
    } else {
      suite.note(
          format("%s left out: %zu primitives are too many for it", v.name().c_str(), geometry.primitive_count()));
    }
  }
  return kept;
}

std::string line_of(const Row& row) {
  return format("%-12s %-8s %-26s %s", row["scene"].get<std::string>().c_str(), row["rays"].get<std::string>().c_str(),
                variant_name(row).c_str(), speed_text(row).c_str());
}

}  // namespace

int rays(const RaysOptions& options) {
  const std::vector<Variant> all = variants(options);
  const auto build_all = [&](const Geometry& geometry, Suite& suite) {
    std::vector<Built> built;
    for (const Variant& v : fit_variants(all, geometry, suite)) {
      built.push_back(build(v, geometry, 1));
      suite.check();
    }
    return built;
  };
  return run_ray_suite("rays", options, build_all, [](std::size_t, Row& row) { return line_of(row); });
}

}  // namespace raylab::bench
