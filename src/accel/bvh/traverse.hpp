#pragma once
// The traversal by one ray; as local to the including file as ray_tests.hpp. Its loop is written out three times,
// for the nearest hit, for any hit, and step by step: as one template it was measured to be 3 to 6% slower.
#include <new>
#include <type_traits>

#include "ray_tests.hpp"

namespace raylab::bvh {
namespace {

/// Makes the hit, which is no farther than the best one, the best. Of equally near ones the smallest id wins.
inline void take(const KernelHit& hit, const TreeView& tree, KernelHit& best, float& limit) {
  if (hit.t == best.t && !id_precedes(tree.context, hit.place, best.place)) return;
  best = hit;
  limit = hit.t;
  __builtin_prefetch(tree.ids + hit.place);  // wanted when the traversal is done
}

/// What a reference points at, unless that is a sphere or nothing.
template <class T>
const T& at(const TreeView& tree, Ref ref) {
  static_assert(sizeof(CacheLine) == 64);
  const auto* lines = reinterpret_cast<const char*>(tree.lines);
  return *reinterpret_cast<const T*>(lines + (static_cast<std::size_t>(ref & ~7u) << 3));
}

/// Asks for a node or block before its turn comes, of a SeparateBlock for its beginning: more was measured to be
/// slower. Harmless for what is neither.
inline void prefetch(const TreeView& tree, Ref ref) {
  const CacheLine* const line = &at<CacheLine>(tree, ref);
  for (std::uint32_t i = 0; i < kLines<SharedBlock>; ++i) __builtin_prefetch(line + i);
}

/// Takes the nearest hit in a block that is no farther than the limit.
template <class Test, class Block>
[[gnu::always_inline]] inline void intersect_block(const Block& block, Test& test, const TreeView& tree,
                                                   KernelHit& best, float& limit) {
  for (std::uint32_t found = test.template find<false>(block, limit); found != 0; found &= found - 1) {
    KernelHit hit;
    if (test.template decide<false>(block, __builtin_ctz(found), limit, hit)) take(hit, tree, best, limit);
  }
}

template <class Test, class Block>
[[gnu::always_inline]] inline bool block_occludes(const Block& block, Test& test, float limit) {
  for (std::uint32_t found = test.template find<true>(block, limit); found != 0; found &= found - 1) {
    KernelHit hit;
    if (test.template decide<true>(block, __builtin_ctz(found), limit, hit)) return true;
  }
  return false;
}

/// Nearest hit. Children are visited in the order of the octant of the ray's direction, which needs no sorting
/// and, being an order of the binary tree below, is the same for nodes of any width; what begins behind the best
/// hit so far is dropped when its turn comes.
template <class NodeVector, Intersector kind>
KernelHit intersect(const TreeView& tree, const KernelRay& ray) noexcept {
  constexpr int width = NodeVector::lanes;
  const BoxTest<NodeVector> box_test(ray);
  BlockTest<kind> block_test(ray);
  KernelHit best{-1.0f, 0.0f, 0.0f, kNoPrimitive};
  float limit = ray.limit;

  alignas(64) float distances[stack_size(width)];
  alignas(64) Ref refs[stack_size(width)];
  distances[0] = -1.0f;
  refs[0] = make_ref(RefKind::end, 0);
  int top = 0;
  Ref ref = tree.root;
  for (;;) {
    if (ref_kind(ref) == RefKind::node) {
      const auto& node = at<Node<width>>(tree, ref);
      NodeVector near, far;
      box_test(node, NodeVector::splat(limit), near, far);
      const int count = push_ordered(near, far, node.child, node.order[box_test.octant()], distances + top + 1,
                                     refs + top + 1, ref);
      if (count != 0) {
        top += count - 1;
        prefetch(tree, refs[top]);
        continue;
      }
    } else if (ref_kind(ref) == RefKind::triangles) {
      intersect_block(at<SharedBlock>(tree, ref), block_test, tree, best, limit);
    } else if (ref_kind(ref) == RefKind::separate) {
      intersect_block(at<SeparateBlock>(tree, ref), block_test, tree, best, limit);
    } else if (ref_kind(ref) == RefKind::sphere) {
      float t;
      const std::uint32_t place = ref_index(ref);
      if (hit_sphere<kind>(tree.context, place, ray, limit, t)) take({t, 0.0f, 0.0f, place}, tree, best, limit);
    } else {
      return best;
    }
    while (distances[top] > limit) --top;
    ref = refs[top--];
  }
}

/// Any hit. No order, no distances.
template <class NodeVector, Intersector kind>
bool occluded(const TreeView& tree, const KernelRay& ray) noexcept {
  constexpr int width = NodeVector::lanes;
  const BoxTest<NodeVector> box_test(ray);
  BlockTest<kind> block_test(ray);
  const NodeVector limit = NodeVector::splat(ray.limit);

  alignas(64) Ref refs[stack_size(width)];
  refs[0] = make_ref(RefKind::end, 0);
  int top = 0;
  Ref ref = tree.root;
  for (;;) {
    if (ref_kind(ref) == RefKind::node) {
      const auto& node = at<Node<width>>(tree, ref);
      NodeVector near, far;
      box_test(node, limit, near, far);
      const int count = push_any(near, far, node.child, refs + top + 1, ref);
      if (count != 0) {
        top += count - 1;
        prefetch(tree, refs[top]);
        continue;
      }
    } else if (ref_kind(ref) == RefKind::triangles) {
      if (block_occludes(at<SharedBlock>(tree, ref), block_test, ray.limit)) return true;
    } else if (ref_kind(ref) == RefKind::separate) {
      if (block_occludes(at<SeparateBlock>(tree, ref), block_test, ray.limit)) return true;
    } else if (ref_kind(ref) == RefKind::sphere) {
      float t;
      if (hit_sphere<kind>(tree.context, ref_index(ref), ray, ray.limit, t)) return true;
    } else {
      return false;
    }
    ref = refs[top--];
  }
}

/// A query that is taken forward by one node or block at a time, so that several can take turns: while one works
/// the nodes and blocks of the others are on their way from memory, which is what a ray in a large tree mostly
/// waits for.
template <class NodeVector, bool any_hit>
class Flight {
 public:
  static constexpr int width = NodeVector::lanes;
  static constexpr Intersector kind = Intersector::watertight;

  Flight(const TreeView& tree, const KernelRay& ray)
      : tree_(tree), ray_(ray), box_test_(ray_), block_test_(ray_), limit_(ray.limit), ref_(tree.root) {
    distances_[0] = -1.0f;
    refs_[0] = make_ref(RefKind::end, 0);
  }
  Flight(const Flight&) = delete;
  Flight& operator=(const Flight&) = delete;

  /// With any_hit only its place says something: whether there is one.
  const KernelHit& best() const { return best_; }

  /// Visits one node or block and asks for the next. False when there is none, or the answer is known.
  bool step() {
    if (ref_kind(ref_) == RefKind::node) {
      const auto& node = at<Node<width>>(tree_, ref_);
      NodeVector near, far;
      box_test_(node, NodeVector::splat(limit_), near, far);
      const int count = push_ordered(near, far, node.child, node.order[box_test_.octant()], distances_ + top_ + 1,
                                     refs_ + top_ + 1, ref_);
      if (count != 0) {
        top_ += count - 1;
        prefetch(tree_, ref_);
        return true;
      }
    } else if (ref_kind(ref_) == RefKind::triangles) {
      if (ends_in(at<SharedBlock>(tree_, ref_))) return false;
    } else if (ref_kind(ref_) == RefKind::separate) {
      if (ends_in(at<SeparateBlock>(tree_, ref_))) return false;
    } else if (ref_kind(ref_) == RefKind::sphere) {
      float t;
      const std::uint32_t place = ref_index(ref_);
      if (hit_sphere<kind>(tree_.context, place, ray_, limit_, t)) {
        take({t, 0.0f, 0.0f, place}, tree_, best_, limit_);
        if (any_hit) return false;
      }
    }
    while (distances_[top_] > limit_) --top_;
    ref_ = refs_[top_--];
    if (ref_kind(ref_) == RefKind::end) return false;
    prefetch(tree_, ref_);
    return true;
  }

 private:
  /// Takes the nearest hit in a block. True where any was enough.
  template <class Block>
  [[gnu::always_inline]] bool ends_in(const Block& block) {
    if constexpr (any_hit) {
      if (!block_occludes(block, block_test_, limit_)) return false;
      best_.place = block.first;
      return true;
    } else {
      intersect_block(block, block_test_, tree_, best_, limit_);
      return false;
    }
  }

  const TreeView& tree_;
  KernelRay ray_;
  BoxTest<NodeVector> box_test_;
  BlockTest<kind> block_test_;
  KernelHit best_{-1.0f, 0.0f, 0.0f, kNoPrimitive};
  float limit_;
  Ref ref_;
  int top_ = 0;
  alignas(64) float distances_[stack_size(width)];
  alignas(64) Ref refs_[stack_size(width)];
};

/// Queries in turns at one time.
constexpr int kTurns = 8;

/// Answers `count` rays one by one, several of them in turns: ray(i) gives them, and take(i, hit) is given those
/// that hit. Returns how many turns it took.
template <class NodeVector, bool any_hit, class GetRay, class Take>
[[gnu::always_inline]] inline int answer_in_turns(const TreeView& tree, int count, const GetRay& ray,
                                                  const Take& take) {
  using OneRay = Flight<NodeVector, any_hit>;
  static_assert(std::is_trivially_destructible_v<OneRay>);
  alignas(OneRay) unsigned char room[kTurns][sizeof(OneRay)];
  OneRay* flights[kTurns];
  int ray_of[kTurns];
  int flying = 0, next = 0, turns = 0;
  for (; flying < kTurns && next < count; ++flying, ++next) {
    flights[flying] = new (room[flying]) OneRay(tree, ray(next));
    ray_of[flying] = next;
  }
  while (flying != 0) {
    turns += flying;
    for (int i = 0; i < flying;) {
      if (flights[i]->step()) {
        ++i;
        continue;
      }
      if (flights[i]->best().place != kNoPrimitive) take(ray_of[i], flights[i]->best());
      if (next < count) {
        flights[i] = new (static_cast<void*>(flights[i])) OneRay(tree, ray(next));
        ray_of[i++] = next++;
      } else {
        --flying;
        flights[i] = flights[flying];
        ray_of[i] = ray_of[flying];
      }
    }
  }
  return turns;
}

}  // namespace
}  // namespace raylab::bvh
