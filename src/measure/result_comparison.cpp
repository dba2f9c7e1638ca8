#include "raylab/measure/result_comparison.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "raylab/core/error.hpp"

namespace raylab {

namespace {

/// Below this a change means nothing, whatever the repeats say.
constexpr double kSmallestChange = 0.01;

/// A figure and the range it varies in.
struct Figure {
  double value, low, high;
};

std::optional<double> number(const Row& row, const std::string& field) {
  const auto found = row.find(field);
  if (found == row.end() || !found->is_number()) return std::nullopt;
  return found->get<double>();
}

/// A figure that is stored as {median, min, max}, or as field, field_min and field_max.
std::optional<Figure> spread_figure(const Row& row, const std::string& field) {
  if (row.contains(field) && row[field].is_object()) {
    const Row& spread = row[field];
    const auto median = number(spread, "median"), min = number(spread, "min"), max = number(spread, "max");
    if (!median || !min || !max) return std::nullopt;
    return Figure{*median, *min, *max};
  }
  const auto value = number(row, field);
  if (!value) return std::nullopt;
  return Figure{*value, number(row, field + "_min").value_or(*value), number(row, field + "_max").value_or(*value)};
}

bool ranges_differ(const Figure& a, const Figure& b) {
  return (a.high < b.low || b.high < a.low) && std::abs(b.value - a.value) > kSmallestChange * std::abs(a.value);
}

/// Wrong answers of a kind for each ray checked: both runs need not have checked as many.
std::optional<Figure> rate_figure(const Row& row, const std::string& field) {
  const auto count = number(row, field), rays = number(row, "rays_checked");
  if (!count || !rays || *rays <= 0.0) return std::nullopt;
  const double rate = *count / *rays;
  return Figure{rate, rate, rate};
}

class Comparison {
 public:
  void compare(const std::string& key, const Row& before, const Row& after) {
    const auto by_spread = [&](const char* field, Change down, Change up) {
      const auto a = spread_figure(before, field), b = spread_figure(after, field);
      if (a && b) note(key, field, *a, *b, ranges_differ(*a, *b), down, up);
    };
    by_spread("mrays_per_second", Change::slower, Change::faster);
    by_spread("mrays_per_second_batch", Change::slower, Change::faster);
    by_spread("build_seconds", Change::faster, Change::slower);
    by_spread("seconds", Change::faster, Change::slower);
    by_spread("process_seconds", Change::faster, Change::slower);
    by_spread("bytes", Change::smaller, Change::larger);
    for (const char* field : {"leaks", "false_misses", "false_hits", "wrong_primitives", "wrong", "wrong_batch"}) {
      const auto a = rate_figure(before, field), b = rate_figure(after, field);
      if (a && b) note(key, field, *a, *b, a->value != b->value, Change::more_accurate, Change::less_accurate);
    }
    compare_relmse(key, before, after);
  }

  ResultComparison result;

 private:
  void compare_relmse(const std::string& key, const Row& before, const Row& after) {
    const auto a = number(before, "relmse"), b = number(after, "relmse");
    const auto ea = number(before, "relmse_error"), eb = number(after, "relmse_error");
    if (!a || !b || !ea || !eb) return;
    const bool differ = std::abs(*b - *a) > 2.0 * std::hypot(*ea, *eb);
    note(key, "relmse", {*a, *a, *a}, {*b, *b, *b}, differ, Change::more_accurate, Change::less_accurate);
  }

  void note(const std::string& key, const std::string& field, const Figure& a, const Figure& b, bool differ,
            Change down, Change up) {
    if (differ) {
      result.changes.push_back({b.value < a.value ? down : up, key, field, a.value, b.value});
    } else {
      ++result.unchanged;
    }
  }
};

std::string machine_text(const Row& machine) {
  const auto text = [&](const char* field) {
    const Row value = machine.value(field, Row("unknown"));
    return value.is_string() ? value.get<std::string>() : value.dump();
  };
  return text("cpu") + ", " + text("threads") + " threads, " + text("memory_gib") + " GiB";
}

}  // namespace

std::string_view change_name(Change change) {
  constexpr std::array kNames{"faster", "slower", "more accurate", "less accurate", "smaller", "larger"};
  return kNames[static_cast<std::size_t>(change)];
}

ResultComparison compare_results(const Results& before, const Results& after, bool any_machine) {
  if (!any_machine && !same_machine(before.machine, after.machine)) {
    throw Error(ErrorKind::usage, "compare",
                "the results are of two machines (" + machine_text(before.machine) + "; " +
                    machine_text(after.machine) +
                    "): their times say nothing of each other; --any-machine compares them");
  }
  std::map<std::string, const Row*> old_rows;
  for (const Row& row : before.rows) old_rows[row_key(row)] = &row;
  Comparison comparison;
  for (const Row& row : after.rows) {
    const std::string key = row_key(row);
    const auto old = old_rows.find(key);
    if (old == old_rows.end()) {
      comparison.result.only_after.push_back(key);
    } else {
      comparison.compare(key, *old->second, row);
      old_rows.erase(old);
    }
  }
  for (const Row& row : before.rows) {
    if (old_rows.count(row_key(row)) > 0) comparison.result.only_before.push_back(row_key(row));
  }
  auto& changes = comparison.result.changes;
  std::stable_sort(changes.begin(), changes.end(), [](const auto& a, const auto& b) { return a.change < b.change; });
  return std::move(comparison.result);
}

}  // namespace raylab
