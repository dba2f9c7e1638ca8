#pragma once
// Geometry of one character in any number of triangles, to see what grows with it.
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "raylab/core/ray.hpp"
#include "raylab/geometry/geometry.hpp"

namespace raylab {

/// soup: separate triangles that get smaller as they get more. sphere: a closed mesh. terrain: a height field.
/// thin: triangles ten thousand times as long as wide, in all directions. stadium: a wide bowl of few triangles,
/// and in its middle an object a thousandth its size that has all the others.
std::span<const std::string_view> scale_family_names();

struct ScaleFamily {
  Geometry geometry;
  std::vector<Ray> rays;  ///< from around and within, some of them aimed at the small parts
};

/// A geometry of about `triangles`, at least 100. Throws Error (usage) for an unknown name.
ScaleFamily make_scale_family(std::string_view name, std::size_t triangles, std::size_t rays, std::uint64_t seed);

}  // namespace raylab
