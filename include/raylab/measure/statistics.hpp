#pragma once
#include <cstddef>
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

struct Interval {
  double low = 0.0;
  double high = 0.0;
};

/// The two-sided interval of Clopper and Pearson for the probability of an event that was seen `count` times in
/// `trials` > 0: it holds the probability with at least this confidence, such as 0.95.
Interval proportion_interval(std::size_t count, std::size_t trials, double confidence);

/// Between these two of the values, at least one of which there must be, lies the median of what they are drawn from
/// with at least this confidence, by the sign test; from -infinity to infinity where they are too few.
Interval median_interval(std::vector<double> values, double confidence);

struct RatioEstimate {
  double mean = 1.0;  ///< geometric
  Interval interval;
};

/// How many times as large the first of each pair of positive values is, of at least two pairs: their ratios' geometric
/// mean, and the interval that holds that of endless pairs with this confidence, by Student's t of the logarithms.
RatioEstimate ratio_of_pairs(const std::vector<double>& values, const std::vector<double>& others, double confidence);

/// The sign test: how probable it is that at least as many of the values lie above `median` if that is the median of
/// what they are drawn from. Values equal to it do not count.
double sign_test_above(const std::vector<double>& values, double median);

/// The p values of several tests as Holm corrects them: those below 0.01, say, are significant with a chance of 0.01
/// that any of them is a false alarm.
std::vector<double> holm_corrected(const std::vector<double>& p_values);

}  // namespace raylab
