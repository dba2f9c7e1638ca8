#include "binary_tree.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <optional>
#include <span>
#include <vector>

#include "../layout/layout.hpp"
#include "build_box.hpp"
#include "object_split.hpp"
#include "raylab/core/check.hpp"
#include "raylab/core/parallel.hpp"
#include "reinsertion.hpp"
#include "spatial_split.hpp"
#include "vertex_set.hpp"

namespace raylab::bvh {

namespace {

/// Below this depth splits follow the surface area heuristic; from there on they halve the number of primitives,
/// which bounds the depth on any input.
constexpr int kHeuristicDepth = 44;
static_assert(kHeuristicDepth + 32 < kMaxDepth);

/// Subtrees of fewer primitives are built by one thread.
constexpr std::uint32_t kParallelGrain = 4096;

/// A range of primitives with what the next split needs to know of it.
struct Range {
  std::uint32_t begin, end;
  std::uint32_t room;  ///< from `end` to here are slots for references that spatial splits add
  Box bounds;
  Box centers;  ///< of the doubled centres

  std::uint32_t size() const { return end - begin; }
};

/// References that splits of space may add, for each primitive.
constexpr double kSpareReferences = 0.3;
/// Space is split where the boxes of an object split share more than this part of the root's area: alpha of Stich,
/// Friedrich and Dietrich 2009. With their 1e-5 the dragon took a quarter longer to build for 0.6% less cost.
constexpr float kSharedArea = 1e-3f;
/// Smaller ranges make one leaf or two, which the heuristic knows too little of.
constexpr std::uint32_t kSmallestSpatialSplit = 2 * kBlockSize;

class Builder {
 public:
  Builder(const Geometry& geometry, BuildQuality quality, Splits splits, BinaryTree& tree)
      : geometry_(geometry),
        follows_cost_(quality != BuildQuality::fast),
        splits_space_(splits == Splits::of_space_too),
        tree_(tree) {}

  void run() {
    Primitives collected = collect_primitives(geometry_, splits_space_ ? kSpareReferences : 0.0);
    tree_.primitive_count = collected.count;
    tree_.primitives = std::move(collected.all);
    if (collected.count == 0) {
      tree_.primitives.shrink(0);
      return;
    }
    const std::size_t room = splits_space_ ? tree_.primitives.size() : collected.count;
    tree_.primitives.shrink(room);
    RAYLAB_CHECK(room <= kLargestRefIndex);
    tree_.nodes = HugeArray<BinaryNode>(2 * room - 1);  // touched only where used
    Range all{0, static_cast<std::uint32_t>(collected.count), static_cast<std::uint32_t>(room), {}, {}};
    add_all(all);
    root_scale_ = area_scale(all.bounds);
    most_shared_area_ = kSharedArea * scaled_area(all.bounds, root_scale_);
    build(0, all, 1);
    tree_.nodes.shrink(next_node_);
    if (splits_space_) close_gaps();
  }

 private:
  /// What leaf the primitives can be: a sphere alone, or triangles that share their vertices or hardly do.
  /// Triangles in between are parted, into two smaller blocks instead of one that is larger than both.
  std::optional<RefKind> leaf_kind(const Range& range) const {
    if (range.size() > kBlockSize) return std::nullopt;
    VertexSet vertices;
    for (std::uint32_t i = range.begin; i < range.end; ++i) {
      const Primitive& p = tree_.primitives[i];
      if (geometry_.is_sphere(p.geometry)) {
        if (range.size() == 1) return RefKind::sphere;
        return std::nullopt;
      }
      const TriangleMesh& mesh = geometry_.meshes[p.geometry];
      const uvec3& corners = mesh.triangles[p.primitive];
      for (int c = 0; c < 3; ++c) vertices.add(p.geometry, mesh, corners[c]);
    }
    if (vertices.size() > 2 * kBlockSize) return RefKind::separate;
    if (vertices.size() > kBlockSize) return std::nullopt;
    return RefKind::triangles;
  }

  void build(std::uint32_t node_index, const Range& range, int depth) {
    BinaryNode& node = tree_.nodes[node_index];
    std::memcpy(&node, &range.bounds, sizeof node);  // what is no bound is set below
    if (const auto kind = leaf_kind(range)) {
      Primitive* const begin = tree_.primitives.begin() + range.begin;
      Primitive* const end = tree_.primitives.begin() + range.end;
      std::sort(begin, end, [](const Primitive& a, const Primitive& b) { return a.id() < b.id(); });
      const auto same = [](const Primitive& a, const Primitive& b) { return a.id() == b.id(); };
      node.first = range.begin;
      node.count = static_cast<std::uint16_t>((splits_space_ ? std::unique(begin, end, same) : end) - begin);
      node.kind = *kind;
      return;
    }
    Range left, right;
    split(range, depth, left, right);
    const std::uint32_t child = next_node_.fetch_add(2, std::memory_order_relaxed);
    node.first = child;
    node.count = 0;
    node.kind = RefKind::node;
    if (range.size() > kParallelGrain) {
      parallel_invoke([&] { build(child, left, depth + 1); }, [&] { build(child + 1, right, depth + 1); });
    } else {
      build(child, left, depth + 1);
      build(child + 1, right, depth + 1);
    }
  }

  void split(const Range& range, int depth, Range& left, Range& right) {
    left = {range.begin, range.begin, range.begin, {}, {}};
    right = {range.end, range.end, range.end, {}, {}};
    const bool is_split = range.size() <= kBlockSize && split_by_kind(range, left, right);
    if (!is_split && (depth >= kHeuristicDepth || !split_well(range, left, right))) split_in_half(range, left, right);
    if (range.room > right.end) share_room(range, left, right);
  }

  /// False where the centres do not differ enough for a good split, or the surface area heuristic sees none.
  bool split_well(const Range& range, Range& left, Range& right) {
    return follows_cost_ ? split_by_cost(range, left, right) : split_in_middle(range, left, right);
  }

  bool split_by_cost(const Range& range, Range& left, Range& right) {
    const int bins = std::min(kMostBins, 8 + static_cast<int>(range.size() / 8));
    const Binning binning(range.centers, bins);
    const ObjectSplit best = find_object_split(references(range), range.bounds, binning);
    if (splits_space_ && range.room > range.end && range.size() > kSmallestSpatialSplit &&
        split_space(range, best, left, right))
      return true;
    if (best.axis < 0) return false;
    const auto axis = static_cast<std::size_t>(best.axis);
    partition(range, left, right, [&](const Primitive& p) { return binning(p)[axis] < best.bin; });
    return true;
  }

  /// In the middle of the centres, along the axis on which they differ most: two thirds of the building time of
  /// split_by_cost.
  bool split_in_middle(const Range& range, Range& left, Range& right) {
    const int axis = widest_axis(range.centers);
    const Four lower = range.centers.lower, upper = range.centers.upper;
    const float middle = 0.5f * lower[axis] + 0.5f * upper[axis];
    if (!(lower[axis] < middle && middle <= upper[axis])) return false;
    partition(range, left, right, [=](const Primitive& p) { return p.lower[axis] + p.upper[axis] < middle; });
    return true;
  }

  /// Splits space where that costs less than the given split of the primitives, and there is room.
  bool split_space(const Range& range, const ObjectSplit& other, Range& left, Range& right) {
    const bool parts_well = is_empty(other.shared) || scaled_area(other.shared, root_scale_) <= most_shared_area_;
    if (other.axis >= 0 && parts_well) return false;
    const Four scale = area_scale(range.bounds);
    const SpatialSplit split =
        find_spatial_split(geometry_, references(range), range.room - range.end, other.cost, range.bounds, scale);
    if (split.axis < 0 || !(split.cost < other.cost)) return false;
    std::vector<Primitive> in_left, in_right;
    partition_references(geometry_, references(range), split, scale, in_left, in_right);
    const std::size_t total = in_left.size() + in_right.size();
    if (in_left.empty() || in_right.empty() || total > range.room - range.begin) return false;
    if (total == 2 * range.size()) return false;  // nothing is parted
    std::copy(in_left.begin(), in_left.end(), tree_.primitives.begin() + range.begin);
    std::copy(in_right.begin(), in_right.end(), tree_.primitives.begin() + range.begin + in_left.size());
    left.end = right.begin = range.begin + static_cast<std::uint32_t>(in_left.size());
    right.end = range.begin + static_cast<std::uint32_t>(total);
    add_all(left);
    add_all(right);
    return true;
  }

  /// Parts the room behind a range among its two sides, as their sizes are.
  void share_room(const Range& range, Range& left, Range& right) const {
    const std::uint64_t spare = range.room - right.end;
    const auto of_left = static_cast<std::uint32_t>(spare * left.size() / (left.size() + right.size()));
    std::move_backward(tree_.primitives.begin() + right.begin, tree_.primitives.begin() + right.end,
                       tree_.primitives.begin() + right.end + of_left);
    right.begin += of_left;
    right.end += of_left;
    left.room = right.begin;
    right.room = range.room;
  }

  /// Moves the primitives of the leaves together, in their order in the tree.
  void close_gaps() {
    std::vector<Primitive> kept;
    kept.reserve(tree_.primitives.size());
    std::vector<std::uint32_t> stack{0};
    while (!stack.empty()) {
      BinaryNode& node = tree_.nodes[stack.back()];
      stack.pop_back();
      if (!node.is_leaf()) {
        stack.insert(stack.end(), {node.first + 1, node.first});
        continue;
      }
      const Primitive* const from = tree_.primitives.begin() + node.first;
      node.first = static_cast<std::uint32_t>(kept.size());
      kept.insert(kept.end(), from, from + node.count);
    }
    std::copy(kept.begin(), kept.end(), tree_.primitives.begin());
    tree_.primitives.shrink(kept.size());
  }

  /// Spheres go right, since a leaf does not mix them with triangles.
  bool split_by_kind(const Range& range, Range& left, Range& right) {
    const auto is_sphere = [&](const Primitive& p) { return geometry_.is_sphere(p.geometry); };
    const auto begin = tree_.primitives.begin() + range.begin;
    const auto end = tree_.primitives.begin() + range.end;
    const auto spheres = std::count_if(begin, end, is_sphere);
    if (spheres == 0 || spheres == end - begin) return false;
    partition(range, left, right, [&](const Primitive& p) { return !is_sphere(p); });
    return true;
  }

  /// Along the axis on which the centres differ most; any half where they do not differ at all.
  void split_in_half(const Range& range, Range& left, Range& right) {
    const int axis = widest_axis(range.centers);
    const auto begin = tree_.primitives.begin() + range.begin;
    const std::uint32_t half = range.size() / 2;
    std::nth_element(begin, begin + half, tree_.primitives.begin() + range.end,
                     [axis](const Primitive& a, const Primitive& b) {
                       const float ca = a.lower[axis] + a.upper[axis];
                       const float cb = b.lower[axis] + b.upper[axis];
                       if (ca != cb) return ca < cb;
                       return a.id() < b.id();
                     });
    left.end = right.begin = range.begin + half;
    add_all(left);
    add_all(right);
  }

  static int widest_axis(const Box& box) {
    const Four extent = box.upper - box.lower;
    return extent[0] >= extent[1] && extent[0] >= extent[2] ? 0 : (extent[1] >= extent[2] ? 1 : 2);
  }

  static void add(const Primitive& p, Range& range) {
    range.bounds.extend(p);
    range.centers.extend(center(p));
  }

  std::span<const Primitive> references(const Range& range) const {
    return {tree_.primitives.begin() + range.begin, range.size()};
  }

  void add_all(Range& range) const {
    for (std::uint32_t i = range.begin; i < range.end; ++i) add(tree_.primitives[i], range);
  }

  template <class GoesLeft>
  void partition(const Range& range, Range& left, Range& right, const GoesLeft& goes_left) {
    Primitive* i = tree_.primitives.data() + range.begin;
    Primitive* j = tree_.primitives.data() + range.end;
    for (;;) {
      while (i < j && goes_left(*i)) add(*i++, left);
      while (i < j && !goes_left(*(j - 1))) add(*--j, right);
      if (i >= j) break;
      std::swap(*i, *(j - 1));
    }
    left.end = right.begin = static_cast<std::uint32_t>(i - tree_.primitives.data());
  }

  const Geometry& geometry_;
  bool follows_cost_;
  bool splits_space_;
  BinaryTree& tree_;
  Four root_scale_;
  float most_shared_area_ = 0.0f;  ///< in units of scaled_area() with that scale
  std::atomic<std::uint32_t> next_node_{1};
};

}  // namespace

BinaryTree build_binary_tree(const Geometry& geometry, BuildQuality quality, Splits splits) {
  BinaryTree tree;
  Builder(geometry, quality, splits, tree).run();
  if (quality == BuildQuality::best) reinsert_subtrees(tree);
  return tree;
}

}  // namespace raylab::bvh
