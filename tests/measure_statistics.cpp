#include <cmath>

#include "catch.hpp"
#include "raylab/measure/statistics.hpp"

using namespace raylab;

TEST_CASE("the interval of a proportion is Clopper and Pearson's", "[unit][measure]") {
  // Of none of n the upper end is 1 - (alpha/2)^(1/n).
  const Interval none = proportion_interval(0, 20000, 0.95);
  CHECK(none.low == 0.0);
  CHECK(none.high == Approx(1.0 - std::pow(0.025, 1.0 / 20000.0)).epsilon(1e-9));
  CHECK(none.high == Approx(184e-6).epsilon(0.01));
  const Interval all = proportion_interval(10, 10, 0.95);
  CHECK(all.low == Approx(std::pow(0.025, 0.1)));
  CHECK(all.high == 1.0);
  // R: binom.test(3, 20)$conf.int
  const Interval some = proportion_interval(3, 20, 0.95);
  CHECK(some.low == Approx(0.03207094).epsilon(1e-5));
  CHECK(some.high == Approx(0.3789268).epsilon(1e-5));
}

TEST_CASE("the median's interval by the sign test leaves out as many values as it may at either end",
          "[unit][measure]") {
  std::vector<double> values;
  for (int i = 10; i >= 1; --i) values.push_back(i);
  // Of ten, P(at most one below the median) = 11/1024 < 0.025 < 56/1024.
  CHECK(median_interval(values, 0.95).low == 2.0);
  CHECK(median_interval(values, 0.95).high == 9.0);
  CHECK(median_interval(values, 0.5).low == 4.0);
  CHECK(std::isinf(median_interval({1.0, 2.0, 3.0, 4.0, 5.0}, 0.95).low));
  CHECK(median_interval({6.0, 5.0, 4.0, 3.0, 2.0, 1.0}, 0.95).high == 6.0);
}

TEST_CASE("the sign test counts the values above", "[unit][measure]") {
  CHECK(sign_test_above({2.0, 2.0, 2.0, 0.5}, 1.0) == Approx(5.0 / 16.0));
  CHECK(sign_test_above({2.0, 2.0, 2.0, 1.0}, 1.0) == Approx(1.0 / 8.0));
  CHECK(sign_test_above({0.5, 0.5}, 1.0) == 1.0);
}

TEST_CASE("Holm's correction multiplies the smallest p by the most, and keeps the order", "[unit][measure]") {
  const std::vector<double> corrected = holm_corrected({0.01, 0.04, 0.03, 0.5});
  CHECK(corrected[0] == Approx(0.04));
  CHECK(corrected[2] == Approx(0.09));
  CHECK(corrected[1] == Approx(0.09));
  CHECK(corrected[3] == Approx(0.5));
}

TEST_CASE("the ratio of pairs has the interval of Student's t of its logarithms, and what pairs share drops out",
          "[unit][measure]") {
  // scipy: stats.ttest_1samp(numpy.log([2, 4, 2]), 0).confidence_interval()
  const RatioEstimate ratio = ratio_of_pairs({2.0, 40.0, 600.0}, {1.0, 10.0, 300.0}, 0.95);
  CHECK(ratio.mean == Approx(std::cbrt(16.0)));
  CHECK(ratio.interval.low == Approx(0.9324613).epsilon(1e-6));
  CHECK(ratio.interval.high == Approx(6.80950963).epsilon(1e-6));
  const RatioEstimate sure = ratio_of_pairs({2.0, 20.0}, {1.0, 10.0}, 0.95);
  CHECK(sure.interval.low == 2.0);
  CHECK(sure.interval.high == 2.0);
}
