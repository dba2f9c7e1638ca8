#pragma once
// Statistics that tests decide by. Seeds are fixed, so a test that passes once passes always; the limits leave a
// sound program a chance of about 1 in 10,000 of failing when a seed or a compiler changes.
#include <cmath>
#include <limits>
#include <vector>

namespace raylab::test {

/// Chi-square test of counts against their expectations (the same total): by how many standard deviations the
/// statistic lies above what chance gives, after Wilson and Hilferty 1931. Cells that expect fewer than 10 are
/// taken together. Infinity where much was counted that
/// hardly can happen.
inline double chi_square_z(const std::vector<double>& counted, const std::vector<double>& expected) {
  constexpr double kSmallest = 10.0;
  double statistic = 0.0, pooled_count = 0.0, pooled_expected = 0.0;
  int cells = 0;
  const auto add = [&](double count, double mean) {
    statistic += (count - mean) * (count - mean) / mean;
    ++cells;
  };
  for (std::size_t i = 0; i < counted.size(); ++i) {
    if (expected[i] >= kSmallest) {
      add(counted[i], expected[i]);
    } else {
      pooled_count += counted[i];
      pooled_expected += expected[i];
    }
  }
  if (pooled_expected >= 1.0) {
    add(pooled_count, pooled_expected);
  } else if (pooled_count > kSmallest) {
    return std::numeric_limits<double>::infinity();
  }
  const double k = cells - 1;
  if (!(k >= 1.0)) return 0.0;
  const double spread = 2.0 / (9.0 * k);
  return (std::cbrt(statistic / k) - (1.0 - spread)) / std::sqrt(spread);
}

/// Above this many standard deviations a test fails.
inline constexpr double kLimitZ = 3.8;

}  // namespace raylab::test
