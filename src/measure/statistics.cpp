#include "raylab/measure/statistics.hpp"

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <numeric>

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

Interval proportion_interval(std::size_t count, std::size_t trials, double confidence) {
  RAYLAB_CHECK(trials > 0 && count <= trials);
  using boost::math::binomial;
  const auto n = static_cast<double>(trials), k = static_cast<double>(count);
  const double tail = 0.5 * (1.0 - confidence);
  return {binomial::find_lower_bound_on_p(n, k, tail),
          count == trials ? 1.0 : binomial::find_upper_bound_on_p(n, k, tail)};
}

Interval median_interval(std::vector<double> values, double confidence) {
  RAYLAB_CHECK(!values.empty());
  std::sort(values.begin(), values.end());
  const boost::math::binomial below(static_cast<double>(values.size()), 0.5);
  // The most values that can be left out at either end.
  std::size_t outside = 0;
  while (2 * outside < values.size() &&
         boost::math::cdf(below, static_cast<double>(outside)) <= 0.5 * (1.0 - confidence))
    ++outside;
  if (outside == 0) return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  return {values[outside - 1], values[values.size() - outside]};
}

RatioEstimate ratio_of_pairs(const std::vector<double>& values, const std::vector<double>& others, double confidence) {
  RAYLAB_CHECK(values.size() == others.size() && values.size() > 1);
  std::vector<double> logarithms;
  for (std::size_t i = 0; i < values.size(); ++i) logarithms.push_back(std::log(values[i] / others[i]));
  const MeanAndError log_ratio = mean_and_error(logarithms);
  const boost::math::students_t distribution(static_cast<double>(values.size() - 1));
  const double off = log_ratio.error * boost::math::quantile(distribution, 0.5 + 0.5 * confidence);
  return {std::exp(log_ratio.mean), {std::exp(log_ratio.mean - off), std::exp(log_ratio.mean + off)}};
}

double sign_test_above(const std::vector<double>& values, double median) {
  const auto above = std::count_if(values.begin(), values.end(), [&](double v) { return v > median; });
  const auto below = std::count_if(values.begin(), values.end(), [&](double v) { return v < median; });
  if (above == 0) return 1.0;
  const boost::math::binomial distribution(static_cast<double>(above + below), 0.5);
  return boost::math::cdf(boost::math::complement(distribution, static_cast<double>(above - 1)));
}

std::vector<double> holm_corrected(const std::vector<double>& p_values) {
  std::vector<std::size_t> order(p_values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return p_values[a] < p_values[b]; });
  std::vector<double> corrected(p_values.size());
  double most = 0.0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    most = std::max(most, std::min(1.0, static_cast<double>(order.size() - i) * p_values[order[i]]));
    corrected[order[i]] = most;
  }
  return corrected;
}

}  // namespace raylab
