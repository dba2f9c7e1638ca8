// `exact`: the judge. A plain tree that shares no code with `bvh`, traversed in double with room for every rounding,
// and leaves decided without rounding (see ExactTest).
#include "raylab/geometry/exact.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "backends.hpp"
#include "raylab/core/timing.hpp"

namespace raylab {

namespace {

/// A ray against boxes. Says no only where the exact ray misses: each of the two distances to a slab errs by three
/// roundings, a relative 3 · 2^-53, and is moved outward by more.
class BoxTest {
 public:
  /// The ray and the boxes without denormals, as ExactTest understands them.
  explicit BoxTest(const Ray& ray) : origin_(ray.origin), direction_(ray.direction), t_min_(ray.t_min) {}

  /// Where the ray enters the box, or slightly before; infinity where it does not, up to t_max.
  template <class Box>
  double enter(const Box& box, double t_max) const {
    double near = t_min_;
    double far = t_max;
    for (int axis = 0; axis < 3; ++axis) {
      const double lower = static_cast<double>(without_denormal(box.lower[axis])) - origin_[axis];
      const double upper = static_cast<double>(without_denormal(box.upper[axis])) - origin_[axis];
      if (direction_[axis] == 0.0) {
        if (lower > 0.0 || upper < 0.0) return kOutside;
        continue;
      }
      const double t0 = lower / direction_[axis];
      const double t1 = upper / direction_[axis];
      const double first = std::min(t0, t1), last = std::max(t0, t1);
      near = std::max(near, first - std::abs(first) * kSlack);
      far = std::min(far, last + std::abs(last) * kSlack);
    }
    return near <= far ? near : kOutside;
  }

  static constexpr double kOutside = std::numeric_limits<double>::infinity();
  static constexpr double kSlack = 0x1p-50;

 private:
  dvec3 origin_, direction_;
  double t_min_;
};

/// Halves of the primitives by their centres along the longest axis, down to leaves of a few.
class MedianTree {
 public:
  struct Node {
    Bounds bounds;
    std::uint32_t first;  ///< of the leaf's primitives; of an inner node the second child, the first one follows it
    std::uint32_t count;  ///< 0: inner node
  };
  static constexpr std::uint32_t kLeafSize = 4;
  /// Each level halves the primitives, of which there are less than 2^32.
  static constexpr std::size_t kMaxDepth = 32;

  std::vector<PrimitiveId> ids;  ///< in the order of the leaves
  std::vector<Node> nodes;       ///< the root first; empty without primitives

  explicit MedianTree(const Geometry& geometry) : ids(valid_primitives(geometry)), geometry_(geometry) {
    if (!ids.empty()) build(0, static_cast<std::uint32_t>(ids.size()));
  }

  std::size_t bytes() const { return ids.capacity() * sizeof(PrimitiveId) + nodes.capacity() * sizeof(Node); }

 private:
  void build(std::uint32_t begin, std::uint32_t end) {
    const std::size_t index = nodes.size();
    nodes.push_back({{}, begin, end - begin});
    Bounds centers;
    for (std::uint32_t i = begin; i < end; ++i) {
      const Bounds b = primitive_bounds(geometry_, ids[i]);
      nodes[index].bounds.extend(b);
      centers.extend(b.center());
    }
    if (end - begin <= kLeafSize) return;
    const int axis = centers.longest_axis();
    const std::uint32_t middle = begin + (end - begin) / 2;
    const auto center = [&](const PrimitiveId& id) { return primitive_bounds(geometry_, id).center()[axis]; };
    std::nth_element(ids.begin() + begin, ids.begin() + middle, ids.begin() + end,
                     [&](const PrimitiveId& x, const PrimitiveId& y) { return center(x) < center(y); });
    build(begin, middle);
    nodes[index].first = static_cast<std::uint32_t>(nodes.size());
    nodes[index].count = 0;
    build(middle, end);
  }

  const Geometry& geometry_;
};

class ExactBvh final : public Accelerator {
 public:
  explicit ExactBvh(const Geometry& geometry) : geometry_(geometry), watch_(), tree_(geometry) {
    report_.primitives = tree_.ids.size();
    report_.invalid_primitives = geometry.primitive_count() - tree_.ids.size();
    report_.bytes = sizeof(*this) + tree_.bytes();
    if (!tree_.nodes.empty()) describe(0, 1);
    if (report_.sah_cost > 0.0) report_.sah_cost /= static_cast<double>(tree_.nodes[0].bounds.half_area());
    report_.isa = compiled_isa();
    report_.seconds = watch_.seconds();
  }

  std::optional<Hit> intersect(const Ray& ray) const noexcept override {
    const ExactTest test(geometry_, ray);
    std::optional<Crossing> closest;
    visit(test.ray(), [&](const PrimitiveId& id, double& t_max) {
      const auto crossing = test(id);
      if (crossing && (!closest || test.before(*crossing, *closest))) {
        closest = crossing;
        t_max = std::min(t_max, (crossing->t + crossing->error) * (1.0 + BoxTest::kSlack));
      }
      return false;
    });
    if (!closest) return std::nullopt;
    return test.to_hit(*closest);
  }

  bool occluded(const Ray& ray) const noexcept override {
    const ExactTest test(geometry_, ray);
    return visit(test.ray(), [&](const PrimitiveId& id, double&) { return test(id).has_value(); });
  }

  const BuildReport& build_report() const noexcept override { return report_; }

 private:
  /// Calls found(primitive, t_max), which may lower t_max, for all that the ray may meet before it, roughly from
  /// near to far, until one returns true. Whether one did.
  template <class Found>
  bool visit(const Ray& ray, const Found& found) const {
    if (tree_.nodes.empty() || !is_finite(ray.origin) || !is_finite(ray.direction)) return false;
    const BoxTest box(ray);
    double t_max = ray.t_max;
    struct Entry {
      std::uint32_t node;
      double enter;
    };
    std::array<Entry, MedianTree::kMaxDepth + 2> stack;
    std::size_t size = 0;
    stack[size++] = {0, box.enter(tree_.nodes[0].bounds, t_max)};
    while (size > 0) {
      const auto [index, enter] = stack[--size];
      if (!(enter <= t_max) || enter == BoxTest::kOutside) continue;
      const MedianTree::Node& node = tree_.nodes[index];
      if (node.count != 0) {
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
          if (box.enter(primitive_bounds(geometry_, tree_.ids[i]), t_max) == BoxTest::kOutside) continue;
          if (found(tree_.ids[i], t_max)) return true;
        }
        continue;
      }
      Entry near{index + 1, box.enter(tree_.nodes[index + 1].bounds, t_max)};
      Entry far{node.first, box.enter(tree_.nodes[node.first].bounds, t_max)};
      if (far.enter < near.enter) std::swap(near, far);
      if (far.enter != BoxTest::kOutside) stack[size++] = far;
      if (near.enter != BoxTest::kOutside) stack[size++] = near;
    }
    return false;
  }

  void describe(std::uint32_t index, int depth) {
    const MedianTree::Node& node = tree_.nodes[index];
    report_.depth = std::max(report_.depth, depth);
    report_.sah_cost += static_cast<double>(node.bounds.half_area()) * (node.count != 0 ? node.count : 1);
    if (node.count != 0) return;
    ++report_.nodes;
    describe(index + 1, depth + 1);
    describe(node.first, depth + 1);
  }

  const Geometry& geometry_;
  Stopwatch watch_;
  MedianTree tree_;
  BuildReport report_;
};

}  // namespace

std::unique_ptr<Accelerator> make_exact(const Geometry& geometry, const AcceleratorOptions&) {
  return std::make_unique<ExactBvh>(geometry);
}

}  // namespace raylab
