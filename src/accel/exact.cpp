// `exact`: the judge. The tree of `bvh` before it is made wide, traversed in double with room for every rounding,
// and leaves decided without rounding (see ExactTest).
#include "raylab/geometry/exact.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "backends.hpp"
#include "bvh/build/binary_tree.hpp"
#include "bvh/layout/layout.hpp"
#include "raylab/core/parallel.hpp"
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

class ExactBvh final : public Accelerator {
 public:
  ExactBvh(const Geometry& geometry, int threads) : geometry_(geometry) {
    const Stopwatch watch;
    const ThreadLimit limit(threads);
    tree_ = bvh::build_binary_tree(geometry, BuildQuality::balanced);
    report_.primitives = tree_.primitives.size();
    report_.invalid_primitives = geometry.primitive_count() - tree_.primitives.size();
    report_.bytes = sizeof(*this) + tree_.primitives.bytes() + tree_.nodes.bytes();
    if (!tree_.nodes.empty()) describe(0, 1);
    if (report_.sah_cost > 0.0) report_.sah_cost /= static_cast<double>(bvh::half_area(tree_.nodes[0]));
    report_.isa = compiled_isa();
    report_.seconds = watch.seconds();
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
    if (tree_.nodes.empty()) return false;
    const BoxTest box(ray);
    double t_max = ray.t_max;
    struct Entry {
      std::uint32_t node;
      double enter;
    };
    std::array<Entry, bvh::kMaxDepth + 2> stack;
    std::size_t size = 0;
    stack[size++] = {0, box.enter(tree_.nodes[0], t_max)};
    while (size > 0) {
      const auto [index, enter] = stack[--size];
      if (!(enter <= t_max) || enter == BoxTest::kOutside) continue;
      const bvh::BinaryNode& node = tree_.nodes[index];
      if (node.is_leaf()) {
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
          const bvh::Primitive& p = tree_.primitives[i];
          if (box.enter(p, t_max) == BoxTest::kOutside) continue;
          if (found(p.id(), t_max)) return true;
        }
        continue;
      }
      Entry near{node.first, box.enter(tree_.nodes[node.first], t_max)};
      Entry far{node.first + 1, box.enter(tree_.nodes[node.first + 1], t_max)};
      if (far.enter < near.enter) std::swap(near, far);
      if (far.enter != BoxTest::kOutside) stack[size++] = far;
      if (near.enter != BoxTest::kOutside) stack[size++] = near;
    }
    return false;
  }

  void describe(std::uint32_t index, int depth) {
    const bvh::BinaryNode& node = tree_.nodes[index];
    report_.depth = std::max(report_.depth, depth);
    const auto area = static_cast<double>(bvh::half_area(node));
    report_.sah_cost += area * (node.is_leaf() ? node.count : 1);
    if (node.is_leaf()) return;
    ++report_.nodes;
    describe(node.first, depth + 1);
    describe(node.first + 1, depth + 1);
  }

  const Geometry& geometry_;
  bvh::BinaryTree tree_;
  BuildReport report_;
};

}  // namespace

std::unique_ptr<Accelerator> make_exact(const Geometry& geometry, const AcceleratorOptions& options) {
  return std::make_unique<ExactBvh>(geometry, options.threads);
}

}  // namespace raylab
