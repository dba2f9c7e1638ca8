#pragma once
// The binary tree over all primitives, before it is made wide.
#include <cstdint>

#include "../layout/layout.hpp"
#include "huge_array.hpp"
#include "primitives.hpp"
#include "raylab/accel/accelerator.hpp"

namespace raylab::bvh {

struct alignas(16) BinaryNode {
  vec3 lower;
  std::uint32_t first;  ///< leaf: slot of its first primitive; inner node: index of the left child, the right
                        ///< one follows
  vec3 upper;
  std::uint16_t count;  ///< of primitives in a leaf; 0 in an inner node
  RefKind kind;         ///< node, or what the leaf becomes: triangles, separate or sphere

  bool is_leaf() const { return kind != RefKind::node; }
};
static_assert(sizeof(BinaryNode) == 32);

/// Half the surface area of a box that is not empty. In double, where no box of floats is too small or too large
/// for it.
template <class Box>
double half_area(const Box& box) {
  const dvec3 d = dvec3(box.upper) - dvec3(box.lower);
  return d.x * d.y + d.y * d.z + d.z * d.x;
}

struct BinaryTree {
  std::size_t primitive_count = 0;  ///< valid ones
  HugeArray<Primitive> primitives;  ///< those, in the order of the leaves; some more than once if space is split
  HugeArray<BinaryNode> nodes;      ///< the root first, children after their parents; none without primitives
};

enum class Splits { of_primitives, of_space_too };

/// The tree does not depend on the number of threads. A leaf is one sphere, or up to kBlockSize different
/// triangles in ascending order of their ids. No leaf is deeper than kMaxDepth.
BinaryTree build_binary_tree(const Geometry& geometry, BuildQuality quality, Splits splits = Splits::of_primitives);

}  // namespace raylab::bvh
