#pragma once
// Splits of the primitives in two by their centres, binned.
#include <span>

#include "build_box.hpp"

namespace raylab::bvh {

inline constexpr int kMostBins = 32;

/// Maps centres to bins, the same way for counting and for partitioning.
struct Binning {
  int bins;
  __m128 origin, scale, last;

  Binning(const Box& centers, int count) : bins(count), origin(centers.lower) {
    last = _mm_set1_ps(static_cast<float>(bins - 1));
    const __m128 extent = _mm_sub_ps(centers.upper, centers.lower);
    scale = _mm_div_ps(_mm_set1_ps(0.9999f * static_cast<float>(bins)), extent);
  }

  /// Whether the centres differ along the axis, by enough to compute with.
  bool usable(int axis) const {
    alignas(16) float s[4];
    _mm_store_ps(s, scale);
    return s[axis] < kInfinity;
  }

  __m128i operator()(const Primitive& p) const {
    const __m128 bin = _mm_mul_ps(_mm_sub_ps(center(p), origin), scale);
    return _mm_cvttps_epi32(_mm_min_ps(_mm_max_ps(bin, _mm_setzero_ps()), last));
  }
};

struct ObjectSplit {
  int axis = -1;           ///< none found
  int bin = 0;             ///< bins below this one go left
  float cost = kInfinity;  ///< in units of scaled_area()
  Box shared;              ///< what the boxes of both sides have in common
};

/// The cheapest split of the primitives, which lie in `bounds`, by the surface area heuristic (Wald 2007, "On fast
/// Construction of SAH-based Bounding Volume Hierarchies").
ObjectSplit find_object_split(std::span<const Primitive> primitives, const Box& bounds, const Binning& binning);

}  // namespace raylab::bvh
