#include "ladder_steps.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/primitive_test.hpp"
#include "ladder_tree.hpp"
#include "raylab/core/timing.hpp"

namespace raylab::bench {

namespace {

/// What the slab tests need of a ray.
struct Slabs {
  explicit Slabs(const Ray& ray) : origin(ray.origin), inverse(1.0f / ray.direction), t_min(ray.t_min) {
    for (int axis = 0; axis < 3; ++axis) down[axis] = std::signbit(ray.direction[axis]);
  }

  static constexpr float kGrow = 1.0f + 0x1p-20f;

  /// Where the ray enters the box, or infinity. What is not a number bounds nothing.
  float enter(const Bounds& box, float t_max) const {
    float near = t_min, far = t_max;
    for (int axis = 0; axis < 3; ++axis) {
      const float t0 = ((down[axis] ? box.upper : box.lower)[axis] - origin[axis]) * inverse[axis];
      const float t1 = ((down[axis] ? box.lower : box.upper)[axis] - origin[axis]) * inverse[axis] * kGrow;
      near = t0 > near ? t0 : near;
      far = t1 < far ? t1 : far;
    }
    return near <= far ? near : kInfinity;
  }

  vec3 origin, inverse;
  float t_min;
  bool down[3];
};

/// The nearest hit among some primitives, if there is one before t_max, which then becomes its t.
using BookTest = PrimitiveTest<Intersector::book>;
void hit_leaf(const Geometry& geometry, const PrimitiveId* ids, std::uint32_t count, const BookTest& test, float& t_max,
              std::optional<Hit>& closest) {
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto hit = test(geometry, ids[i], test.ray().t_min, t_max);
    if (!hit) continue;
    closest = hit;
    t_max = hit->t;
  }
}

struct Entry {
  std::uint32_t node;
  float near;
};

class Binary final : public Accelerator {
 public:
  Binary(const Geometry& geometry, LadderSplit split) : geometry_(geometry) {
    const Stopwatch watch;
    tree_ = build_ladder_tree(geometry, split);
    report_.seconds = watch.seconds();
    report_.bytes = sizeof(*this) + tree_.ids.size() * sizeof(PrimitiveId) + tree_.nodes.size() * sizeof(LadderNode);
    report_.primitives = tree_.ids.size();
    report_.invalid_primitives = geometry.primitive_count() - tree_.ids.size();
    report_.depth = tree_.depth;
    for (const LadderNode& node : tree_.nodes) {
      report_.nodes += node.is_leaf() ? 0 : 1;
      report_.sah_cost += static_cast<double>(node.bounds.half_area()) * (node.is_leaf() ? node.count : 1);
    }
    if (report_.sah_cost > 0.0) report_.sah_cost /= static_cast<double>(tree_.nodes[0].bounds.half_area());
  }

  std::optional<Hit> intersect(const Ray& ray) const noexcept override { return find(ray, false); }
  bool occluded(const Ray& ray) const noexcept override { return find(ray, true).has_value(); }
  const BuildReport& build_report() const noexcept override { return report_; }

 private:
  std::optional<Hit> find(const Ray& ray, bool any_hit) const {
    std::optional<Hit> closest;
    float t_max = ray.t_max;
    const Slabs slabs(ray);
    const BookTest test(ray);
    Entry stack[kStack];
    int top = 0;
    if (!tree_.nodes.empty()) stack[top++] = {0, slabs.enter(tree_.nodes[0].bounds, t_max)};
    while (top > 0) {
      const Entry entry = stack[--top];
      if (!(entry.near < kInfinity) || entry.near > t_max) continue;
      const LadderNode& node = tree_.nodes[entry.node];
      if (node.is_leaf()) {
        hit_leaf(geometry_, &tree_.ids[node.first], node.count, test, t_max, closest);
        if (any_hit && closest) return closest;
        continue;
      }
      const Entry left{node.first, slabs.enter(tree_.nodes[node.first].bounds, t_max)};
      const Entry right{node.first + 1, slabs.enter(tree_.nodes[node.first + 1].bounds, t_max)};
      stack[top++] = left.near < right.near ? right : left;
      stack[top++] = left.near < right.near ? left : right;
    }
    return closest;
  }

  const Geometry& geometry_;
  LadderTree tree_;
  BuildReport report_;
};

constexpr std::size_t kWidth = 8;

struct alignas(32) WideNode {
  float lower[3][kWidth], upper[3][kWidth];
  std::uint32_t first[kWidth];
  std::uint32_t count[kWidth];  ///< as in LadderNode
  std::uint32_t children = 0;
};

class Wide final : public Accelerator {
 public:
  explicit Wide(const Geometry& geometry) : geometry_(geometry) {
    const Stopwatch watch;
    LadderTree tree = build_ladder_tree(geometry, LadderSplit::heuristic);
    report_.depth = 1;
    if (!tree.nodes.empty()) {
      if (tree.nodes[0].is_leaf()) tree.nodes.push_back(tree.nodes[0]);  // a node with one child, the leaf
      widen(tree, 0, 1);
      report_.sah_cost /= static_cast<double>(tree.nodes[0].bounds.half_area());
    }
    ids_ = std::move(tree.ids);
    report_.seconds = watch.seconds();
    report_.bytes = sizeof(*this) + ids_.size() * sizeof(PrimitiveId) + nodes_.size() * sizeof(WideNode);
    report_.primitives = ids_.size();
    report_.invalid_primitives = geometry.primitive_count() - ids_.size();
    report_.nodes = nodes_.size();
  }

  std::optional<Hit> intersect(const Ray& ray) const noexcept override { return find(ray, false); }
  bool occluded(const Ray& ray) const noexcept override { return find(ray, true).has_value(); }
  const BuildReport& build_report() const noexcept override { return report_; }

 private:
  /// Opens the largest child until there are eight.
  std::uint32_t widen(const LadderTree& tree, std::uint32_t root, int depth) {
    const auto index = static_cast<std::uint32_t>(nodes_.size());
    nodes_.emplace_back();
    report_.depth = std::max(report_.depth, depth + 1);
    report_.sah_cost += static_cast<double>(tree.nodes[root].bounds.half_area());
    std::vector<std::uint32_t> children{tree.nodes[root].is_leaf() ? 1 : tree.nodes[root].first};
    if (!tree.nodes[root].is_leaf()) children.push_back(tree.nodes[root].first + 1);
    while (children.size() < kWidth) {
      const auto area = [&](std::uint32_t i) {
        return tree.nodes[i].is_leaf() ? -1.0f : tree.nodes[i].bounds.half_area();
      };
      const auto largest = std::max_element(children.begin(), children.end(),
                                            [&](std::uint32_t a, std::uint32_t b) { return area(a) < area(b); });
      if (tree.nodes[*largest].is_leaf()) break;
      *largest = tree.nodes[*largest].first;
      children.push_back(*largest + 1);
    }
    WideNode node;
    for (const std::uint32_t child : children) {
      const LadderNode& from = tree.nodes[child];
      const std::uint32_t lane = node.children++;
      for (int axis = 0; axis < 3; ++axis) {
        node.lower[axis][lane] = from.bounds.lower[axis];
        node.upper[axis][lane] = from.bounds.upper[axis];
      }
      node.count[lane] = from.count;
      node.first[lane] = from.is_leaf() ? from.first : widen(tree, child, depth + 1);
      if (from.is_leaf()) report_.sah_cost += static_cast<double>(from.bounds.half_area()) * from.count;
    }
    for (std::uint32_t lane = node.children; lane < kWidth; ++lane) {  // never met
      for (int axis = 0; axis < 3; ++axis) {
        node.lower[axis][lane] = kInfinity;
        node.upper[axis][lane] = -kInfinity;
      }
    }
    nodes_[index] = node;
    return index;
  }

  /// Distances to all children; the compiler makes vectors of the loop.
  static void enter(const WideNode& node, const Slabs& slabs, float t_max, float (&near)[kWidth]) {
    float far[kWidth];
    for (std::size_t i = 0; i < kWidth; ++i) {
      near[i] = slabs.t_min;
      far[i] = t_max;
    }
    for (int axis = 0; axis < 3; ++axis) {
      const float* first = slabs.down[axis] ? node.upper[axis] : node.lower[axis];
      const float* last = slabs.down[axis] ? node.lower[axis] : node.upper[axis];
      const float origin = slabs.origin[axis], inverse = slabs.inverse[axis];
      for (std::size_t i = 0; i < kWidth; ++i) {
        const float t0 = (first[i] - origin) * inverse, t1 = (last[i] - origin) * inverse * Slabs::kGrow;
        near[i] = t0 > near[i] ? t0 : near[i];
        far[i] = t1 < far[i] ? t1 : far[i];
      }
    }
    for (std::size_t i = 0; i < kWidth; ++i) near[i] = near[i] <= far[i] ? near[i] : kInfinity;
  }

  std::optional<Hit> find(const Ray& ray, bool any_hit) const {
    std::optional<Hit> closest;
    if (nodes_.empty()) return closest;
    float t_max = ray.t_max;
    const Slabs slabs(ray);
    const BookTest test(ray);
    struct Child {
      std::uint32_t first, count;
      float near;
    };
    Child stack[kStack * kWidth];
    int top = 0;
    stack[top++] = {0, 0, slabs.t_min};
    while (top > 0) {
      const Child child = stack[--top];
      if (child.near > t_max) continue;
      if (child.count != 0) {
        hit_leaf(geometry_, &ids_[child.first], child.count, test, t_max, closest);
        if (any_hit && closest) return closest;
        continue;
      }
      const WideNode& node = nodes_[child.first];
      float near[kWidth];
      enter(node, slabs, t_max, near);
      const int bottom = top;
      for (std::uint32_t i = 0; i < node.children; ++i) {
        if (!(near[i] < kInfinity)) continue;
        int at = top++;
        for (; at > bottom && stack[at - 1].near < near[i]; --at) stack[at] = stack[at - 1];
        stack[at] = {node.first[i], node.count[i], near[i]};
      }
    }
    return closest;
  }

  const Geometry& geometry_;
  std::vector<PrimitiveId> ids_;
  std::vector<WideNode> nodes_;
  BuildReport report_;
};

}  // namespace

std::unique_ptr<Accelerator> make_flat(const Geometry& geometry, const AcceleratorOptions&) {
  return std::make_unique<Binary>(geometry, LadderSplit::median);
}
std::unique_ptr<Accelerator> make_heuristic(const Geometry& geometry, const AcceleratorOptions&) {
  return std::make_unique<Binary>(geometry, LadderSplit::heuristic);
}
std::unique_ptr<Accelerator> make_wide(const Geometry& geometry, const AcceleratorOptions&) {
  return std::make_unique<Wide>(geometry);
}

}  // namespace raylab::bench
