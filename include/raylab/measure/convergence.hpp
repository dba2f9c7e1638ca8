#pragma once
// How close pictures come to the right one, and how long that takes.
#include <vector>

#include "raylab/image/image.hpp"
#include "raylab/image/metrics.hpp"

namespace raylab {

/// A picture to measure others against, made of two halves with independent random numbers, so that it tells its
/// own error.
struct Reference {
  Image image;                    ///< mean of the halves
  double relmse = 0.0;            ///< of `image`, estimated from the difference of the halves
  double mean_ratio_error = 0.0;  ///< standard error of its mean, relative
};

/// Throws Error (usage) when the halves differ in size.
Reference make_reference(const Image& half, const Image& other_half);

/// Errors of several pictures made with independent random numbers.
struct RunErrors {
  double relmse = 0.0;            ///< mean over the runs; includes the reference's own
  double relmse_error = 0.0;      ///< standard error of that mean, from the spread of the runs; infinite for one run
  double relmse_trimmed = 0.0;    ///< the same without each run's worst 0.1% of the pixels
  double mean_ratio = 1.0;        ///< mean over the runs: the bias
  double mean_ratio_error = 0.0;  ///< its standard error: noise of the runs, and of the reference, which they share
};
RunErrors combine(const std::vector<ImageError>& runs, const Reference& reference);

/// Of a relMSE measured against the reference, what is the picture's own: less the reference's, which adds to it. At
/// least half, since a reference that errs as much as the picture cannot tell how little that errs.
double own_relmse(double measured, const Reference& reference);

/// What was reached after how long.
struct ErrorAtTime {
  double seconds = 0.0;
  double relmse = 0.0;
};

struct TimeToError {
  double seconds = 0.0;
  bool extrapolated = false;  ///< the target lies outside of what was measured
};

/// When the error falls to `target`: by a power law between neighbouring points, and by that of independent samples,
/// error times seconds constant, before the first and after the last. Points are in the order of their seconds; there
/// is at least one.
TimeToError time_to_error(const std::vector<ErrorAtTime>& points, double target);

}  // namespace raylab
