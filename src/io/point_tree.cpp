#include "point_tree.hpp"

#include <algorithm>
#include <utility>

namespace raylab {
namespace {

constexpr std::uint32_t kLeafSize = 8;
constexpr std::uint32_t kNone = 0xffffffff;

/// Whether all of the box lies to the right of the line from a to b. Rounding is monotonic, so no point of the box
/// turns left where its leftmost corner does not.
bool right_of(const Point2& a, const Point2& b, const Point2& low, const Point2& high) {
  return turn(a, b, {b.y > a.y ? low.x : high.x, b.x > a.x ? high.y : low.y}) < 0.0;
}

}  // namespace

PointTree::PointTree(const std::vector<Point2>& points, std::vector<std::uint32_t> indices)
    : points_(points), indices_(std::move(indices)), leaf_of_(points.size(), kNone), removed_(points.size()) {
  if (!indices_.empty()) build(0, static_cast<std::uint32_t>(indices_.size()), 0);
}

std::uint32_t PointTree::build(std::uint32_t begin, std::uint32_t end, std::uint32_t parent) {
  const auto at = static_cast<std::uint32_t>(nodes_.size());
  Node node{points_[indices_[begin]], points_[indices_[begin]], begin, end, parent, 0, end - begin};
  for (std::uint32_t i = begin; i < end; ++i) {
    const Point2& p = points_[indices_[i]];
    node.low = {std::min(node.low.x, p.x), std::min(node.low.y, p.y)};
    node.high = {std::max(node.high.x, p.x), std::max(node.high.y, p.y)};
  }
  nodes_.push_back(node);
  if (end - begin <= kLeafSize) {
    for (std::uint32_t i = begin; i < end; ++i) leaf_of_[indices_[i]] = at;
    return at;
  }
  const std::uint32_t middle = begin + (end - begin) / 2;
  const bool by_x = node.high.x - node.low.x > node.high.y - node.low.y;
  const auto first = indices_.begin();
  std::nth_element(first + begin, first + middle, first + end, [&](std::uint32_t i, std::uint32_t j) {
    return by_x ? points_[i].x < points_[j].x : points_[i].y < points_[j].y;
  });
  build(begin, middle, at);
  const std::uint32_t second = build(middle, end, at);
  nodes_[at].second = second;
  return at;
}

void PointTree::remove(std::uint32_t index) {
  std::uint32_t at = leaf_of_[index];
  if (at == kNone) return;
  removed_[index] = true;
  for (--nodes_[at].left; at != 0; --nodes_[at].left) at = nodes_[at].parent;
}

std::optional<std::uint32_t> PointTree::find_in(const Point2& a, const Point2& b, const Point2& c) const {
  if (nodes_.empty()) return std::nullopt;
  return find_below(0, {a,
                        b,
                        c,
                        {std::min({a.x, b.x, c.x}), std::min({a.y, b.y, c.y})},
                        {std::max({a.x, b.x, c.x}), std::max({a.y, b.y, c.y})}});
}

std::optional<std::uint32_t> PointTree::find_below(std::uint32_t at, const Triangle& t) const {
  const Node& node = nodes_[at];
  // Of points in one place, as a polygon may pass by one corner often, none counts, or the first will do.
  const bool is_corner = node.low == node.high && (node.low == t.a || node.low == t.b || node.low == t.c);
  if (node.left == 0 || is_corner || node.low.x > t.high.x || node.low.y > t.high.y || node.high.x < t.low.x ||
      node.high.y < t.low.y || right_of(t.a, t.b, node.low, node.high) || right_of(t.b, t.c, node.low, node.high) ||
      right_of(t.c, t.a, node.low, node.high)) {
    return std::nullopt;
  }
  if (node.second != 0) {
    const auto found = find_below(at + 1, t);
    return found ? found : find_below(node.second, t);
  }
  for (std::uint32_t i = node.begin; i < node.end; ++i) {
    const std::uint32_t index = indices_[i];
    const Point2& p = points_[index];
    if (removed_[index] || p == t.a || p == t.b || p == t.c) continue;
    if (turn(t.a, t.b, p) >= 0.0 && turn(t.b, t.c, p) >= 0.0 && turn(t.c, t.a, p) >= 0.0) return index;
  }
  return std::nullopt;
}

}  // namespace raylab
