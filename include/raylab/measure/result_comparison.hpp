#pragma once
// What changed between two runs of the same measurements, beyond their noise.
#include <string>
#include <vector>

#include "raylab/measure/results.hpp"

namespace raylab {

enum class Change { faster, slower, more_accurate, less_accurate, smaller, larger };
std::string_view change_name(Change change);

/// One figure that changed.
struct ChangedValue {
  Change change;
  std::string key;    ///< row_key() of both rows
  std::string field;  ///< such as "mrays_per_second"
  double before = 0.0;
  double after = 0.0;

  bool operator==(const ChangedValue&) const = default;
};

struct ResultComparison {
  std::vector<ChangedValue> changes;                 ///< by kind, then in the order of the new rows
  std::size_t unchanged = 0;                         ///< figures within their noise
  std::vector<std::string> only_before, only_after;  ///< keys of rows without a counterpart
};

/// Compares rows of equal key. A time or speed has changed when the ranges of its repeats do not overlap and the
/// medians are more than 1% apart; a relMSE when its means are more than two standard errors of their difference
/// apart; counts of wrong answers and bytes, which do not vary, when they are not equal.
/// Throws Error (usage) when the results are of two machines, unless `any_machine`.
ResultComparison compare_results(const Results& before, const Results& after, bool any_machine);

}  // namespace raylab
