#include "raylab/measure/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "raylab/core/check.hpp"

namespace raylab {

Spread spread_of(std::vector<double> values) {
  RAYLAB_CHECK(!values.empty());
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return {0.5 * (values[(n - 1) / 2] + values[n / 2]), values.front(), values.back()};
}

MeanAndError mean_and_error(const std::vector<double>& values) {
  RAYLAB_CHECK(!values.empty());
  const auto n = static_cast<double>(values.size());
  double sum = 0.0;
  for (const double v : values) sum += v;
  const double mean = sum / n;
  if (values.size() < 2) return {mean, std::numeric_limits<double>::infinity()};
  double squares = 0.0;
  for (const double v : values) squares += (v - mean) * (v - mean);
  return {mean, std::sqrt(squares / (n - 1.0) / n)};
}

}  // namespace raylab
