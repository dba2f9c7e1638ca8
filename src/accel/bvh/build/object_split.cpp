#include "object_split.hpp"

#include <algorithm>

namespace raylab::bvh {

ObjectSplit find_object_split(std::span<const Primitive> primitives, const Box& bounds, const Binning& binning) {
  Box boxes[3][kMostBins];
  std::uint32_t counts[3][kMostBins] = {};
  for (const Primitive& p : primitives) {
    const FourInts bin = binning(p);
    for (int axis = 0; axis < 3; ++axis) {
      boxes[axis][bin[axis]].extend(p);
      ++counts[axis][bin[axis]];
    }
  }

  const Four scale = area_scale(bounds);
  ObjectSplit best;
  for (int axis = 0; axis < 3; ++axis) {
    if (!binning.usable(axis)) continue;
    float right_costs[kMostBins];
    Box right;
    std::uint32_t right_count = 0;
    for (int bin = binning.bins - 1; bin > 0; --bin) {
      right.extend(boxes[axis][bin]);
      right_count += counts[axis][bin];
      right_costs[bin] = right_count == 0 ? kInfinity : scaled_area(right, scale) * leaf_cost(right_count);
    }
    Box left;
    std::uint32_t left_count = 0;
    for (int bin = 1; bin < binning.bins; ++bin) {
      left.extend(boxes[axis][bin - 1]);
      left_count += counts[axis][bin - 1];
      if (left_count == 0) continue;
      const float cost = scaled_area(left, scale) * leaf_cost(left_count) + right_costs[bin];
      if (cost < best.cost) best = {axis, bin, cost, {}};
    }
  }
  if (best.axis >= 0) {
    Box left, right;
    for (int bin = 0; bin < best.bin; ++bin) left.extend(boxes[best.axis][bin]);
    for (int bin = best.bin; bin < binning.bins; ++bin) right.extend(boxes[best.axis][bin]);
    best.shared = {max(left.lower, right.lower), min(left.upper, right.upper)};
  }
  return best;
}

}  // namespace raylab::bvh
