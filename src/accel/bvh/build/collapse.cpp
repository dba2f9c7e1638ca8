#include "collapse.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "binary_tree.hpp"
#include "raylab/core/check.hpp"
#include "raylab/core/parallel.hpp"
#include "vertex_set.hpp"

namespace raylab::bvh {

namespace {

/// For each number of lanes of a wide node, the best cover of a binary subtree: the one with the least total area of
/// wide nodes and leaves, which is the cost of the surface area heuristic.
struct CollapseCost {
  double area[kWidth];            ///< [k]: that of the subtree's wide nodes and leaves if it has k lanes, k >= 1
  std::uint8_t left[kWidth + 1];  ///< [k]: of k lanes those that go to the left child; 0: one lane takes it all.
                                  ///< [kWidth]: as a wide node of its own
};

/// By dynamic programming from the leaves up, after Ylitie, Karras and Laine 2017, "Efficient Incoherent Ray
/// Traversal on GPUs Through Compressed Wide BVHs", section 3.1.
std::vector<CollapseCost> collapse_costs(const HugeArray<BinaryNode>& nodes) {
  std::vector<CollapseCost> costs(nodes.size());
  for (std::size_t i = nodes.size(); i-- > 0;) {  // children come after their parents
    const BinaryNode& node = nodes[i];
    CollapseCost& cost = costs[i];
    cost = {};
    cost.area[1] = half_area(node);
    if (!node.is_leaf()) {
      const CollapseCost& l = costs[node.first];
      const CollapseCost& r = costs[node.first + 1];
      double split[kWidth + 1];
      for (int k = 2; k <= kWidth; ++k) {
        split[k] = l.area[1] + r.area[k - 1];
        cost.left[k] = 1;
        for (int i = 2; i < k; ++i) {
          const double area = l.area[i] + r.area[k - i];
          if (area >= split[k]) continue;
          split[k] = area;
          cost.left[k] = static_cast<std::uint8_t>(i);
        }
      }
      cost.area[1] += split[kWidth];
      for (int k = 2; k < kWidth; ++k) {
        cost.area[k] = std::min(split[k], cost.area[1]);
        if (split[k] > cost.area[1]) cost.left[k] = 0;
      }
    } else {
      std::fill(cost.area + 2, std::end(cost.area), cost.area[1]);
    }
  }
  return costs;
}

/// The top of a binary subtree, as many levels of it as one wide node takes in.
class Treelet {
 public:
  Treelet(const BinaryNode* nodes, const std::vector<CollapseCost>& costs, std::uint32_t root) : nodes_(nodes) {
    treelet_[0] = {root, 0};
    open(costs, 0, kWidth);
    number(0);
  }

  int children() const { return children_; }
  /// Index of the binary node that lane i stands for.
  std::uint32_t child(int i) const { return child_[i]; }

  /// The lanes as a direction of that octant meets them, the nearest in the lowest four bits; unused lanes last.
  std::uint32_t order(int octant) const {
    std::uint32_t packed = 0;
    int count = 0;
    append_near_to_far(0, octant, packed, count);
    for (int lane = children_; lane < kWidth; ++lane) append(lane, packed, count);
    return packed;
  }

 private:
  struct TreeletNode {
    std::uint32_t node;
    int left;  ///< child in the treelet, the right one follows; 0 for a lane of the wide node
    int lane = -1;
  };

  const BinaryNode& binary(int node) const { return nodes_[treelet_[node].node]; }

  void open(const std::vector<CollapseCost>& costs, int node, int lanes) {
    const int left_lanes = costs[treelet_[node].node].left[lanes];
    if (left_lanes == 0) return;
    const std::uint32_t child = binary(node).first;
    const int left = size_;
    treelet_[node].left = left;
    treelet_[size_++] = {child, 0};
    treelet_[size_++] = {child + 1, 0};
    open(costs, left, left_lanes);
    open(costs, left + 1, lanes - left_lanes);
  }

  void number(int node) {
    if (treelet_[node].left == 0) {
      treelet_[node].lane = children_;
      child_[children_++] = treelet_[node].node;
      return;
    }
    number(treelet_[node].left);
    number(treelet_[node].left + 1);
  }

  static void append(int lane, std::uint32_t& packed, int& count) {
    packed |= static_cast<std::uint32_t>(lane) << (4 * count++);
  }

  void append_near_to_far(int node, int octant, std::uint32_t& packed, int& count) const {
    const TreeletNode& p = treelet_[node];
    if (p.left == 0) return append(p.lane, packed, count);
    const bool a_is_nearer = meets_first(binary(p.left), binary(p.left + 1), octant);
    append_near_to_far(p.left + (a_is_nearer ? 0 : 1), octant, packed, count);
    append_near_to_far(p.left + (a_is_nearer ? 1 : 0), octant, packed, count);
  }

  /// Whether a ray of that octant that meets both boxes enters a no later than b. Known for certain where a plane
  /// parts them, or one holds the other.
  static bool meets_first(const BinaryNode& a, const BinaryNode& b, int octant) {
    const vec3 apart = glm::max(a.lower, b.lower) - glm::min(a.upper, b.upper);
    const int axis = apart.x >= apart.y && apart.x >= apart.z ? 0 : (apart.y >= apart.z ? 1 : 2);
    if (apart[axis] < 0.0f) {
      if (holds(a, b)) return true;
      if (holds(b, a)) return false;
    }
    const bool a_is_lower = a.lower[axis] + a.upper[axis] <= b.lower[axis] + b.upper[axis];
    return a_is_lower == ((octant >> axis & 1) == 0);
  }

  static bool holds(const BinaryNode& outer, const BinaryNode& inner) {
    return glm::all(glm::lessThanEqual(outer.lower, inner.lower)) &&
           glm::all(glm::greaterThanEqual(outer.upper, inner.upper));
  }

  const BinaryNode* nodes_;
  std::array<TreeletNode, 2 * kWidth - 1> treelet_;
  int size_ = 1;
  std::array<std::uint32_t, kWidth> child_;
  int children_ = 0;
};

/// The lines of a wide node and of its children, which lie side by side.
struct NodeLayout {
  std::uint32_t binary;
  std::uint32_t line;
  std::uint32_t first_child;  ///< line
};

class Collapse {
 public:
  Collapse(const Geometry& geometry, BinaryTree&& binary) : geometry_(geometry), binary_(std::move(binary)) {}

  WideTree run() {
    tree_.primitives = binary_.primitive_count;
    number_primitives();
    if (binary_.primitives.empty()) return std::move(tree_);
    const BinaryNode& root = binary_.nodes[0];
    if (root.is_leaf()) {
      tree_.depth = 1;
      tree_.sah_cost = 1.0;
      tree_.root = child_ref(root, line_count_);
      tree_.lines = HugeArray<CacheLine>(line_count_);
      fill_leaf(root, tree_.root);
    } else {
      costs_ = collapse_costs(binary_.nodes);
      tree_.root = child_ref(root, line_count_);
      lay_out();
      fill();
    }
    return std::move(tree_);
  }

 private:
  void number_primitives() {
    const std::size_t count = binary_.primitives.size();
    tree_.ids = HugeArray<PrimitiveId>(count + 1);
    for (std::size_t i = 0; i < count; ++i) tree_.ids[i] = binary_.primitives[i].id();
    tree_.ids[count] = {HitBatch::kNoHit, 0};
  }

  /// The reference to a node of the tree, which takes the next lines unless it is a sphere.
  static Ref child_ref(const BinaryNode& node, std::uint32_t& next_line) {
    if (node.kind == RefKind::sphere) return make_ref(RefKind::sphere, node.first);
    const Ref ref = make_ref(node.kind, next_line);
    switch (node.kind) {
      case RefKind::triangles:
        next_line += kLines<SharedBlock>;
        break;
      case RefKind::separate:
        next_line += kLines<SeparateBlock>;
        break;
      default:
        next_line += kLines<Node>;
    }
    RAYLAB_CHECK(next_line <= kLargestRefIndex);
    return ref;
  }

  /// Numbers nodes and blocks, those that are near each other in the tree near each other in memory.
  void lay_out() {
    struct Entry {
      std::uint32_t wide;
      int depth;
    };
    layouts_.push_back({0, 0, 0});
    std::vector<Entry> stack{{0, 1}};
    double area = 0.0;
    while (!stack.empty()) {
      const auto [wide, depth] = stack.back();
      stack.pop_back();
      NodeLayout& layout = layouts_[wide];
      area += half_area(binary_.nodes[layout.binary]);
      tree_.depth = std::max(tree_.depth, depth + 1);
      const Treelet treelet(binary_.nodes.data(), costs_, layout.binary);
      layout.first_child = line_count_;
      const auto first_entry = static_cast<std::ptrdiff_t>(stack.size());
      for (int i = 0; i < treelet.children(); ++i) {
        const BinaryNode& child = binary_.nodes[treelet.child(i)];
        const Ref ref = child_ref(child, line_count_);
        if (child.is_leaf()) {
          area += half_area(child);
        } else {
          stack.push_back({static_cast<std::uint32_t>(layouts_.size()), depth + 1});
          layouts_.push_back({treelet.child(i), ref_index(ref), 0});
        }
      }
      std::reverse(stack.begin() + first_entry, stack.end());
    }
    RAYLAB_CHECK(tree_.depth <= kMaxDepth);
    tree_.nodes = layouts_.size();
    const double root_area = half_area(binary_.nodes[0]);
    tree_.sah_cost = root_area > 0.0 ? area / root_area : 0.0;
  }

  void fill() {
    tree_.lines = HugeArray<CacheLine>(line_count_);
    constexpr std::size_t kChunk = 256;
    parallel_for((layouts_.size() + kChunk - 1) / kChunk, [&](std::size_t chunk) {
      const std::size_t end = std::min(layouts_.size(), (chunk + 1) * kChunk);
      for (std::size_t i = chunk * kChunk; i < end; ++i) {
        fill_node(layouts_[i], *new (&tree_.lines[layouts_[i].line]) Node());
      }
    });
  }

  void fill_node(const NodeLayout& layout, Node& node) {
    const Treelet treelet(binary_.nodes.data(), costs_, layout.binary);
    std::uint32_t next_line = layout.first_child;
    for (int lane = 0; lane < kWidth; ++lane) {
      if (lane >= treelet.children()) {
        for (int axis = 0; axis < 3; ++axis) {
          node.planes[2 * axis][lane] = kInfinity;
          node.planes[2 * axis + 1][lane] = -kInfinity;
        }
        node.child[lane] = make_ref(RefKind::end, 0);
        continue;
      }
      const BinaryNode& child = binary_.nodes[treelet.child(lane)];
      for (int axis = 0; axis < 3; ++axis) {
        node.planes[2 * axis][lane] = child.lower[axis];
        node.planes[2 * axis + 1][lane] = child.upper[axis];
      }
      node.child[lane] = child_ref(child, next_line);
      if (child.is_leaf()) fill_leaf(child, node.child[lane]);
    }
    for (int octant = 0; octant < 8; ++octant) node.order[octant] = treelet.order(octant);
  }

  void fill_leaf(const BinaryNode& leaf, Ref ref) const {
    if (leaf.kind == RefKind::triangles) fill_block(leaf, *new (&tree_.lines[ref_index(ref)]) SharedBlock());
    if (leaf.kind == RefKind::separate) fill_block(leaf, *new (&tree_.lines[ref_index(ref)]) SeparateBlock());
  }

  template <class Block>
  void fill_block(const BinaryNode& leaf, Block& block) const {
    block.first = leaf.first;
    block.lanes = (1u << leaf.count) - 1;
    VertexSet vertices;
    for (std::uint32_t lane = 0; lane < leaf.count; ++lane) {
      const Primitive& p = binary_.primitives[leaf.first + lane];
      const TriangleMesh& mesh = geometry_.meshes[p.geometry];
      const uvec3& corners = mesh.triangles[p.primitive];
      for (int c = 0; c < 3; ++c) {
        if constexpr (std::is_same_v<Block, SharedBlock>) {
          block.corner[c][lane] = static_cast<std::uint8_t>(vertices.add(p.geometry, mesh, corners[c]));
        }
        const auto at = static_cast<std::size_t>(corner_of(block, c, static_cast<int>(lane)));
        for (int axis = 0; axis < 3; ++axis) block.position[axis][at] = mesh.positions[corners[c]][axis];
      }
    }
    if constexpr (std::is_same_v<Block, SharedBlock>) block.vertices = static_cast<std::uint32_t>(vertices.size());
  }

  const Geometry& geometry_;
  BinaryTree binary_;
  std::vector<CollapseCost> costs_;
  WideTree tree_;
  std::vector<NodeLayout> layouts_;
  std::uint32_t line_count_ = 0;
};

}  // namespace

std::size_t WideTree::bytes() const { return lines.bytes() + ids.bytes(); }

WideTree build_wide_tree(const Geometry& geometry, BuildQuality quality) {
  const auto build = [&](Splits splits) {
    return Collapse(geometry, build_binary_tree(geometry, quality, splits)).run();
  };
  if (quality != BuildQuality::best) return build(Splits::of_primitives);
  WideTree tree = build(Splits::of_space_too);
  if (tree.ids.size() == tree.primitives + 1) return tree;  // nothing is split
  // Each split lowers the expected cost, yet the whole tree may cost more.
  WideTree whole = build(Splits::of_primitives);
  return tree.sah_cost < whole.sah_cost ? std::move(tree) : std::move(whole);
}

}  // namespace raylab::bvh
