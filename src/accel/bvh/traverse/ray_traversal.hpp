#pragma once
// One ray on its way through the tree, visit by visit: what single rays and interleaved ones have in common.
#include "block_test.hpp"
#include "push.hpp"

namespace raylab::bvh {
namespace {

/// What a reference points at, unless that is a sphere or nothing.
template <class T>
const T& at(const TreeView& tree, Ref ref) {
  static_assert(sizeof(CacheLine) == 64);
  const auto* lines = reinterpret_cast<const char*>(tree.lines);
  return *reinterpret_cast<const T*>(lines + (static_cast<std::size_t>(ref & ~7u) << 3));
}

/// Centre and radius of the sphere in a slot.
inline const float* sphere_at(const TreeView& tree, std::uint32_t primitive_slot) {
  static_assert(sizeof(Sphere) == 4 * sizeof(float));
  return reinterpret_cast<const float*>(tree.spheres + tree.ids[primitive_slot].primitive);
}

/// Asks for a node or block before its turn comes, of a SeparateBlock for its beginning: more was measured to be
/// slower. Harmless for what is neither, which leads to an address of nothing: hence no pointer but a number.
inline void prefetch(const TreeView& tree, Ref ref) {
  const auto line = reinterpret_cast<std::uintptr_t>(tree.lines) + (static_cast<std::uintptr_t>(ref & ~7u) << 3);
  for (std::uint32_t i = 0; i < kLines<SharedBlock>; ++i)
    __builtin_prefetch(reinterpret_cast<const void*>(line + i * sizeof(CacheLine)));
}

/// Whether the primitive in slot a has the smaller id.
inline bool id_precedes(const TreeView& tree, std::uint32_t a, std::uint32_t b) {
  const PrimitiveId &x = tree.ids[a], &y = tree.ids[b];
  return x.geometry < y.geometry || (x.geometry == y.geometry && x.primitive < y.primitive);
}

/// Replaces the best hit by one that is no farther. At equal distance the smallest id wins.
inline void take(const TraversalHit& hit, const TreeView& tree, TraversalHit& best, float& limit) {
  if (hit.t == best.t && !id_precedes(tree, hit.primitive_slot, best.primitive_slot)) return;
  best = hit;
  limit = hit.t;
  __builtin_prefetch(tree.ids + hit.primitive_slot);  // wanted when the traversal is done
}

/// Room for what is yet to be visited.
struct DeepStack {
  alignas(64) float distances[kStackSize];
  alignas(64) Ref refs[kStackSize];
};

/// Nearest hit, or any. Children are visited in the order of the octant of the ray's direction, which needs no sorting
/// and, being an order of the binary tree below, is the same for nodes of any width; what begins behind the best hit so
/// far is dropped when its turn comes. Any hit needs no order and no distances.
template <Intersector kind, bool any_hit>
class RayTraversal {
 public:
  using Found = typename BlockTest<kind>::Found;

  /// The ray must outlive it. `best` is a hit at its limit, or has no slot and -1 for t.
  RayTraversal(const TraversalRay& ray, const TraversalHit& best, float* distances, Ref* refs)
      : ray_(ray),
        box_test_(ray),
        block_test_(ray),
        best_(best),
        limit_(ray.limit()),
        distances_(distances),
        refs_(refs) {
    distances_[0] = -1.0f;
    refs_[0] = make_ref(RefKind::end, 0);
  }
  RayTraversal(const RayTraversal&) = delete;
  RayTraversal& operator=(const RayTraversal&) = delete;

  const TraversalRay& ray() const { return ray_; }
  /// What its next visit is to.
  RefKind next() const { return ref_kind(ref_); }
  Ref ref() const { return ref_; }
  /// With any_hit only its slot says something: whether there is one.
  const TraversalHit& best() const { return best_; }
  float limit() const { return limit_; }

  void start_at(Ref ref) { ref_ = ref; }

  /// Adds what is yet to be visited, from `distance` on: the farthest first, or in any order with any_hit.
  void add(Ref ref, float distance) {
    float* const distances = distances_;  // local, since to the compiler a store of a Ref could change the members
    Ref* const refs = refs_;
    int at = ++top_;
    for (; !any_hit && distances[at - 1] < distance && at > 1; --at) {
      distances[at] = distances[at - 1];
      refs[at] = refs[at - 1];
    }
    distances[at] = distance;
    refs[at] = ref;
  }

  [[gnu::always_inline]] void visit_node(const TreeView& tree) {
    const auto& node = at<Node>(tree, ref_);
    const NodeInterval interval = box_test_(node, Float<kWidth>(limit_));
    if constexpr (any_hit) {
      top_ += push_any(interval, node, refs_ + top_ + 1);
    } else {
      top_ += push_ordered(interval, node, box_test_.octant(), distances_ + top_ + 1, refs_ + top_ + 1);
    }
  }

  template <class Block>
  [[gnu::always_inline]] void visit_block(const TreeView& tree, Found& inside) {
    const Block& block = at<Block>(tree, ref_);
    decide_all<Block>(tree, block_test_.template find<any_hit>(block, limit_, inside),
                      [&](int lane, TraversalHit& hit) {
                        return block_test_.template decide<any_hit>(block, inside, lane, limit_, hit);
                      });
  }
  /// The same in two steps: the lanes inside whose edges the ray passes, ...
  template <class Block>
  std::uint32_t find_inside(const TreeView& tree, Found& inside) const {
    return block_test_.find_inside(at<Block>(tree, ref_), inside);
  }
  /// ... and which of those it hits.
  template <class Block>
  void decide(const TreeView& tree, const Found& inside, std::uint32_t found) {
    const Block& block = at<Block>(tree, ref_);
    decide_all<Block>(tree, found, [&](int lane, TraversalHit& hit) {
      return block_test_.template decide_one<any_hit>(block, inside, lane, limit_, hit);
    });
  }

  void visit_sphere(const TreeView& tree) {
    const float* const s = sphere_at(tree, ref_index(ref_));
    float t;
    if (sphere_hit<kind>(three(ray_.origin), three(ray_.direction), {s[0], s[1], s[2]}, s[3], ray_.t_min(), limit_, t))
      take_sphere(tree, t);
  }
  void take_sphere(const TreeView& tree, float t) {
    const std::uint32_t slot = ref_index(ref_);
    if (any_hit) return end(slot);
    take({t, 0.0f, 0.0f, slot}, tree, best_, limit_);
  }

  /// From a node to what is next, which is not read back from the stack: a ray alone would wait for it.
  [[gnu::always_inline]] void visit_node_and_go_on(const TreeView& tree) {
    const auto& node = at<Node>(tree, ref_);
    const NodeInterval interval = box_test_(node, Float<kWidth>(limit_));
    const std::uint32_t hit = (interval.near <= interval.far).bits();
    if (hit == 0) return go_on(tree);
    Ref next;
    if constexpr (any_hit) {
      top_ += push_any(interval, node, refs_ + top_ + 1) - 1;
      next = node.child[31 - __builtin_clz(hit)];
    } else {
      top_ += push_ordered(interval, node, box_test_.octant(), distances_ + top_ + 1, refs_ + top_ + 1) - 1;
      next = node.child[first_in_order(node.order[box_test_.octant()], hit)];
    }
    ref_ = next;
    prefetch(tree, refs_[top_]);
  }

  /// To what is next.
  [[gnu::always_inline]] void go_on(const TreeView& tree) {
    if constexpr (!any_hit) {
      while (distances_[top_] > limit_) --top_;
    }
    ref_ = refs_[top_--];
    prefetch(tree, ref_);
  }

 protected:
  /// Nothing more to be visited.
  void end(std::uint32_t primitive_slot) {
    best_.primitive_slot = primitive_slot;
    top_ = 0;
  }
  template <class Block, class Decide>
  [[gnu::always_inline]] void decide_all(const TreeView& tree, std::uint32_t found, const Decide& decide) {
    for (; found != 0; found &= found - 1) {
      TraversalHit hit;
      if (!decide(__builtin_ctz(found), hit)) continue;
      if (any_hit) return end(hit.primitive_slot);
      take(hit, tree, best_, limit_);
    }
  }

  const TraversalRay& ray_;  ///< not copied: a wider load of what was just written would wait for it
  BoxTest box_test_;
  BlockTest<kind> block_test_;
  TraversalHit best_;
  float limit_;
  Ref ref_;
  int top_ = 0;
  float* distances_;
  Ref* refs_;
};

}  // namespace
}  // namespace raylab::bvh
