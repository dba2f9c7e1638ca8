#pragma once
#include <cstdint>
#include <optional>
#include <vector>

namespace raylab {

struct Point2 {
  double x, y;
  bool operator==(const Point2&) const = default;
};

/// Twice the signed area of the triangle: positive when it turns left.
inline double turn(const Point2& a, const Point2& b, const Point2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Finds points in triangles, and forgets points: a k-d tree that counts what is left below each node.
class PointTree {
 public:
  /// Holds those points that `indices` names. `points` must outlive the tree.
  PointTree(const std::vector<Point2>& points, std::vector<std::uint32_t> indices);

  /// Forgets a point, if the tree holds it.
  void remove(std::uint32_t index);

  /// Some point in the triangle, which turns left, its sides included. Points in the same place as one of its corners
  /// do not count.
  std::optional<std::uint32_t> find_in(const Point2& a, const Point2& b, const Point2& c) const;

 private:
  struct Node {
    Point2 low, high;
    std::uint32_t begin, end;  // in indices_
    std::uint32_t parent;
    std::uint32_t second;  // the first child follows its parent; 0: a leaf
    std::uint32_t left;    // points not yet removed
  };
  struct Triangle {
    Point2 a, b, c, low, high;
  };
  std::uint32_t build(std::uint32_t begin, std::uint32_t end, std::uint32_t parent);
  std::optional<std::uint32_t> find_below(std::uint32_t at, const Triangle& t) const;

  const std::vector<Point2>& points_;
  std::vector<std::uint32_t> indices_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> leaf_of_;  // by index of the point
  std::vector<bool> removed_;
};

}  // namespace raylab
