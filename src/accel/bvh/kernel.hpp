#pragma once
// Between the accelerator and its traversal, which is compiled once for each instruction set.
#include "layout.hpp"
#include "raylab/geometry/intersect.hpp"

namespace raylab::bvh {

/// The ray as the traversal takes it. The largest component of the direction is neither so small nor so large
/// that its reciprocal overflows or vanishes. Hits count with t_min < t <= limit: closed above, so that of hits
/// at the same distance the one with the smallest id can be chosen, whatever the order in which they are found.
struct alignas(16) KernelRay {
  float origin[3];
  float t_min;
  float direction[3];
  float limit;
};

inline constexpr std::uint32_t kNoPrimitive = 0xffffffffu;
/// Instead of a place: the direction is too long or too short, so that the ray was left out.
inline constexpr std::uint32_t kLeftOut = 0xfffffffeu;

struct KernelHit {
  float t, u, v;
  std::uint32_t place;  ///< in the order of the tree, or kNoPrimitive
};

/// Rays side by side.
struct RayColumns {
  const float* origin[3];
  const float* direction[3];
  const float* t_min;
  const float* t_max;  ///< hits count below it
};
/// Most rays that are answered together.
inline constexpr int kGroup = 256;

/// Within this factor of 1, either way, the largest component of a direction needs no rescaling.
inline constexpr float kDirectionRange = 0x1p60f;

/// Room for whole vectors.
struct GroupHits {
  alignas(64) float t[kGroup];
  alignas(64) float u[kGroup];
  alignas(64) float v[kGroup];
  std::uint32_t place[kGroup];  ///< any primitive, if any hit will do
};

/// What the functions below need that the traversal must not see.
struct Context {
  const Geometry* geometry;
  const PrimitiveId* ids;
};

/// The tree as the traversal sees it.
struct TreeView {
  const CacheLine* lines;
  Ref root;
  const PrimitiveId* ids;  ///< by place; what a hit is turned into afterwards
  const Sphere* spheres;   ///< by primitive of their ids
  const void* context;     ///< a Context, for the functions below
  bool has_blocks;         ///< whether there are triangles
};

/// What the traversal leaves to the code that all instruction sets share.
/// The hit nearest to the origin on the sphere at a place in the tree, with t_min < t <= limit.
template <Intersector kind>
bool hit_sphere(const void* context, std::uint32_t place, const KernelRay& ray, float limit, float& t) noexcept;
extern template bool hit_sphere<Intersector::book>(const void*, std::uint32_t, const KernelRay&, float,
                                                   float&) noexcept;
extern template bool hit_sphere<Intersector::fast>(const void*, std::uint32_t, const KernelRay&, float,
                                                   float&) noexcept;
extern template bool hit_sphere<Intersector::watertight>(const void*, std::uint32_t, const KernelRay&, float,
                                                         float&) noexcept;
/// intersect_watertight on the triangle in a lane of a block, with t_min < t <= limit: decides the rare lanes that
/// the vector code cannot. Fills in all of the hit.
template <class Block>
bool hit_triangle_again(const Block& block, int lane, const KernelRay& ray, float limit, KernelHit& hit) noexcept;
/// watertight_plane_distance() of the triangle in a lane of a block.
template <class Block>
float plane_distance(const Block& block, int lane, const KernelRay& ray, float otherwise) noexcept;

extern template bool hit_triangle_again(const SharedBlock&, int, const KernelRay&, float, KernelHit&) noexcept;
extern template bool hit_triangle_again(const SeparateBlock&, int, const KernelRay&, float, KernelHit&) noexcept;
extern template float plane_distance(const SharedBlock&, int, const KernelRay&, float) noexcept;
extern template float plane_distance(const SeparateBlock&, int, const KernelRay&, float) noexcept;
/// Whether the primitive at place a has the smaller id.
bool id_precedes(const void* context, std::uint32_t a, std::uint32_t b) noexcept;

/// The traversal compiled for one instruction set.
struct Kernel {
  const char* isa;
  int width;                                                              ///< children a node
  KernelHit (*intersect[3])(const TreeView&, const KernelRay&) noexcept;  ///< by Intersector
  bool (*occluded[3])(const TreeView&, const KernelRay&) noexcept;
  /// Up to kGroup rays, by the watertight test. Those with kLeftOut for a place have no answer. Takes some 300 KB of
  /// the stack, little of which is touched.
  void (*intersect_group)(const TreeView&, const RayColumns&, int count, GroupHits&) noexcept;
  void (*occluded_group)(const TreeView&, const RayColumns&, int count, GroupHits&) noexcept;
};

extern const Kernel kKernelSse42;
extern const Kernel kKernelAvx2;
extern const Kernel kKernelAvx512;

}  // namespace raylab::bvh
