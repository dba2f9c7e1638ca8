#include "raylab/render/sample_map.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "raylab/core/parallel.hpp"

namespace raylab {

namespace {

// Wider windows blur what is noisy and what is not, narrower ones know too little of it: 2 and 4 give up to 3% more
// error on some scene.
constexpr int kReach = 3;
constexpr std::uint64_t kUnit = 4096;
constexpr std::uint64_t kLeastShare = kUnit / 4;
constexpr std::uint64_t kMostShare = kUnit * 8;
static_assert(kMostShare * 6 / 5 <= kUnit * SampleMap::kMost, "rounded() adds up to a fifth");
// Noise below a thousandth of the radiance counts as so much, and what has no more everywhere is sampled evenly. The
// root of relative_variance().
constexpr double kLeastDeviation = 16.0;
constexpr int kScaleBits = 24;  // counts are shares times a scale in units of 2^-24
constexpr std::size_t kClasses = 32768;

/// The largest number up to `most` for which total(number) is no more than `budget`; total grows.
template <class Total>
std::uint64_t largest(std::uint64_t most, std::uint64_t budget, const Total& total) {
  std::uint64_t low = 0, high = most + 1;
  while (high - low > 1) {
    const std::uint64_t middle = low + (high - low) / 2;
    (total(middle) <= budget ? low : high) = middle;
  }
  return low;
}

/// To a power of two or 1.5 times one, up to which Sobol points are stratified: against counts as they come, the globe
/// has 5% less error, and no scene more.
std::uint64_t rounded(std::uint64_t count) {
  if (count < 2) return count;
  const std::uint64_t half = std::bit_floor(count) / 2;
  return (count + half / 2) / half * half;
}

/// Variance of one sample over radiance^2 + 0.01, in units of 2^-27. The pixel's own mean keeps that of rare bright
/// samples below kPilot: where one in a window of neighbours meant more, it would take samples from all others by
/// chance, and did harm in each scene that has such samples.
std::uint32_t relative_variance(const Film& film, int x, int y) {
  const dvec3 mean(film.mean(x, y));
  const dvec3 relative = film.variance_of_mean(x, y) / (mean * mean + 0.01);
  const double variance = film.samples(x, y) * (relative.x + relative.y + relative.z) / 3.0;
  return static_cast<std::uint32_t>(std::min(variance, double{SampleMap::kPilot}) * 0x1p27);
}

}  // namespace

SampleMap::SampleMap(const Film& pilot, const PixelRect& region) : region_(region) {
  const int width = region.width, height = region.height;
  classes_.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  std::vector<std::uint32_t> variances(classes_.size());
  parallel_for(static_cast<std::size_t>(height), [&](std::size_t row) {
    const int y = region.y + static_cast<int>(row);
    for (int x = region.x; x < region.x + width; ++x) variances[index(x, y)] = relative_variance(pilot, x, y);
  });

  for (auto& shares : shares_) shares.resize(kClasses);
  // Sums of each column over the rows of the window, by colour.
  std::array<std::vector<std::uint64_t>, 2> columns;
  for (auto& column : columns) column.resize(static_cast<std::size_t>(width));
  const auto take_row = [&](int y, std::uint64_t sign) {
    if (y < 0 || y >= height) return;
    for (int x = 0; x < width; ++x) {
      const auto i = static_cast<std::size_t>(x);
      columns[color(region.x + x, region.y + y)][i] += sign * variances[index(region.x + x, region.y + y)];
    }
  };
  for (int y = 0; y < kReach; ++y) take_row(y, 1);
  for (int y = 0; y < height; ++y) {
    take_row(y + kReach, 1);
    take_row(y - kReach - 1, ~std::uint64_t{0});
    const int rows = std::min(y + kReach, height - 1) - std::max(y - kReach, 0) + 1;
    for (int x = 0; x < width; ++x) {
      const int px = region.x + x, py = region.y + y;
      const std::vector<std::uint64_t>& others = columns[1 - color(px, py)];
      const int first = std::max(x - kReach, 0), last = std::min(x + kReach, width - 1);
      std::uint64_t sum = 0;
      for (int i = first; i <= last; ++i) sum += others[static_cast<std::size_t>(i)];
      const double mean = static_cast<double>(sum) / (rows * (last - first + 1));
      // The upper half of a float without its sign: steps of less than 1%.
      const auto deviation = static_cast<float>(std::max(std::sqrt(mean), kLeastDeviation));
      const auto c = static_cast<std::uint16_t>(std::bit_cast<std::uint32_t>(deviation) >> 16);
      classes_[index(px, py)] = c;
      ++shares_[color(px, py)][c].pixels;
    }
  }

  for (std::vector<Class>& shares : shares_) {
    std::uint64_t pixels = 0;
    for (const Class& c : shares) pixels += c.pixels;
    const auto share = [](std::size_t c, std::uint64_t scale) {
      const auto deviation = static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(c) << 16));
      const double wanted = deviation * static_cast<double>(scale) * 0x1p-16;
      return std::clamp(static_cast<std::uint64_t>(std::min(wanted, static_cast<double>(kMostShare))), kLeastShare,
                        kMostShare);
    };
    const std::uint64_t scale = largest(std::uint64_t{1} << 40, pixels * kUnit, [&](std::uint64_t tried) {
      std::uint64_t total = 0;
      for (std::size_t c = 0; c < kClasses; ++c) {
        if (shares[c].pixels > 0) total += shares[c].pixels * share(c, tried);
      }
      return total;
    });
    for (std::size_t c = 0; c < kClasses; ++c) {
      if (shares[c].pixels > 0) shares[c].share = share(c, scale);  // others may be the bits of no number
    }
  }
}

SampleMap::Counts SampleMap::counts(std::uint32_t mean) const {
  Counts counts;
  for (std::size_t color = 0; color < 2; ++color) {
    const std::vector<Class>& shares = shares_[color];
    const auto samples = [&](std::size_t c, std::uint64_t scale) {
      return std::max<std::uint64_t>(rounded((shares[c].share * scale) >> kScaleBits), kPilot);
    };
    const auto total = [&](std::uint64_t scale) {
      std::uint64_t sum = 0;
      for (std::size_t c = 0; c < kClasses; ++c) {
        if (shares[c].pixels > 0) sum += shares[c].pixels * samples(c, scale);
      }
      return sum;
    };
    std::uint64_t pixels = 0;
    for (const Class& c : shares) pixels += c.pixels;
    // Up to what gives the mean where no pixel has kPilot for want of more, so that kMost holds.
    const std::uint64_t nominal = (std::uint64_t{mean} << kScaleBits) / kUnit;
    const std::uint64_t scale = largest(nominal, pixels * mean, total);
    counts.total += total(scale);
    counts.of[color].resize(kClasses);
    for (std::size_t c = 0; c < kClasses; ++c) {
      counts.of[color][c] = static_cast<std::uint32_t>(samples(c, scale));
    }
  }
  return counts;
}

}  // namespace raylab
