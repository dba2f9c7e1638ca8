// raylab-bench rays: speed and accuracy of single rays.
#include <algorithm>

#include "hit_accuracy.hpp"
#include "ray_measurement.hpp"
#include "raylab/core/error.hpp"
#include "verdicts.hpp"

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
  const FailOn fail_on = parse_fail_on(options.fail_on);
  if (fail_on.slower) throw Error(ErrorKind::usage, "--fail-on", "slower: than what? `compare` judges speed");
  const std::vector<Variant> all = variants(options);
  const auto build_all = [&](const Geometry& geometry, Suite& suite) {
    std::vector<Built> built;
    for (const Variant& v : fit_variants(all, geometry, suite)) {
      built.push_back(build(v, geometry, 1));
      suite.check();
    }
    return built;
  };
  std::vector<Verdict> verdicts;
  const auto judge = [&](const Row& row) {
    const bool wrong = row["wrong"] > 0 || row["wrong_batch"] > 0;
    verdicts.push_back(
        {row["scene"].get<std::string>() + " " + row["rays"].get<std::string>() + " " + variant_name(row),
         fail_on.wrong && wrong ? "wrong answers: " + accuracy_text(row) +
                                      format("; %zu wrong in batches", row["wrong_batch"].get<std::size_t>())
                                : ""});
  };
  const auto describe = [&](std::size_t, Row& row) {
    judge(row);
    return line_of(row);
  };
  const auto judge_again = [&](const Row& row) {
    const auto is_of_row = [&](const Variant& v) { return v.name() == variant_name(row); };
    if (std::any_of(all.begin(), all.end(), is_of_row)) judge(row);
  };
  const int exit_code = run_ray_suite("rays", options, build_all, describe, judge_again);
  return exit_code != 0 ? exit_code : conclude("rays", verdicts, options.junit);
}

}  // namespace raylab::bench
