#pragma once
// How far a film's picture is from the true one, told from its own samples.
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "raylab/image/film.hpp"

namespace raylab {

/// A picture's relMSE against the picture that endless sampling would give.
struct RelmseEstimate {
  double relmse = std::numeric_limits<double>::infinity();  ///< infinity where no pixel has two samples
  double low = 0.0;                                         ///< of the interval that is to hold it in 95% of pictures
  double high = std::numeric_limits<double>::infinity();
  /// Not where the worst 0.1% of the pixels carry half of it or more, nor where their variance is a bound alone.
  bool reliable = false;

  /// For people: the estimate, the interval, and whether it is not reliable.
  std::string text() const;
  /// As pictures' files have it.
  std::map<std::string, std::string> attributes() const;
};

/// Gathers the estimate, rows at a time.
///
/// The error of a pixel is the sample variance of its mean, less what stratification takes from it. For independent
/// samples what relMSE differs by from the sum of those has the variance 2 sigma^4 / (n (n - 1)), whatever their
/// kurtosis: the samples' squares are in both. For Owen-scrambled Sobol points the means of octaves say how large the
/// covariance of samples is (Film::octave_variance()), and the step from there to the whole is that of a mixture of
/// noise, the variance of which falls as 1/n, and of smooth parts and edges, which falls as n^-1.6.
///
/// The true radiance, in the denominator of relMSE, is not told by the pixel's own mean, which is large where the error
/// is: it is told by its neighbours' means, brought within 1.2 standard deviations of its own.
class RelmseEstimator {
 public:
  /// `sobol`: samples are numbers 0 to n - 1 of Owen-scrambled sequences, and not independent.
  explicit RelmseEstimator(bool sobol);

  /// Adds `count` rows from `first` on. Rows of the film around them are seen as neighbours.
  void add(const Film& film, int first, int count);
  void add(const RelmseEstimator& other);

  RelmseEstimate estimate() const;

 private:
  bool sobol_;
  std::uint64_t pixels_ = 0;
  bool bound_ = false;
  double variance_ = 0.0;            ///< sums over pixels: of relative variance,
  double octave_variance_ = 0.0;     ///< the same of octaves,
  double gain_ = 0.0;                ///< what stratification takes from the first,
  double gain_squares_ = 0.0;        ///< its squares,
  double gain_doubt_ = 0.0;          ///< what other laws than n^-1.6 would change in it,
  double neighbour_products_ = 0.0;  ///< sigma^4,
  std::uint64_t neighbours_ = 0;
  double denominator_doubt_ = 0.0;  ///< what the two ways to see neighbours differ by
  /// Pixels by the upper 11 bits of their variance as a float, to find the worst.
  struct Bin {
    std::uint64_t pixels = 0;
    double variance = 0.0;
  };
  std::vector<Bin> bins_;
};

/// The same of all rows, in parallel; the same bits for any number of threads.
RelmseEstimate estimate_relmse(const Film& film, bool sobol);

}  // namespace raylab
