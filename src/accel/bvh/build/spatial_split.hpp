#pragma once
// Splits of space instead of primitives: what straddles the plane becomes two references with smaller boxes. After
// Stich, Friedrich and Dietrich 2009, "Spatial Splits in Bounding Volume Hierarchies" (HPG).
#include <span>
#include <vector>

#include "build_box.hpp"

namespace raylab::bvh {

struct SpatialSplit {
  int axis = -1;  ///< none found
  float plane = 0.0f;
  float cost = kInfinity;  ///< in units of scaled_area()
  /// What is expected on each side; unsplitting makes it less.
  std::uint32_t left_count = 0, right_count = 0;
  Box left_box, right_box;
};

/// The cheapest split of the references, which lie in `bounds`, by the surface area heuristic, of those that part at
/// most `spare` of them and cost less than `most`.
SpatialSplit find_spatial_split(const Geometry& geometry, std::span<const Primitive> references, std::size_t spare,
                                float most, const Box& bounds, Four scale);

/// Adds each reference to the left or the right, or its parts to both if that costs less. Spheres are never
/// parted.
void partition_references(const Geometry& geometry, std::span<const Primitive> references, const SpatialSplit& split,
                          Four scale, std::vector<Primitive>& left, std::vector<Primitive>& right);

}  // namespace raylab::bvh
