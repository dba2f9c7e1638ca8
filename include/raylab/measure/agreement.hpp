#pragma once
// How an accelerator's answers differ from those of another that is taken for right.
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "raylab/accel/accelerator.hpp"

namespace raylab {

/// One ray and what became of it; enough to replay.
struct Disagreement {
  Ray ray;
  std::optional<Hit> tested;
  std::optional<Hit> judged;
};

/// How often one kind of disagreement was met, and the first of them in the order of the rays.
struct Finding {
  std::size_t count = 0;
  std::optional<Disagreement> first;
};

/// Distribution of |t tested - exact t of the primitive judged to be hit|, in ulp of the latter.
struct UlpError {
  double p50 = 0.0;
  double p99 = 0.0;
  double max = 0.0;
};

/// What compare_hits found. A difference counts where floats leave no doubt: where the nearer of the two
/// answers is in question, the exact line must pass farther from the outline of that primitive (edges of a
/// triangle, silhouette of a sphere) than 8 ulp of the largest coordinate involved, and its t must be that far
/// from both ends of the ray's interval. The others are `undecided`.
struct AgreementReport {
  std::size_t rays = 0;
  std::size_t hits = 0;  ///< of the judge
  Finding false_misses;
  Finding false_hits;
  /// Both hit, but the points are more than 8 ulp apart along the normal, or the primitive named is not there.
  Finding wrong_primitives;
  Finding occlusion;  ///< occluded() of the tested one is not what its own intersect() says
  Finding batches;    ///< a batch has other answers than its rays one by one: see different_batches
  std::size_t undecided = 0;
  UlpError t_error_ulp;  ///< where both hit the same primitive, or at the same place

  bool agrees() const {
    return false_misses.count + false_hits.count + wrong_primitives.count + occlusion.count + batches.count == 0;
  }
};

/// Sends every ray through both. The geometry is the one both were built for.
AgreementReport compare_hits(const Accelerator& tested, const Accelerator& judge, const Geometry& geometry,
                             std::span<const Ray> rays);

/// Rays that intersect_batch or occluded_batch answers otherwise than intersect or occluded do, in batches of many
/// sizes. It is for accelerators that promise equal ones (AcceleratorCapabilities::batch_equals_single).
Finding different_batches(const Accelerator& tested, std::span<const Ray> rays);

/// Rays that go through a closed surface: all of `rays_from_inside` must hit.
Finding find_leaks(const Accelerator& tested, std::span<const Ray> rays_from_inside);

/// Distance from the exact line of the ray to the outline of the primitive, in scene units: the nearest edge of a
/// triangle, the silhouette of a sphere.
double distance_to_outline(const Ray& ray, const Geometry& geometry, const PrimitiveId& id);

/// The counts in one line, then the first example of each kind with its floats in hexadecimal.
std::string to_string(const AgreementReport& report);
std::string to_string(const Disagreement& disagreement);

}  // namespace raylab
