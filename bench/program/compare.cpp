// raylab-bench compare: what changed between two folders of results.
#include <cstdio>

#include "commands.hpp"
#include "raylab/measure/result_comparison.hpp"

namespace raylab::bench {

namespace {

void print_keys(const char* title, const std::vector<std::string>& keys) {
  if (keys.empty()) return;
  std::printf("%s (%zu)\n", title, keys.size());
  for (const std::string& key : keys) std::printf("  %s\n", key.c_str());
}

}  // namespace

int compare(const CompareOptions& options) {
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
  return 0;
}

}  // namespace raylab::bench
