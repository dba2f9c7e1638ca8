#pragma once
// How the tree lies in memory, as the builder writes it and the traversal reads it.
// This header and kernel.hpp are all that the files compiled for one instruction set share with the rest: an
// inline function used by both could end up in the program as compiled for the newer processor.
#include <cstdint>

namespace raylab::bvh {

/// What a 32-bit reference points at: the low two bits say what, the others which one. Nodes and blocks are items
/// of one array.
enum class RefKind : std::uint32_t {
  node = 0,       ///< inner node, by item
  triangles = 1,  ///< TriangleBlock, by item
  sphere = 2,     ///< a primitive, by its place in the order of the tree
  end = 3,        ///< nothing: the bottom of the traversal stack
};
using Ref = std::uint32_t;

inline constexpr std::uint32_t kLargestRefIndex = 0x3fffffffu;

[[gnu::always_inline]] inline constexpr Ref make_ref(RefKind kind, std::uint32_t index) {
  return index << 2 | static_cast<std::uint32_t>(kind);
}
[[gnu::always_inline]] inline constexpr RefKind ref_kind(Ref ref) { return static_cast<RefKind>(ref & 3u); }
[[gnu::always_inline]] inline constexpr std::uint32_t ref_index(Ref ref) { return ref >> 2; }

/// Inner node: the boxes of up to `width` children, one array a plane.
template <int width>
struct alignas(64) Node {
  /// Lower x, upper x, lower y, upper y, lower z, upper z. An unused lane holds an inside-out infinite box.
  float planes[6][width];
  Ref child[width];
  /// For each octant of directions (bit a set: component a is negative) the lanes from the nearest to the
  /// farthest child, four bits each, the nearest in the lowest.
  std::uint32_t order[8][width / 8];
};
static_assert(sizeof(Node<8>) == 256 && sizeof(Node<16>) == 512);

/// Most triangles, and most different vertices, in a block.
inline constexpr int kBlockSize = 16;

/// A leaf: triangles over shared vertices. Patches of a mesh have about as many vertices as triangles, so this
/// takes half the memory of three vertices a triangle, and each vertex is transformed once.
struct alignas(64) TriangleBlock {
  float position[3][kBlockSize];  ///< x of all vertices, then y, then z; unused ones are 0
  std::uint8_t corner[3][kBlockSize];
  std::uint32_t first;  ///< place of lane 0 in the order of the tree; the lanes follow, their ids ascending
  std::uint32_t lanes;  ///< bit i set: lane i is a triangle
};

/// A node or a block.
struct alignas(64) Item {
  unsigned char bytes[256];
};
static_assert(sizeof(TriangleBlock) == sizeof(Item) && sizeof(Node<8>) == sizeof(Item));

/// Bound of the depth of any tree, in inner nodes of two children; a wide tree over it is no deeper.
inline constexpr int kMaxDepth = 80;

/// Entries the traversal stack can need: all siblings along a path, the sentinel, and since vectors are stored
/// whole a vector more.
constexpr int stack_size(int width) { return kMaxDepth * (width - 1) + 2 * width; }

}  // namespace raylab::bvh
