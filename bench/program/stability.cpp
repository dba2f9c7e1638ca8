// raylab-bench stability: how often each method fails at each value of the quantity that breaks it.
#include "raylab/measure/stability.hpp"

#include <algorithm>

#include "raylab/accel/accelerator.hpp"
#include "suite.hpp"

namespace raylab::bench {

namespace {

StabilityChoice choice_of(const StabilityOptions& options) {
  StabilityChoice choice;
  choice.accels = options.accels;
  for (const std::string& accel : options.accels) (void)find_accelerator(accel);
  for (const std::string& test : options.intersectors) choice.intersectors.push_back(parse_intersector(test));
  for (const std::string& isa : options.isas) choice.isas.push_back(choose_isa(parse_isa(isa)));
  return choice;
}

/// The instruction set, and of Embree the version, that the method's accelerator says it uses; empty for none.
std::string isa_of(const StabilityMethod& method) {
  if (method.accel.empty()) return "";
  const Geometry nothing;
  return make_accelerator(method.accel, nothing, method.options())->build_report().isa;
}

Row row_of(const StabilityCase& tried, const StabilityMethod& method, double value, const StabilityCount& count) {
  Row row{{"suite", "stability"}, {"scene", tried.name}};
  add_fields(row, method);
  if (const std::string isa = isa_of(method); !isa.empty()) row["isa"] = isa;
  row.update({{"case", tried.id},
              {"theme", tried.theme},
              {"title", tried.title},
              {"fails", tried.fails},
              {"swept", tried.swept},
              {"value", value},
              {"holds", tried.holds_at(value)},
              {"trials", count.trials},
              {"failures", count.failures}});
  if (tried.largest_rate > 0.0) row["largest_rate"] = tried.largest_rate;
  return row;
}

}  // namespace

int stability(const StabilityOptions& options) {
  const StabilityChoice choice = choice_of(options);
  std::vector<const StabilityCase*> cases;
  for (const std::string& name : options.cases) cases.push_back(&find_stability_case(name));
  if (cases.empty()) {
    for (const StabilityCase& tried : stability_cases()) cases.push_back(&tried);
  }
  const std::size_t rays = options.quick ? std::min<std::size_t>(options.rays, 1000) : options.rays;

  Suite suite(options, "stability");
  const InterruptGuard guard;
  for (const StabilityCase* tried : cases) suite.expect(static_cast<double>(tried->values.size()));
  for (const StabilityCase* tried : cases) {
    if (suite.measured(tried->name, static_cast<double>(tried->values.size()))) continue;
    const std::vector<StabilityMethod> methods = stability_methods(*tried, choice);
    std::vector<Row> rows;
    std::vector<std::string> failed_from(methods.size());
    for (const double value : tried->values) {
      const StabilityTrial trial = tried->prepare(value, rays, options.seed);
      for (std::size_t i = 0; i < methods.size(); ++i) {
        suite.check();
        const StabilityCount count = trial(methods[i]);
        if (count.trials == 0) continue;  // too large for it
        rows.push_back(row_of(*tried, methods[i], value, count));
        if (count.failures == 0) continue;
        failed_from[i] +=
            format("%s%.4g: %zu/%zu", failed_from[i].empty() ? "" : ", ", value, count.failures, count.trials);
      }
      suite.advance(1.0);
    }
    std::vector<std::string> lines;
    for (std::size_t i = 0; i < methods.size(); ++i) {
      lines.push_back(format("%2d %-18s %-34s %s", tried->id, tried->name.c_str(), methods[i].name().c_str(),
                             failed_from[i].empty() ? "holds" : failed_from[i].c_str()));
    }
    suite.add(rows, lines, tried->name);
  }
  suite.finish();
  return 0;
}

}  // namespace raylab::bench
