#pragma once
// The traversal by one ray; as local to the including file as box_test.hpp. Its loop is written out three times,
// for the nearest hit, for any hit, and in flight.hpp: as one template it was measured to be 3 to 6% slower.
#include "block_test.hpp"

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

/// Centre and radius of the sphere at a place.
inline const float* sphere_at(const TreeView& tree, std::uint32_t place) {
  static_assert(sizeof(Sphere) == 4 * sizeof(float));
  return reinterpret_cast<const float*>(tree.spheres + tree.ids[place].primitive);
}

/// Asks for a node or block before its turn comes, of a SeparateBlock for its beginning: more was measured to be
/// slower. Harmless for what is neither.
inline void prefetch(const TreeView& tree, Ref ref) {
  const CacheLine* const line = &at<CacheLine>(tree, ref);
  for (std::uint32_t i = 0; i < kLines<SharedBlock>; ++i) __builtin_prefetch(line + i);
}

/// Takes the nearest hit in a block that is no farther than the limit.
template <class Test, class Block>
[[gnu::always_inline]] inline void intersect_block(const Block& block, const Test& test, typename Test::Found& inside,
                                                   const TreeView& tree, KernelHit& best, float& limit) {
  for (std::uint32_t found = test.template find<false>(block, limit, inside); found != 0; found &= found - 1) {
    KernelHit hit;
    if (test.template decide<false>(block, inside, __builtin_ctz(found), limit, hit)) take(hit, tree, best, limit);
  }
}

template <class Test, class Block>
[[gnu::always_inline]] inline bool block_occludes(const Block& block, const Test& test, typename Test::Found& inside,
                                                  float limit) {
  for (std::uint32_t found = test.template find<true>(block, limit, inside); found != 0; found &= found - 1) {
    KernelHit hit;
    if (test.template decide<true>(block, inside, __builtin_ctz(found), limit, hit)) return true;
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
  const BlockTest<kind> block_test(ray);
  typename BlockTest<kind>::Found inside;
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
      intersect_block(at<SharedBlock>(tree, ref), block_test, inside, tree, best, limit);
    } else if (ref_kind(ref) == RefKind::separate) {
      intersect_block(at<SeparateBlock>(tree, ref), block_test, inside, tree, best, limit);
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
  const BlockTest<kind> block_test(ray);
  typename BlockTest<kind>::Found inside;
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
      if (block_occludes(at<SharedBlock>(tree, ref), block_test, inside, ray.limit)) return true;
    } else if (ref_kind(ref) == RefKind::separate) {
      if (block_occludes(at<SeparateBlock>(tree, ref), block_test, inside, ray.limit)) return true;
    } else if (ref_kind(ref) == RefKind::sphere) {
      float t;
      if (hit_sphere<kind>(tree.context, ref_index(ref), ray, ray.limit, t)) return true;
    } else {
      return false;
    }
    ref = refs[top--];
  }
}

}  // namespace
}  // namespace raylab::bvh
