#include "reinsertion.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "../layout/layout.hpp"
#include "raylab/core/parallel.hpp"

namespace raylab::bvh {

namespace {

constexpr std::size_t kChunk = 256;
constexpr int kMostRounds = 12;
/// Nodes looked at for one that might move: large boxes in each other would have it look at all.
constexpr int kMostVisits = 2000;
/// Rounds go on while one lowers the sum of areas by more than this part of it.
constexpr double kWorthARound = 0.002;

struct Box {
  vec3 lower, upper;
};

template <class A, class B>
Box joined(const A& a, const B& b) {
  return {glm::min(a.lower, b.lower), glm::max(a.upper, b.upper)};
}

/// A subtree that might move, and how much smaller the sum of areas would be.
struct Move {
  std::uint32_t node = 0;
  std::uint32_t target = 0;  ///< its new sibling
  double gain = 0.0;
};

/// Siblings are stored side by side from index 1 on, so what is known of both of a pair has one place.
std::uint32_t pair_of(std::uint32_t node) { return (node - 1) / 2; }
std::uint32_t sibling_of(std::uint32_t node) { return ((node - 1) ^ 1u) + 1; }

class Optimizer {
 public:
  explicit Optimizer(const BinaryTree& tree) : nodes_(numbered(tree.nodes[0], tree.nodes.data())) {
    parents_.resize(nodes_.size() / 2);
    for (std::uint32_t i = 0; i < nodes_.size(); ++i) put(i, nodes_[i]);
  }

  void run() {
    double before = refit();
    for (int round = 0; round < kMostRounds; ++round) {
      const std::vector<BinaryNode> nodes = nodes_;
      const std::vector<std::uint32_t> parents = parents_;
      apply(find_moves());
      const double after = refit();
      if (!(after < before)) {
        nodes_ = nodes;
        parents_ = parents;
        return;
      }
      if (before - after < kWorthARound * before) return;
      before = after;
    }
  }

  void write(BinaryTree& tree) const {
    const std::vector<BinaryNode> nodes = numbered(nodes_[0], nodes_.data());
    std::copy(nodes.begin(), nodes.end(), tree.nodes.begin());
  }

 private:
  /// The nodes numbered from the root down, level by level, which does not depend on how they were.
  static std::vector<BinaryNode> numbered(const BinaryNode& root, const BinaryNode* from) {
    std::vector<BinaryNode> nodes{root};
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (nodes[i].is_leaf()) continue;
      const std::uint32_t child = nodes[i].first;
      nodes[i].first = static_cast<std::uint32_t>(nodes.size());
      nodes.push_back(from[child]);
      nodes.push_back(from[child + 1]);
    }
    return nodes;
  }

  std::uint32_t parent_of(std::uint32_t node) const { return parents_[pair_of(node)]; }

  /// Boxes of the inner nodes from those of the leaves. Returns the sum of the inner nodes' areas, infinity where
  /// the tree is too deep.
  double refit(std::uint32_t index = 0, int depth = 1) {
    BinaryNode& node = nodes_[index];
    if (node.is_leaf()) return 0.0;
    if (depth >= kMaxDepth) return kInfinity;  // too deep: the round will be taken back
    const double below = refit(node.first, depth + 1) + refit(node.first + 1, depth + 1);
    const Box box = joined(nodes_[node.first], nodes_[node.first + 1]);
    node.lower = box.lower;
    node.upper = box.upper;
    return below + half_area(box);
  }

  std::vector<Move> find_moves() const {
    std::vector<Move> moves(nodes_.size());
    parallel_for((nodes_.size() + kChunk - 1) / kChunk, [&](std::size_t chunk) {
      std::vector<std::pair<double, std::uint32_t>> stack;
      const auto end = static_cast<std::uint32_t>(std::min<std::size_t>(nodes_.size(), (chunk + 1) * kChunk));
      for (auto i = static_cast<std::uint32_t>(chunk * kChunk); i < end; ++i) moves[i] = find_move(i, stack);
    });
    std::erase_if(moves, [](const Move& m) { return !(m.gain > 0.0); });
    std::sort(moves.begin(), moves.end(),
              [](const Move& a, const Move& b) { return a.gain != b.gain ? a.gain > b.gain : a.node < b.node; });
    return moves;
  }

  /// The best new position for a node. Taking it out saves its parent and shrinks the boxes above; putting it in as the
  /// sibling of another node adds their common box, and grows the boxes between that and the path upwards. The search
  /// skips subtrees where the saved area, less the growth so far and the node's own area (the least that the common box
  /// can have), cannot beat the best gain.
  Move find_move(std::uint32_t node, std::vector<std::pair<double, std::uint32_t>>& stack) const {
    Move best{node, 0, 0.0};
    if (node == 0) return best;
    const double own = half_area(nodes_[node]);
    const std::uint32_t parent = parent_of(node);
    double saved = half_area(nodes_[parent]);
    std::uint32_t sibling = sibling_of(node);
    std::uint32_t above = parent;
    int visits = 0;
    Box without{nodes_[sibling].lower, nodes_[sibling].upper};  // `above`, once the node is out
    for (;;) {
      stack.emplace_back(saved, sibling);
      while (!stack.empty()) {
        const auto [left, candidate] = stack.back();
        stack.pop_back();
        if (left - own <= best.gain) continue;
        if (++visits > kMostVisits) {
          stack.clear();
          return best;
        }
        const BinaryNode& other = nodes_[candidate];
        const double gain = left - half_area(joined(other, nodes_[node]));
        if (gain > best.gain && candidate != sibling_of(node)) best = {node, candidate, gain};
        if (other.is_leaf()) continue;
        const double left_below = gain + half_area(other);
        if (left_below - own <= best.gain) continue;
        stack.emplace_back(left_below, other.first);
        stack.emplace_back(left_below, other.first + 1);
      }
      if (above != parent) {
        without = joined(without, nodes_[sibling]);
        // As sibling of the rest of `above`: the common box is the box of `above` now.
        const double gain = saved - half_area(without);
        if (gain > best.gain) best = {node, above, gain};
        saved += half_area(nodes_[above]) - half_area(without);
      }
      if (above == 0) return best;
      sibling = sibling_of(above);
      above = parent_of(above);
    }
  }

  /// Makes the moves, the best first, as far as none before has changed what they would.
  void apply(const std::vector<Move>& moves) {
    std::vector<char> changed(nodes_.size(), 0);
    for (const Move& move : moves) {
      const std::uint32_t sibling = sibling_of(move.node), parent = parent_of(move.node);
      const std::uint32_t touched[] = {move.node, sibling, parent, move.target,
                                       move.target == 0 ? 0 : parent_of(move.target)};
      const auto has_changed = [&](std::uint32_t i) { return changed[i] != 0; };
      if (std::any_of(std::begin(touched), std::end(touched), has_changed)) continue;
      if (is_below(move.target, move.node)) continue;  // another move took it there
      for (const std::uint32_t i : touched) changed[i] = 1;
      const std::uint32_t pair = std::min(move.node, sibling);
      const BinaryNode moved = nodes_[move.node];
      put(parent, nodes_[sibling]);
      put(pair, nodes_[move.target]);
      put(pair + 1, moved);
      nodes_[move.target].first = pair;
      nodes_[move.target].count = 0;
      nodes_[move.target].kind = RefKind::node;
      parents_[pair_of(pair)] = move.target;
    }
  }

  void put(std::uint32_t index, const BinaryNode& node) {
    nodes_[index] = node;
    if (!node.is_leaf()) parents_[pair_of(node.first)] = index;
  }

  bool is_below(std::uint32_t node, std::uint32_t top) const {
    for (; node != 0; node = parent_of(node)) {
      if (node == top) return true;
    }
    return false;
  }

  std::vector<BinaryNode> nodes_;
  std::vector<std::uint32_t> parents_;  ///< by pair
};

}  // namespace

void reinsert_subtrees(BinaryTree& tree) {
  if (tree.nodes.empty() || tree.nodes[0].is_leaf()) return;
  Optimizer optimizer(tree);
  optimizer.run();
  optimizer.write(tree);
}

}  // namespace raylab::bvh
