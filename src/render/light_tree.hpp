#pragma once
// A tree over the emitters of a scene, from whose root one is chosen by what it may give at a point (Conty Estévez and
// Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree Splitting"). Nodes have as many children as the
// widest vectors have lanes: what those of one node give is found at once.
#include <cstdint>
#include <span>
#include <vector>

#include "raylab/core/bounds.hpp"
#include "raylab/core/numeric.hpp"

namespace raylab {

/// An emitter as a tree sees it.
struct TreeEmitter {
  vec3 center;     ///< of a sphere that holds it
  float radius;    ///< of that sphere
  float strength;  ///< radiant intensity where that is largest
  vec3 ng;         ///< unit: the intensity falls with the cosine to it, on both sides; 0: it is the same all round
  std::uint32_t geometry, primitive;
};

/// What choosing reads of a node's children; those that are not there have strength 0.
struct alignas(64) LightNode {
  static constexpr std::uint32_t kWidth = 16;
  float center[3][kWidth];  ///< with the radius: a sphere that holds the child's emitters
  float radius[kWidth];
  float strength[kWidth];        ///< sum of radiant intensities along the axis
  std::uint32_t facing[kWidth];  ///< see pack_facing()
};
static_assert(sizeof(LightNode) == 24 * LightNode::kWidth);

/// Where a node's children stand, and where it stands itself.
struct LightLink {
  static constexpr std::uint32_t kLeaf = 1u << 31;
  std::uint32_t first;   ///< the first child: a node or, with bit kLeaf, an emitter; the others follow
  std::uint32_t parent;  ///< place of the node: its parent's index times kWidth, and its number among the children
};

/// Which primitive an emitter is.
struct EmitterId {
  std::uint32_t geometry, primitive;
};

/// What choosing reads of a tree, and of the numbers that choose something else.
struct LightTreeView {
  const LightNode* nodes = nullptr;
  const LightLink* links = nullptr;
  std::uint64_t end = 0;  ///< the least number in units of 2^-64 that does not choose from the tree; 0: there is none
  float probability = 1.0f;  ///< of the tree
};

/// Built once; see choose_light() and light_probability() in light_choice.hpp.
class LightTree {
 public:
  LightTree() = default;
  explicit LightTree(std::vector<TreeEmitter> emitters);

  bool empty() const { return nodes_.empty(); }
  /// Of a tree whose numbers end where it says.
  LightTreeView view(std::uint64_t end) const;
  /// In the order in which rising numbers choose them.
  std::span<const EmitterId> emitters() const { return ids_; }
  /// Place of a primitive that emits; kNowhere of others.
  static constexpr std::uint32_t kNowhere = ~0u;
  std::uint32_t place(std::uint32_t geometry, std::uint32_t primitive) const;
  std::size_t bytes() const;

 private:
  struct Cluster;
  static Cluster cluster_of(std::span<const TreeEmitter> emitters);
  static void split(std::span<TreeEmitter> emitters, std::size_t first, std::size_t block,
                    std::vector<std::size_t>& ends);
  void build(std::uint32_t node, std::span<TreeEmitter> emitters, std::size_t begin, std::size_t end);
  void set_child(std::uint32_t node, std::uint32_t child, std::span<const TreeEmitter> emitters);

  std::vector<LightNode> nodes_;
  std::vector<LightLink> links_;
  std::vector<EmitterId> ids_;
  std::vector<std::uint32_t> first_place_;  ///< of each geometry
  std::vector<std::uint32_t> places_;
};

}  // namespace raylab
