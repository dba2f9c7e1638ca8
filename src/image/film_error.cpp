#include "raylab/image/film_error.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <unordered_map>

#include "raylab/core/parallel.hpp"
#include "raylab/core/text.hpp"

namespace raylab {

namespace {

constexpr double kEpsilon = 0.01;       // of relMSE
constexpr double kOwnDeviations = 1.2;  // within which neighbours are believed
// What is taken of the error at least for what neighbours do not tell: estimates of denominators were up to 6% low in
// the scenes tried, by no chance that more pixels would even out.
constexpr double kLeastDoubt = 0.04;
constexpr int kBand = 16;  // rows

/// Variance of the mean of the first n points of a scrambled net for a part of the integrand that falls as n^-power,
/// 1 at n = 1. Samples whose indices part at the same bit have the same covariance.
double net_variance(std::uint32_t n, double power) {
  const double whole = std::bit_floor(n), rest = n - whole;
  const double alone = std::pow(whole, -power);
  if (rest == 0.0) return alone;
  const double covariance = 2.0 * std::pow(2.0 * whole, -power) - alone;
  return (whole * whole * alone + rest * rest * net_variance(n - std::bit_floor(n), power) +
          2.0 * whole * rest * covariance) /
         (static_cast<double>(n) * n);
}

/// By how much more the error is below the sample variance than the octaves' variance is, for a mixture of such a part
/// and independent noise.
double gain_factor(std::uint32_t n, double power) {
  const double early = std::bit_floor(n - 1), late = n - early;
  const double alone = std::pow(early, -power);
  const double of_octaves =
      early * late / (static_cast<double>(n) * n) *
      (alone + net_variance(n - std::bit_floor(n - 1), power) - 2.0 * (2.0 * std::pow(2.0 * early, -power) - alone));
  const double of_mean = net_variance(n, power);
  const double of_samples = (1.0 - of_mean) / (n - 1.0);
  return of_samples > of_octaves ? (of_samples - of_mean) / (of_samples - of_octaves)
                                 : std::numeric_limits<double>::infinity();
}

/// A pixel as its neighbours see it.
struct Seen {
  bool is_there = false;
  dvec3 mean, variance;
};

std::vector<Seen> seen_row(const Film& film, int y) {
  std::vector<Seen> row(static_cast<std::size_t>(film.width()));
  if (y < 0 || y >= film.height()) return row;
  for (int x = 0; x < film.width(); ++x) {
    if (film.samples(x, y) < 2) continue;
    row[static_cast<std::size_t>(x)] = {true, dvec3(film.mean(x, y)), film.variance_of_mean(x, y)};
  }
  return row;
}

/// Two estimates of 1 / (radiance^2 + 0.01): the mean of it over the neighbours, and that of the neighbours' mean.
struct Weights {
  dvec3 of_each, of_mean;
};

Weights weights_at(const std::vector<Seen>* const (&rows)[3], std::size_t x) {
  const Seen& own = (*rows[1])[x];
  const dvec3 reach = kOwnDeviations * glm::sqrt(own.variance);
  const dvec3 low = own.mean - reach, high = own.mean + reach;
  dvec3 weight(0.0), mean(0.0);
  int count = 0;
  for (int dy = 0; dy < 3; ++dy) {
    const std::vector<Seen>& row = *rows[dy];
    for (std::size_t i = x == 0 ? 0 : x - 1; i < std::min(x + 2, row.size()); ++i) {
      if (!row[i].is_there || (dy == 1 && i == x)) continue;
      const dvec3 seen = glm::clamp(row[i].mean, low, high);
      weight += 1.0 / (seen * seen + kEpsilon);
      mean += row[i].mean;
      ++count;
    }
  }
  if (count == 0) {
    weight = 1.0 / (own.mean * own.mean + kEpsilon);
    return {weight, weight};
  }
  const dvec3 seen = glm::clamp(mean / static_cast<double>(count), low, high);
  return {weight / static_cast<double>(count), 1.0 / (seen * seen + kEpsilon)};
}

double sum(const dvec3& v) { return v.x + v.y + v.z; }

/// Quantile of chi squared over its degrees of freedom (Wilson and Hilferty 1931).
double chi_squared_ratio(double freedom, double normal_quantile) {
  const double s = 2.0 / (9.0 * freedom);
  const double root = std::max(1.0 - s + normal_quantile * std::sqrt(s), 0.0);
  return root * root * root;
}

}  // namespace

std::string RelmseEstimate::text() const {
  return format("%.3g, 95%% interval %.3g to %.3g%s", relmse, low, high,
                reliable ? "" : "; not reliable: a few pixels carry most of it");
}

std::map<std::string, std::string> RelmseEstimate::attributes() const {
  return {{"raylab.estimatedRelmse", std::to_string(relmse)},
          {"raylab.estimatedRelmse95", format("%.6g to %.6g", low, high)},
          {"raylab.estimatedRelmseReliable", reliable ? "true" : "false"}};
}

RelmseEstimator::RelmseEstimator(bool sobol) : sobol_(sobol), bins_(2048) {}

void RelmseEstimator::add(const Film& film, int first, int count) {
  std::vector<Seen> seen[3] = {{}, seen_row(film, first - 1), seen_row(film, first)};
  struct Factors {
    double gain, doubt;
  };
  // By numbers of samples, of which even a film that has more where the error is has few.
  std::unordered_map<std::uint32_t, Factors> known;
  const auto factors_of = [&known](std::uint32_t n) {
    const auto [at, is_new] = known.try_emplace(n);
    if (is_new) {
      at->second = {gain_factor(n, 1.6), (gain_factor(n, 1.5) - gain_factor(n, 2.0)) / 2.0};
      // Too little of the octave is taken for it to say much.
      if (!(at->second.gain < 4.0)) at->second = {0.0, 0.0};
    }
    return at->second;
  };
  for (int y = first; y < first + count; ++y) {
    seen[0] = std::move(seen[1]);
    seen[1] = std::move(seen[2]);
    seen[2] = seen_row(film, y + 1);
    const std::vector<Seen>* const rows[3] = {&seen[0], &seen[1], &seen[2]};
    double before = -1.0;  // of the pixel to the left, if there is one
    for (int x = 0; x < film.width(); ++x) {
      const auto i = static_cast<std::size_t>(x);
      if (!seen[1][i].is_there) {
        before = -1.0;
        continue;
      }
      const Weights weights = weights_at(rows, i);
      const dvec3 weight = (weights.of_each + weights.of_mean) / 6.0;  // over three channels
      const double variance = sum(weight * seen[1][i].variance);
      const std::uint32_t n = film.samples(x, y);
      ++pixels_;
      variance_ += variance;
      denominator_doubt_ += sum((weights.of_each - weights.of_mean) * seen[1][i].variance) / 3.0;
      bound_ |= film.variance_is_bound(x, y);
      Bin& bin = bins_[std::bit_cast<std::uint32_t>(static_cast<float>(variance)) >> 20];
      ++bin.pixels;
      bin.variance += variance;
      const double deviation = variance * std::sqrt(n / (n - 1.0));
      if (before >= 0.0) {
        neighbour_products_ += before * deviation;
        ++neighbours_;
      }
      before = deviation;
      const std::optional<dvec3> octaves = sobol_ ? film.octave_variance(x, y) : std::nullopt;
      if (!octaves) {
        octave_variance_ += variance;
        continue;
      }
      const Factors factors = factors_of(n);
      const double octave_variance = sum(weight * *octaves);
      octave_variance_ += octave_variance;
      const double gain = factors.gain * (variance - octave_variance);
      gain_ += gain;
      gain_squares_ += gain * gain;
      gain_doubt_ += factors.doubt * (variance - octave_variance);
    }
  }
}

void RelmseEstimator::add(const RelmseEstimator& other) {
  pixels_ += other.pixels_;
  bound_ |= other.bound_;
  variance_ += other.variance_;
  octave_variance_ += other.octave_variance_;
  gain_ += other.gain_;
  gain_squares_ += other.gain_squares_;
  gain_doubt_ += other.gain_doubt_;
  neighbour_products_ += other.neighbour_products_;
  neighbours_ += other.neighbours_;
  denominator_doubt_ += other.denominator_doubt_;
  for (std::size_t i = 0; i < bins_.size(); ++i) {
    bins_[i].pixels += other.bins_[i].pixels;
    bins_[i].variance += other.bins_[i].variance;
  }
}

RelmseEstimate RelmseEstimator::estimate() const {
  if (pixels_ == 0) return {};
  const auto pixels = static_cast<double>(pixels_);
  // The error of points in a net falls as n^-2 for a smooth integrand, a third of what the octaves differ by.
  const double total = std::max(variance_ - gain_, octave_variance_ / 3.0);
  if (total == 0.0) return {0.0, 0.0, 0.0, !bound_};
  const double share = total / variance_;
  double fourth = neighbours_ > 0 ? neighbour_products_ * pixels / static_cast<double>(neighbours_) : 0.0;
  fourth = std::max(fourth, variance_ * variance_ / pixels);  // as much as if all pixels were alike
  const double spread = 2.0 * fourth * share * share + std::max(gain_squares_ - gain_ * gain_ / pixels, 0.0) +
                        gain_doubt_ * gain_doubt_ + 0.5 * denominator_doubt_ * denominator_doubt_ * share * share +
                        kLeastDoubt * kLeastDoubt * total * total;
  const double freedom = 2.0 * total * total / spread;

  double worst = 0.0;
  std::uint64_t left = (pixels_ + 999) / 1000;
  for (std::size_t i = bins_.size(); i-- > 0 && left > 0;) {
    if (bins_[i].pixels == 0) continue;
    const std::uint64_t taken = std::min(left, bins_[i].pixels);
    worst += bins_[i].variance * static_cast<double>(taken) / static_cast<double>(bins_[i].pixels);
    left -= taken;
  }
  constexpr double kTwoSided95 = 1.959964;
  return {total / pixels, total / pixels * chi_squared_ratio(freedom, -kTwoSided95),
          total / pixels * chi_squared_ratio(freedom, kTwoSided95), !bound_ && worst < 0.5 * variance_};
}

RelmseEstimate estimate_relmse(const Film& film, bool sobol) {
  const int bands = (film.height() + kBand - 1) / kBand;
  std::vector<RelmseEstimator> parts(static_cast<std::size_t>(bands), RelmseEstimator(sobol));
  parallel_for(parts.size(), [&](std::size_t i) {
    const int first = static_cast<int>(i) * kBand;
    parts[i].add(film, first, std::min(kBand, film.height() - first));
  });
  for (std::size_t i = 1; i < parts.size(); ++i) parts[0].add(parts[i]);
  return parts[0].estimate();
}

}  // namespace raylab
