#include "polygon.hpp"

#include <cstddef>
#include <utility>

#include "raylab/core/check.hpp"

namespace raylab {
namespace {

struct Point {
  double x, y;
  bool operator==(const Point&) const = default;
};

/// Twice the signed area of the triangle: positive when it turns left.
double turn(const Point& a, const Point& b, const Point& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Newell's normal: the sum of the cross products of neighbours, right for non-convex polygons too.
dvec3 newell_normal(std::span<const vec3> corners) {
  dvec3 normal(0.0);
  const dvec3 first(corners[0]);
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    normal += glm::cross(dvec3(corners[i]) - first, dvec3(corners[i + 1]) - first);
  }
  return normal;
}

/// The polygon seen against its normal along the normal's largest axis, so that it turns left.
std::vector<Point> projected(std::span<const vec3> corners) {
  const dvec3 normal = newell_normal(corners);
  const dvec3 size = glm::abs(normal);
  const int drop = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
  int x = (drop + 1) % 3, y = (drop + 2) % 3;
  if (normal[drop] < 0.0) std::swap(x, y);
  std::vector<Point> points;
  points.reserve(corners.size());
  for (const vec3& corner : corners) points.push_back({corner[x], corner[y]});
  return points;
}

/// Whether the corner `at` of the remaining polygon can be cut off: it turns left and no other corner lies in the
/// triangle, its sides included. Corners in the same place as the triangle's own do not count: polygons with a
/// hole pass the bridge to it twice. Only corners that do not turn left can lie in an ear (`may_block`).
bool is_ear(const std::vector<Point>& points, const std::vector<std::uint32_t>& rest, std::size_t at,
            const std::vector<bool>& may_block) {
  const std::size_t count = rest.size();
  const Point& a = points[rest[(at + count - 1) % count]];
  const Point& b = points[rest[at]];
  const Point& c = points[rest[(at + 1) % count]];
  if (!(turn(a, b, c) > 0.0)) return false;
  for (const std::uint32_t i : rest) {
    if (!may_block[i]) continue;
    const Point& p = points[i];
    if (p == a || p == b || p == c) continue;
    if (turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0) return false;
  }
  return true;
}

}  // namespace

bool triangulate(std::span<const vec3> corners, std::vector<std::array<std::uint32_t, 3>>& triangles) {
  const std::size_t count = corners.size();
  RAYLAB_CHECK(count >= 3);
  std::vector<std::uint32_t> rest(count);
  for (std::size_t i = 0; i < count; ++i) rest[i] = static_cast<std::uint32_t>(i);
  if (count > 3) {
    const std::vector<Point> points = projected(corners);
    // Cutting ears only narrows corners: convex ones stay convex, so this stays conservative.
    std::vector<bool> may_block(count);
    for (std::size_t i = 0; i < count; ++i) {
      may_block[i] = !(turn(points[(i + count - 1) % count], points[i], points[(i + 1) % count]) > 0.0);
    }
    std::size_t at = 1;
    std::size_t refused = 0;
    while (rest.size() > 3 && refused < rest.size()) {
      const std::size_t left = rest.size();
      if (at >= left) at = 0;
      if (is_ear(points, rest, at, may_block)) {
        triangles.push_back({rest[(at + left - 1) % left], rest[at], rest[(at + 1) % left]});
        rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(at));
        refused = 0;
      } else {
        ++at;
        ++refused;
      }
    }
  }
  for (std::size_t i = 1; i + 1 < rest.size(); ++i) triangles.push_back({rest[0], rest[i], rest[i + 1]});
  return rest.size() == 3;
}

}  // namespace raylab
