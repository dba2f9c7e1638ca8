#pragma once
// The tree that is traversed: wide nodes, and leaves laid out for vectors.
#include <cstddef>

#include "../layout/layout.hpp"
#include "huge_array.hpp"
#include "raylab/accel/accelerator.hpp"

namespace raylab::bvh {

struct WideTree {
  HugeArray<CacheLine> lines;  ///< of nodes and blocks
  std::size_t nodes = 0;
  /// By slot in the order of the tree, some more than once if space is split; one more for no hit ends them.
  HugeArray<PrimitiveId> ids;
  std::size_t primitives = 0;  ///< valid ones
  Ref root = make_ref(RefKind::end, 0);
  int depth = 0;          ///< of the deepest leaf, the root being 1
  double sah_cost = 0.0;  ///< nodes, blocks and spheres a random ray that meets the root's box is tested against

  std::size_t bytes() const;
};

WideTree build_wide_tree(const Geometry& geometry, BuildQuality quality);

}  // namespace raylab::bvh
