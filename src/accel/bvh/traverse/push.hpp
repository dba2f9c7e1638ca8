#pragma once
// The children of a node that a ray may hit, onto the stack of its traversal.
#include "box_test.hpp"

namespace raylab::bvh {
namespace {

using NodeInterval = SlabInterval<Float<kWidth>>;

/// Puts the children with near <= far on the stack, the nearest on top; returns how many there are.
inline int push_ordered(const NodeInterval& interval, const Node& node, int octant, float* distances, Ref* refs) {
#if defined(__AVX2__)
  const UInt<8> lane = unpack_indices_backwards(node.order[octant]);
  const Float<8> near = permute(interval.near, lane);
  const Mask<8> hit = near <= permute(interval.far, lane);
  const Compression8 kept(hit);
  kept.store(near, distances);
  kept.store(permute(UInt<8>::load(node.child), lane), refs);
  return __builtin_popcount(hit.bits());
#else
  const std::uint32_t hit = (interval.near <= interval.far).bits();
  alignas(16) float near[kWidth];
  interval.near.store(near);
  int count = 0;
  for (int i = kWidth - 1; i >= 0; --i) {  // written whether hit or not: cheaper than a wrong guess
    const std::uint32_t lane = node.order[octant] >> (4 * i) & 7u;
    distances[count] = near[lane];
    refs[count] = node.child[lane];
    count += static_cast<int>(hit >> lane & 1u);
  }
  return count;
#endif
}

/// The children with near <= far, the nearest last; returns how many there are.
inline int children_in_order(const NodeInterval& interval, std::uint32_t order, std::uint32_t* children) {
#if defined(__AVX2__)
  const UInt<8> lane = unpack_indices_backwards(order);
  const Mask<8> hit = permute(interval.near, lane) <= permute(interval.far, lane);
  Compression8(hit).store(lane & UInt<8>(7u), children);
  return __builtin_popcount(hit.bits());
#else
  const std::uint32_t hit = (interval.near <= interval.far).bits();
  int count = 0;
  for (int i = kWidth - 1; i >= 0; --i) {
    const std::uint32_t lane = order >> (4 * i) & 7u;
    children[count] = lane;
    count += static_cast<int>(hit >> lane & 1u);
  }
  return count;
#endif
}

/// The first lane of an order, four bits each, whose bit is set in a mask that is not 0.
inline std::uint32_t first_in_order(std::uint32_t order, std::uint32_t mask) {
  while ((mask >> (order & 7u) & 1u) == 0) order >>= 4;
  return order & 7u;
}

/// The same without an order and distances.
inline int push_any(const NodeInterval& interval, const Node& node, Ref* refs) {
  const Mask<8> hit = interval.near <= interval.far;
#if defined(__AVX2__)
  Compression8(hit).store(UInt<8>::load(node.child), refs);
  return __builtin_popcount(hit.bits());
#else
  int count = 0;
  for (std::uint32_t left = hit.bits(); left != 0; left &= left - 1) refs[count++] = node.child[__builtin_ctz(left)];
  return count;
#endif
}

}  // namespace
}  // namespace raylab::bvh
