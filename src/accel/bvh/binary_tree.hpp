#pragma once
// The binary tree over all primitives, before it is made wide.
#include <cstdint>

#include "huge_array.hpp"
#include "raylab/accel/accelerator.hpp"
#include "raylab/core/bounds.hpp"

namespace raylab::bvh {

/// A primitive while the tree is built: its conservative bounds and its id.
struct alignas(16) Primitive {
  vec3 lower;
  std::uint32_t geometry;
  vec3 upper;
  std::uint32_t primitive;

  PrimitiveId id() const { return {geometry, primitive}; }
};
static_assert(sizeof(Primitive) == 32);

struct alignas(16) BinaryNode {
  vec3 lower;
  std::uint32_t first;  ///< leaf: place of its first primitive; inner node: index of the left child, the right
                        ///< one follows
  vec3 upper;
  std::uint32_t count;  ///< of primitives in a leaf; 0 in an inner node

  bool is_leaf() const { return count != 0; }
};
static_assert(sizeof(BinaryNode) == 32);

/// Half the surface area of a box that is not empty.
template <class Box>
float half_area(const Box& box) {
  const vec3 d = box.upper - box.lower;
  return d.x * d.y + d.y * d.z + d.z * d.x;
}

struct BinaryTree {
  HugeArray<Primitive> primitives;  ///< the valid ones, in the order of the leaves
  HugeArray<BinaryNode> nodes;      ///< the root first, children after their parents; none without primitives
};

/// The tree does not depend on the number of threads. A leaf is one sphere, or triangles that fit a
/// TriangleBlock, in ascending order of their ids. No leaf is deeper than kMaxDepth.
BinaryTree build_binary_tree(const Geometry& geometry, BvhQuality quality);

}  // namespace raylab::bvh
