#pragma once
// The binary trees of the steps between the book's and `bvh`.
#include <cstdint>
#include <vector>

#include "raylab/core/bounds.hpp"
#include "raylab/geometry/geometry.hpp"

namespace raylab::bench {

enum class LadderSplit { median, heuristic };

/// Splits by the median alone halve 2^32 primitives in 32 steps; the heuristic may take longer, but stops here.
inline constexpr int kDeepestHeuristic = 64;
inline constexpr int kStack = kDeepestHeuristic + 34;

/// A leaf has its primitives in the order of the tree, an inner node its two children side by side.
struct LadderNode {
  Bounds bounds;
  std::uint32_t first;
  std::uint32_t count;  ///< 0: inner

  bool is_leaf() const { return count != 0; }
};

struct LadderTree {
  std::vector<PrimitiveId> ids;
  std::vector<LadderNode> nodes;  ///< the root first; none without primitives
  int depth = 0;
};

LadderTree build_ladder_tree(const Geometry& geometry, LadderSplit split);

}  // namespace raylab::bench
