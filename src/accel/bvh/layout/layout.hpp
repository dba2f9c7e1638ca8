#pragma once
// How the tree lies in memory, as the builder writes it and the traversal reads it.
// Inline functions here are always inlined: files compiled for different instruction sets share this header, and one
// copy of a function that both use could end up in the program as compiled for the newer processor.
#include <cstdint>

namespace raylab::bvh {

/// What a 32-bit reference points at: the low three bits say what, the others which one. Nodes and blocks lie in
/// one array of cache lines.
enum class RefKind : std::uint16_t {
  node = 0,       ///< inner node, by its first line
  triangles = 1,  ///< SharedBlock, by its first line
  separate = 2,   ///< SeparateBlock, by its first line
  sphere = 3,     ///< a primitive, by its slot in the order of the tree
  end = 4,        ///< nothing: the bottom of the traversal stack
};
using Ref = std::uint32_t;

inline constexpr std::uint32_t kLargestRefIndex = 0x1fffffffu;

[[gnu::always_inline]] inline constexpr Ref make_ref(RefKind kind, std::uint32_t index) {
  return index << 3 | static_cast<std::uint32_t>(kind);
}
[[gnu::always_inline]] inline constexpr RefKind ref_kind(Ref ref) { return static_cast<RefKind>(ref & 7u); }
[[gnu::always_inline]] inline constexpr std::uint32_t ref_index(Ref ref) { return ref >> 3; }

/// Most children of an inner node.
inline constexpr int kWidth = 8;

/// Inner node: the boxes of its children, one array a plane.
struct alignas(64) Node {
  /// Lower x, upper x, lower y, upper y, lower z, upper z. An unused lane holds an inside-out infinite box.
  float planes[6][kWidth];
  Ref child[kWidth];
  /// For each octant of directions (bit a set: component a is negative) the lanes from the nearest to the
  /// farthest child, four bits each, the nearest in the lowest.
  std::uint32_t order[8];
};
static_assert(sizeof(Node) == 256);

/// Most triangles in a block, and most different vertices in a SharedBlock.
inline constexpr int kBlockSize = 16;

/// A leaf: triangles over shared vertices. Patches of a mesh have about as many vertices as triangles, so this
/// takes half the memory of three vertices a triangle, and each vertex is transformed once.
struct alignas(64) SharedBlock {
  float position[3][kBlockSize];  ///< x of all vertices, then y, then z; unused ones are 0
  alignas(16) std::uint8_t corner[3][kBlockSize];
  std::uint32_t first;     ///< slot of lane 0 in the order of the tree; the lanes follow, their ids ascending
  std::uint32_t lanes;     ///< bit i set: lane i is a triangle
  std::uint32_t vertices;  ///< how many there are
};

/// A leaf: triangles that share few vertices or none. Those of lane i are i, kBlockSize + i and 2 kBlockSize + i.
struct alignas(64) SeparateBlock {
  float position[3][3 * kBlockSize];
  std::uint32_t first;  ///< as in SharedBlock
  std::uint32_t lanes;
};

/// Which position of a block is corner k of the triangle in a lane.
[[gnu::always_inline]] inline int corner_of(const SharedBlock& block, int k, int lane) { return block.corner[k][lane]; }
[[gnu::always_inline]] inline int corner_of(const SeparateBlock&, int k, int lane) { return k * kBlockSize + lane; }

struct alignas(64) CacheLine {
  unsigned char bytes[64];
};
template <class T>
inline constexpr std::uint32_t kLines = sizeof(T) / sizeof(CacheLine);
static_assert(sizeof(SharedBlock) == 256 && sizeof(SeparateBlock) == 640);

/// Bound of the depth of any tree, in inner nodes of two children; a wide tree over it is no deeper.
inline constexpr int kMaxDepth = 80;

/// Entries the traversal stack can need: all siblings along a path, the sentinel, and since vectors are stored
/// whole a vector more.
inline constexpr int kStackSize = kMaxDepth * (kWidth - 1) + 2 * kWidth;

}  // namespace raylab::bvh
