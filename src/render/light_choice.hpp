#pragma once
// Choice of an emitter from a LightTree. F is what the children of a node are handled in, one or a vector at a time:
// each gives the same bits.
#include <type_traits>

#include "core/simd/lanes.hpp"
#include "light_lanes.hpp"
#include "light_tree.hpp"

namespace raylab {
namespace {

template <class F>
F load_lanes(const float* from) {
  if constexpr (std::is_same_v<F, float>) {
    return *from;
  } else {
    return F::load(from);
  }
}
template <class F>
UIntOf<F> load_lanes(const std::uint32_t* from) {
  if constexpr (std::is_same_v<F, float>) {
    return *from;
  } else {
    return UIntOf<F>::load(from);
  }
}
inline void store_lanes(float x, float* to) { *to = x; }
template <class F>
void store_lanes(const F& x, float* to) {
  x.store(to);
}

/// Where light is to be received.
struct Receiver {
  Vec3<float> position;
  Vec3<float> ng;  ///< unit, on the side that receives; 0: every side does
  bool one_sided() const { return !is_black(ng); }
};

/// What the children of a node may give to a receiver, relative to one another: their strength, over the square of the
/// distance, times the root mean square of the cosines there, times the cosine here. A child may be as near as its
/// sphere and have any part of what that spans, so none that gives light is ever left out.
template <class F>
void child_weights(const LightNode& node, const Receiver& to, float (&weights)[LightNode::kWidth]) {
  const Vec3<float>& p = to.position;
  constexpr std::uint32_t kStep = sizeof(F) / sizeof(UIntOf<float>);
  for (std::uint32_t i = 0; i < LightNode::kWidth; i += kStep) {
    const Vec3<F> way(load_lanes<F>(node.center[0] + i) - F(p.x), load_lanes<F>(node.center[1] + i) - F(p.y),
                      load_lanes<F>(node.center[2] + i) - F(p.z));
    const F radius = load_lanes<F>(node.radius + i);
    const UIntOf<F> facing = load_lanes<F>(node.facing + i);
    const auto axis = [&](int shift) { return to_float((facing >> shift) & 255u) * F(1.0f / 127.0f) - F(1.0f); };
    const F all_round = to_float(facing >> 24) * F(1.0f / 255.0f);
    const F radius2 = radius * radius, distance2 = dot(way, way);
    const F inv_distance2 = F(1.0f) / max(max(distance2, radius2), F(0x1p-100f));
    const F along = dot(Vec3<F>(axis(0), axis(8), axis(16)), way);
    const F cosine2 = (along * along + (all_round * (distance2 - along * along) + radius2)) * inv_distance2;
    F cosines2 = max(min(cosine2, F(1.0f)), F(0.0f));
    if (to.one_sided()) {
      const F above = max(dot(Vec3<F>(F(to.ng.x), F(to.ng.y), F(to.ng.z)), way) + radius, F(0.0f));
      cosines2 = cosines2 * min(above * above * inv_distance2, F(1.0f));
    }
    const F weight = load_lanes<F>(node.strength + i) * (sqrt(cosines2) * inv_distance2);
    store_lanes(weight, weights + i);
  }
}

/// The weights of a node's children, and their sums in double: so that even the weakest of many is chosen as often as
/// its share says.
struct WeightSums {
  float weight[LightNode::kWidth];
  double before[4];  ///< of every fourth, the sum of those before it
  double total;

  template <class F>
  static WeightSums of(const LightNode& node, const Receiver& to) {
    WeightSums s;
    child_weights<F>(node, to, s.weight);
    double sum = 0.0;
    for (int i = 0; i < 4; ++i) {
      const float* const w = s.weight + 4 * i;
      s.before[i] = sum;
      sum += (static_cast<double>(w[0]) + w[1]) + (static_cast<double>(w[2]) + w[3]);
    }
    s.total = sum;
    return s;
  }
  /// Whether there is something to choose from: not where all have weight 0, or one overflows.
  bool usable() const { return total > 0.0 && total < static_cast<double>(kInfinity); }
};

/// An emitter on its way to be chosen. In steps, so that those of several lanes can overlap: each is a long chain of
/// operations.
struct LightChoice {
  static constexpr std::uint32_t kNotOfTree = ~0u;
  double number;         ///< what is left of that which chooses, in [0, 1)
  double probability;    ///< so far; 0: none is chosen
  std::uint32_t at = 0;  ///< node; in the end an index into LightTree::emitters(), or kNotOfTree for something else

  float u() const { return min(static_cast<float>(number), kBelowOne); }
};

constexpr double kBelowOneDouble = 0x1.fffffffffffffp-1;

/// Begins with a number in units of 2^-64. Returns whether there is a tree to descend.
inline bool begin_choice(const LightTreeView& tree, std::uint64_t select, LightChoice& choice) {
  const auto share = [](std::uint64_t part, std::uint64_t whole) {  // 0 for 2^64
    return min(static_cast<double>(part) / (whole == 0 ? 0x1p64 : static_cast<double>(whole)), kBelowOneDouble);
  };
  if (tree.end != 0 && select >= tree.end) {
    choice = {share(select - tree.end, 0 - tree.end), 1.0 - static_cast<double>(tree.probability),
              LightChoice::kNotOfTree};
    return false;
  }
  choice = {share(select, tree.end), static_cast<double>(tree.probability), 0};
  return true;
}

/// Goes on to a child of the node, by what each may give. Returns whether there are more steps to go.
template <class F>
bool choose_child(const LightTreeView& tree, const Receiver& to, LightChoice& choice) {
  const WeightSums sums = WeightSums::of<F>(tree.nodes[choice.at], to);
  const double target = choice.number * sums.total;
  const std::uint32_t four = (target >= sums.before[1]) + (target >= sums.before[2]) + (target >= sums.before[3]);
  const double in_four = target - sums.before[four];
  const float* const w = sums.weight + 4 * four;
  const double first = w[0], second = first + w[1], third = second + w[2];
  const double begin[4] = {0.0, first, second, third};
  const std::uint32_t child = (in_four >= first) + (in_four >= second) + (in_four >= third);
  const double weight = w[child];
  if (!sums.usable() || !(weight > 0.0)) {  // rounding can lead past the last child
    choice.probability = 0.0;
    return false;
  }
  choice.number = min(max((in_four - begin[child]) / weight, 0.0), kBelowOneDouble);
  choice.probability *= weight / sums.total;
  const std::uint32_t next = tree.links[choice.at].first;
  choice.at = (next & ~LightLink::kLeaf) + 4 * four + child;
  return (next & LightLink::kLeaf) == 0;
}

/// Chooses an emitter by what it may give to a receiver, or something else, by a number in units of 2^-64.
template <class F>
LightChoice choose_light(const LightTreeView& tree, const Receiver& to, std::uint64_t select) {
  LightChoice choice;
  bool more = begin_choice(tree, select, choice);
  while (more) more = choose_child<F>(tree, to, choice);
  return choice;
}

/// The probability with which choose_light() chooses the emitter of a LightTree::place().
template <class F>
float light_probability(const LightTreeView& tree, const Receiver& to, std::uint32_t place) {
  if (place == LightTree::kNowhere) return 0.0f;
  double probability = static_cast<double>(tree.probability);
  for (;;) {
    const std::uint32_t node = place / LightNode::kWidth;
    const WeightSums sums = WeightSums::of<F>(tree.nodes[node], to);
    if (!sums.usable()) return 0.0f;
    probability *= static_cast<double>(sums.weight[place % LightNode::kWidth]) / sums.total;
    if (node == 0) return static_cast<float>(probability);
    place = tree.links[node].parent;
  }
}

}  // namespace
}  // namespace raylab
