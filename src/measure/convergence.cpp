#include "raylab/measure/convergence.hpp"

#include <algorithm>
#include <cmath>

#include "raylab/core/check.hpp"
#include "raylab/measure/statistics.hpp"

namespace raylab {

Reference make_reference(const Image& half, const Image& other_half) {
  (void)image_error(half, other_half);  // sizes
  Reference reference{half, 0.0, 0.0};
  for (std::size_t i = 0; i < half.pixels.size(); ++i) {
    reference.image.pixels[i] = 0.5f * half.pixels[i] + 0.5f * other_half.pixels[i];
  }
  // A half is off from the mean by half the difference of the halves, and so, in the mean square, is the mean
  // itself from the truth: its variance is half that of a half, the difference's twice.
  const ImageError own = image_error(half, reference.image);
  reference.relmse = own.relmse;
  reference.mean_ratio_error = own.mean_ratio_error;
  return reference;
}

RunErrors combine(const std::vector<ImageError>& runs, const Reference& reference) {
  RAYLAB_CHECK(!runs.empty());
  const auto n = static_cast<double>(runs.size());
  std::vector<double> relmse;
  RunErrors all{0.0, 0.0, 0.0, 0.0, 0.0};
  double variance = 0.0;  // of one run's mean ratio, the reference's share taken out
  const double shared = reference.mean_ratio_error * reference.mean_ratio_error;
  for (const ImageError& run : runs) {
    relmse.push_back(run.relmse);
    all.relmse_trimmed += run.relmse_trimmed / n;
    all.mean_ratio += run.mean_ratio / n;
    variance += std::max(0.0, run.mean_ratio_error * run.mean_ratio_error - shared) / n;
  }
  const MeanAndError mean = mean_and_error(relmse);
  all.relmse = mean.mean;
  all.relmse_error = mean.error;
  all.mean_ratio_error = std::sqrt(variance / n + shared);
  return all;
}

double own_relmse(double measured, const Reference& reference) {
  return std::max(0.5 * measured, measured - reference.relmse);
}

TimeToError time_to_error(const std::vector<ErrorAtTime>& points, double target) {
  RAYLAB_CHECK(!points.empty() && target > 0.0);
  // Seconds at the target, on the power law of relmse over seconds with this exponent, through this point.
  const auto on_law = [&](const ErrorAtTime& p, double exponent) {
    return p.seconds * std::pow(target / p.relmse, 1.0 / exponent);
  };
  const auto exponent = [](const ErrorAtTime& a, const ErrorAtTime& b) {
    return std::log(b.relmse / a.relmse) / std::log(b.seconds / a.seconds);
  };
  for (std::size_t i = 1; i < points.size(); ++i) {
    const ErrorAtTime& a = points[i - 1];
    const ErrorAtTime& b = points[i];
    if (a.relmse >= target && b.relmse <= target && a.relmse > b.relmse) return {on_law(a, exponent(a, b)), false};
  }
  const ErrorAtTime& end = points.back().relmse > target ? points.back() : points.front();
  return {on_law(end, -1.0), end.relmse != target};
}

}  // namespace raylab
