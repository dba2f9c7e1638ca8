#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "raylab/core/vec.hpp"

namespace raylab {

/// Splits a polygon, flat or nearly so, convex or not, into corners.size() - 2 triangles with the polygon's
/// winding, by cutting ears (Meisters 1975) in the coordinate plane it faces most. A convex polygon becomes the
/// fan around its first corner. Triangles index `corners` and are appended. Returns false when no ear is left, as
/// in a polygon that crosses itself or has no area: the rest is then a fan. Needs at least three corners.
bool triangulate(std::span<const vec3> corners, std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace raylab
