#include "polygon.hpp"

#include <cstddef>
#include <functional>
#include <queue>
#include <utility>

#include "point_tree.hpp"
#include "raylab/core/check.hpp"

namespace raylab {
namespace {

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
std::vector<Point2> projected(std::span<const vec3> corners) {
  const dvec3 normal = newell_normal(corners);
  const dvec3 size = glm::abs(normal);
  const int drop = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
  int x = (drop + 1) % 3, y = (drop + 2) % 3;
  if (normal[drop] < 0.0) std::swap(x, y);
  std::vector<Point2> points;
  points.reserve(corners.size());
  for (const vec3& corner : corners) points.push_back({corner[x], corner[y]});
  return points;
}

/// Cuts ears off, one after the other around the polygon: corners that turn left and have no other corner in their
/// triangle, its sides included. Corners in the same place as the triangle's own do not count: polygons with a hole
/// pass the bridge to it twice. A corner that was no ear is looked at again only when its neighbours changed, or when
/// the corner found in its triangle was cut off: that keeps the work near n log n where ears are few, as in spirals.
class EarCutter {
 public:
  EarCutter(const std::vector<Point2>& points, std::vector<std::uint32_t> may_block)
      : points_(points),
        blockers_(points, std::move(may_block)),
        neighbors_(points.size()),
        waits_(points.size()),
        cut_(points.size()),
        waiting_for_(points.size(), kNone) {
    const auto count = static_cast<std::uint32_t>(points.size());
    for (std::uint32_t i = 0; i < count; ++i) neighbors_[i] = {(i + count - 1) % count, (i + 1) % count};
    for (std::uint32_t i = 1; i < count; ++i) look_at(i);
    look_at(0);
  }

  /// Appends the triangles and returns the corners that are left: three, or more where no ear is among them.
  std::vector<std::uint32_t> cut(std::vector<std::array<std::uint32_t, 3>>& triangles) {
    std::size_t left = points_.size();
    while (left > 3 && next_to_look_at()) {
      const auto [before, after] = neighbors_[at_];
      if (!is_ear(before, after)) continue;
      triangles.push_back({before, at_, after});
      neighbors_[before].second = after;
      neighbors_[after].first = before;
      --left;
      cut_[at_] = true;
      blockers_.remove(at_);
      for (std::uint32_t i = waiting_for_[at_]; i != kNone; i = waiting_[i].next) look_at(waiting_[i].corner);
      look_at(before);
      look_at(after);
    }
    std::vector<std::uint32_t> rest;
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
      if (!cut_[i]) rest.push_back(i);
    }
    return rest;
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffff;
  using Queue = std::priority_queue<std::uint32_t, std::vector<std::uint32_t>, std::greater<>>;

  void look_at(std::uint32_t corner) {
    if (waits_[corner] || cut_[corner]) return;
    waits_[corner] = true;
    (corner > at_ ? this_round_ : next_round_).push(corner);
  }

  bool next_to_look_at() {
    if (this_round_.empty()) std::swap(this_round_, next_round_);
    if (this_round_.empty()) return false;
    at_ = this_round_.top();
    this_round_.pop();
    waits_[at_] = false;
    return true;
  }

  bool is_ear(std::uint32_t before, std::uint32_t after) {
    const Point2 &a = points_[before], &b = points_[at_], &c = points_[after];
    if (!(turn(a, b, c) > 0.0)) return false;
    const auto blocker = blockers_.find_in(a, b, c);
    if (!blocker) return true;
    waiting_.push_back({at_, waiting_for_[*blocker]});
    waiting_for_[*blocker] = static_cast<std::uint32_t>(waiting_.size() - 1);
    return false;
  }

  const std::vector<Point2>& points_;
  PointTree blockers_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> neighbors_;  // before and after
  std::vector<bool> waits_;                                         // in a queue
  std::vector<bool> cut_;
  Queue this_round_, next_round_;
  std::uint32_t at_ = 0;
  struct Waiting {
    std::uint32_t corner, next;
  };
  std::vector<Waiting> waiting_;
  std::vector<std::uint32_t> waiting_for_;  // first in waiting_, by blocker
};

}  // namespace

bool triangulate(std::span<const vec3> corners, std::vector<std::array<std::uint32_t, 3>>& triangles) {
  const auto count = static_cast<std::uint32_t>(corners.size());
  RAYLAB_CHECK(count >= 3);
  const std::vector<Point2> points = projected(corners);
  // Only corners that do not turn left can lie in an ear. Cutting ears only narrows corners: convex ones stay convex.
  std::vector<std::uint32_t> may_block;
  bool is_fan = true;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Point2 &p = points[i], &next = points[(i + 1) % count];
    if (!(turn(points[(i + count - 1) % count], p, next) > 0.0)) may_block.push_back(i);
    if (i > 0 && i + 2 < count) is_fan = is_fan && turn(points[0], p, next) > 0.0;
  }
  if (count == 3 || (may_block.empty() && is_fan)) {
    for (std::uint32_t i = 1; i + 1 < count; ++i) triangles.push_back({0, i, i + 1});
    return true;
  }
  const std::vector<std::uint32_t> rest = EarCutter(points, std::move(may_block)).cut(triangles);
  for (std::size_t i = 1; i + 1 < rest.size(); ++i) triangles.push_back({rest[0], rest[i], rest[i + 1]});
  return rest.size() == 3;
}

}  // namespace raylab
