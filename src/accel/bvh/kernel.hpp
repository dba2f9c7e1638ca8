#pragma once
// Between the accelerator and its traversal, which is compiled once for each instruction set.
#include "layout.hpp"
#include "raylab/geometry/intersect.hpp"

namespace raylab::bvh {

/// The ray as the traversal takes it. The largest component of the direction is neither so small nor so large
/// that its reciprocal overflows or vanishes. Hits count with t_min < t <= limit: closed above, so that of hits
/// at the same distance the one with the smallest id can be chosen, whatever the order in which they are found.
struct KernelRay {
  float origin[3];
  float direction[3];
  float t_min;
  float limit;
};

inline constexpr std::uint32_t kNoPrimitive = 0xffffffffu;

struct KernelHit {
  float t, u, v;
  std::uint32_t place;  ///< in the order of the tree, or kNoPrimitive
};

/// Rays for the lanes of a vector, side by side, each array as long as the vector. Lanes that are not named hold
/// any numbers.
struct PacketRays {
  const float* origin[3];
  const float* direction[3];
  const float* t_min;
  const float* t_max;   ///< hits count below it
  std::uint32_t lanes;  ///< bit i: lane i is a ray
};
inline constexpr int kLargestPacket = 16;

/// Within this factor of 1, either way, the largest component of a direction needs no rescaling.
inline constexpr float kDirectionRange = 0x1p60f;

struct PacketHits {
  alignas(64) float t[kLargestPacket];
  alignas(64) float u[kLargestPacket];
  alignas(64) float v[kLargestPacket];
  std::uint32_t place[kLargestPacket];  ///< any primitive, if any hit will do
  int turns;                            ///< nodes, blocks and spheres that rays of the packet have visited alone
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
  const void* context;     ///< a Context, for the functions below
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
/// Centre and radius of the sphere at a place.
void sphere_at(const void* context, std::uint32_t place, float (&sphere)[4]) noexcept;
/// Normal of the triangle in a lane of a block, as triangle_normal() computes it.
template <class Block>
void block_normal(const Block& block, int lane, double (&normal)[3]) noexcept;

extern template bool hit_triangle_again(const SharedBlock&, int, const KernelRay&, float, KernelHit&) noexcept;
extern template bool hit_triangle_again(const SeparateBlock&, int, const KernelRay&, float, KernelHit&) noexcept;
extern template float plane_distance(const SharedBlock&, int, const KernelRay&, float) noexcept;
extern template float plane_distance(const SeparateBlock&, int, const KernelRay&, float) noexcept;
extern template void block_normal(const SharedBlock&, int, double (&)[3]) noexcept;
extern template void block_normal(const SeparateBlock&, int, double (&)[3]) noexcept;
/// Whether the primitive at place a has the smaller id.
bool id_precedes(const void* context, std::uint32_t a, std::uint32_t b) noexcept;

/// The traversal compiled for one instruction set.
struct Kernel {
  const char* isa;
  int width;                                                              ///< children a node
  KernelHit (*intersect[3])(const TreeView&, const KernelRay&) noexcept;  ///< by Intersector
  bool (*occluded[3])(const TreeView&, const KernelRay&) noexcept;
  int packet;  ///< rays a packet; its intersector is watertight
  /// Both give the lanes that they leave out, since their directions are too long or too short.
  std::uint32_t (*intersect_packet)(const TreeView&, const PacketRays&, PacketHits&) noexcept;
  std::uint32_t (*occluded_packet)(const TreeView&, const PacketRays&, PacketHits&) noexcept;
  /// Many rays that have little in common. Any hit will do for the second.
  void (*intersect_rays)(const TreeView&, const KernelRay*, int count, KernelHit*) noexcept;
  void (*occluded_rays)(const TreeView&, const KernelRay*, int count, KernelHit*) noexcept;
};

extern const Kernel kKernelSse42;
extern const Kernel kKernelAvx2;
extern const Kernel kKernelAvx512;

}  // namespace raylab::bvh
