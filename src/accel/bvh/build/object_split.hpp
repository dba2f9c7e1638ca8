#pragma once
// Splits of the primitives in two by their centres, binned.
#include <span>

#include "build_box.hpp"

namespace raylab::bvh {

inline constexpr int kMostBins = 32;

/// Maps centres to bins, the same way for counting and for partitioning.
struct Binning {
  int bins;
  Four origin, scale, last;

  Binning(const Box& centers, int count) : bins(count), origin(centers.lower) {
    last = four(static_cast<float>(bins - 1));
    scale = four(0.9999f * static_cast<float>(bins)) / (centers.upper - centers.lower);
  }

  /// Whether the centres differ along the axis, by enough to compute with.
  bool usable(int axis) const { return scale[axis] < kInfinity; }

  /// The bin along each axis.
  FourInts operator()(const Primitive& p) const {
    return __builtin_convertvector(min(max((center(p) - origin) * scale, Four{}), last), FourInts);
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
