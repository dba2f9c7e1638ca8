// raylab-bench compare: what changed between two folders of results.
#include <cstdio>

#include "commands.hpp"
#include "raylab/core/error.hpp"
#include "raylab/core/text.hpp"
#include "raylab/measure/result_comparison.hpp"
#include "verdicts.hpp"

namespace raylab::bench {

namespace {

void print_keys(const char* title, const std::vector<std::string>& keys) {
  if (keys.empty()) return;
  std::printf("%s (%zu)\n", title, keys.size());
  for (const std::string& key : keys) std::printf("  %s\n", key.c_str());
}

/// How much slower, as a share of the time before: figures of time grow, those of speed shrink.
double slowdown(const ChangedValue& c) {
  return (c.field.find("seconds") != std::string::npos ? c.after / c.before : c.before / c.after) - 1.0;
}

std::vector<Verdict> verdicts(const ResultComparison& comparison, const FailOn& fail_on) {
  std::vector<Verdict> all;
  for (const ChangedValue& c : comparison.changes) {
    const bool slower = c.change == Change::slower && fail_on.slower && slowdown(c) > *fail_on.slower;
    const bool wrong = c.change == Change::less_accurate && fail_on.wrong;
    const std::string text =
        format("%s: %s %.4g -> %.4g", std::string(change_name(c.change)).c_str(), c.field.c_str(), c.before, c.after);
    all.push_back({c.key + " " + c.field, slower || wrong ? text : ""});
  }
  return all;
}

}  // namespace

int compare(const CompareOptions& options) {
  if (options.builds.size() == 2) return compare_builds(options);
  if (!options.builds.empty())
    throw Error(ErrorKind::usage, "--build", "found one or more than two, expected the old build and the new one");
  if (options.before.empty()) throw Error(ErrorKind::usage, "compare", "expected two folders, or --build twice");
  const FailOn fail_on = parse_fail_on(options.fail_on);
  const ResultComparison comparison =
      compare_results(read_results(options.before), read_results(options.after), options.any_machine);
  const ChangedValue* last = nullptr;
  for (const ChangedValue& c : comparison.changes) {
    if (last == nullptr || last->change != c.change) std::printf("%s\n", std::string(change_name(c.change)).c_str());
    std::printf("  %s: %s %.4g -> %.4g", c.key.c_str(), c.field.c_str(), c.before, c.after);
    if (c.before != 0.0) std::printf(" (%.3f times)", c.after / c.before);
    std::printf("\n");
    last = &c;
  }
  std::printf("%zu figures changed, %zu did not, beyond their noise\n", comparison.changes.size(),
              comparison.unchanged);
  print_keys("only in the old results", comparison.only_before);
  print_keys("only in the new results", comparison.only_after);
  return conclude("compare", verdicts(comparison, fail_on), options.junit);
}

}  // namespace raylab::bench
