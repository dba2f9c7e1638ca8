#pragma once
// The traversal by one ray from the root to its end.
#include "ray_traversal.hpp"

namespace raylab::bvh {
namespace {

template <Intersector kind, bool any_hit>
[[gnu::always_inline]] inline TraversalHit trace_single(const TreeView& tree, const TraversalRay& ray) {
  DeepStack stack;
  typename BlockTest<kind>::Found inside;
  RayTraversal<kind, any_hit> traversal(ray, {-1.0f, 0.0f, 0.0f, kNoPrimitive}, stack.distances, stack.refs);
  traversal.start_at(tree.root);
  for (;;) {
    switch (traversal.next()) {
      case RefKind::node:
        traversal.visit_node_and_go_on(tree);
        continue;
      case RefKind::triangles:
        traversal.template visit_block<SharedBlock>(tree, inside);
        break;
      case RefKind::separate:
        traversal.template visit_block<SeparateBlock>(tree, inside);
        break;
      case RefKind::sphere:
        traversal.visit_sphere(tree);
        break;
      default:
        return traversal.best();
    }
    traversal.go_on(tree);
  }
}

template <Intersector kind>
TraversalHit intersect(const TreeView& tree, const TraversalRay& ray) noexcept {
  return trace_single<kind, false>(tree, ray);
}
template <Intersector kind>
bool occluded(const TreeView& tree, const TraversalRay& ray) noexcept {
  return trace_single<kind, true>(tree, ray).primitive_slot != kNoPrimitive;
}

}  // namespace
}  // namespace raylab::bvh
