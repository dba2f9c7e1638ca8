#pragma once
// A better binary tree from a good one.
#include "binary_tree.hpp"

namespace raylab::bvh {

/// Takes subtrees out and puts them in where the areas of all inner nodes together grow least, until that sum
/// hardly falls any more, or the tree would get deeper than kMaxDepth: it is what the surface area heuristic
/// expects a ray to meet. Leaves stay as they are. The result does not depend on the number of threads or on how
/// nodes are numbered.
///
/// After Meister and Bittner 2018, "Parallel Reinsertion for Bounding Volume Hierarchy Optimization".
void reinsert_subtrees(BinaryTree& tree);

}  // namespace raylab::bvh
