#pragma once
// How often an accelerator errs, judged by the exact answer: what every figure of speed is shown beside.
#include <cstddef>
#include <span>

#include "raylab/measure/agreement.hpp"

namespace raylab {

/// Whether geometry encloses volumes, so that no ray may pass from one side to the other unhindered.
enum class Surface { open, closed };

/// What judge_hits found. The kinds overlap: a ray through the middle of a triangle of a closed surface that the
/// accelerator lets pass is a leak and a false miss. Each Finding holds its count and the first such ray with both
/// answers; to_string(Disagreement) tells it so that it can be replayed.
struct HitErrors {
  std::size_t rays_checked = 0;
  std::size_t hits = 0;  ///< of the exact answer
  /// Closed surfaces only: the exact ray, and the rays close around it, meet the surface, and the accelerator
  /// finds nothing, or only what lies behind. On an edge or a vertex too, unless it is part of the silhouette.
  Finding leaks;
  Finding false_misses;  ///< nothing found, where the exact ray is clear of the outline of what it hits
  Finding false_hits;    ///< something found, where the exact ray meets nothing and is clear of that outline
  /// Presence agrees, but the points are more than 8 ulp of the largest coordinate apart along the normal, or the
  /// primitive named is not there.
  Finding wrong_primitives;
  std::size_t undecided = 0;  ///< differences within 8 ulp of an outline or of an end of the interval: not errors
  UlpError t_error_ulp;       ///< in ulp of the exact t, where both hit the same primitive, or at the same place
};

/// Judges the hits of an accelerator by those of `exact`, which was built for the same geometry. Clear of an
/// outline is farther than 8 ulp of the largest coordinate involved from the edges of the triangle or the
/// silhouette of the sphere. Runs on all threads allowed; the result does not depend on their number.
HitErrors judge_hits(const Geometry& geometry, const Accelerator& judged, const Accelerator& exact,
                     std::span<const Ray> rays, Surface surface);

}  // namespace raylab
