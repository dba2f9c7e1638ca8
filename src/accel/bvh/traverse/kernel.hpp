#pragma once
// Between the accelerator and its traversal, which is compiled once for each instruction set.
#include "../layout/layout.hpp"
#include "raylab/accel/accelerator.hpp"

namespace raylab::bvh {

/// A ray in the traversal. The largest component of its direction is neither so small nor so large that its reciprocal
/// overflows or vanishes. Hits count with t_min < t <= limit: closed above, so that of hits at the same distance the
/// one with the smallest id can be chosen, whatever the order in which they are found.
struct alignas(16) TraversalRay {
  float origin[4];     ///< x, y, z, and t_min
  float direction[4];  ///< x, y, z, and the limit

  [[gnu::always_inline]] float t_min() const { return origin[3]; }
  [[gnu::always_inline]] float limit() const { return direction[3]; }
};

inline constexpr std::uint32_t kNoPrimitive = 0xffffffffu;
/// Instead of a slot: the direction is too long or too short, so that the ray was left out.
inline constexpr std::uint32_t kLeftOut = 0xfffffffeu;

/// What a ray has found.
struct TraversalHit {
  float t, u, v;
  std::uint32_t primitive_slot;  ///< in the order of the tree, or kNoPrimitive
};

/// Most rays that are answered together.
inline constexpr int kGroup = 256;

/// Within this factor of 1, either way, the largest component of a direction needs no rescaling.
inline constexpr float kDirectionRange = 0x1p60f;

/// Answers of a group, with room for whole vectors.
struct GroupHits {
  alignas(64) float t[kGroup];
  alignas(64) float u[kGroup];
  alignas(64) float v[kGroup];
  std::uint32_t primitive_slot[kGroup];  ///< of any primitive, if any hit will do
};

/// The tree as the traversal sees it.
struct TreeView {
  const CacheLine* lines;
  Ref root;
  const PrimitiveId* ids;  ///< by slot
  const Sphere* spheres;   ///< by primitive of their ids
  bool has_blocks;         ///< whether there are triangles
  bool has_levels;         ///< whether there are nodes below the root
};

/// The traversal compiled for one instruction set.
struct Kernel {
  const char* isa;
  TraversalHit (*intersect[3])(const TreeView&, const TraversalRay&) noexcept;  ///< by Intersector
  bool (*occluded[3])(const TreeView&, const TraversalRay&) noexcept;
  /// Up to kGroup rays, by the watertight test. Those with kLeftOut for a slot have no answer. Takes some 300 KB of
  /// the stack, little of which is touched.
  void (*intersect_group)(const TreeView&, const RayBatch&, GroupHits&) noexcept;
  void (*occluded_group)(const TreeView&, const RayBatch&, GroupHits&) noexcept;
};

#if defined(__x86_64__)
extern const Kernel kKernelSse42;
extern const Kernel kKernelAvx2;
extern const Kernel kKernelAvx512;
#else
extern const Kernel kKernelNeon;
#endif

}  // namespace raylab::bvh
