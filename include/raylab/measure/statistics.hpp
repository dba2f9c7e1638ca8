#pragma once
#include <vector>

namespace raylab {

/// Where repeated measurements of one quantity lie.
struct Spread {
  double median = 0.0;
  double min = 0.0;
  double max = 0.0;
};

/// Of at least one value; the median of an even number is the mean of the middle two.
Spread spread_of(std::vector<double> values);

/// Mean of independent values, and its standard error; that of a single one is infinite.
struct MeanAndError {
  double mean = 0.0;
  double error = 0.0;
};
MeanAndError mean_and_error(const std::vector<double>& values);

}  // namespace raylab
