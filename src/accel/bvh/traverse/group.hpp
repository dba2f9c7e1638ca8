#pragma once
// What a kernel offers, of the three traversals.
#include "packet.hpp"
#include "single.hpp"

namespace raylab::bvh {
namespace {

struct Padded {
  alignas(64) float values[8][kLanes];
};
/// Rays from `first` on, as whole vectors.
inline RayBatch packet_of(const RayBatch& rays, std::size_t first, int count, Padded& padded) {
  RayBatch packet{static_cast<std::size_t>(kLanes),
                  {rays.origin[0] + first, rays.origin[1] + first, rays.origin[2] + first},
                  {rays.direction[0] + first, rays.direction[1] + first, rays.direction[2] + first},
                  rays.t_min + first,
                  rays.t_max + first};
  if (count == kLanes) return packet;
  const auto pad = [&](const float*& from, float* to) {
    for (int i = 0; i < kLanes; ++i) to[i] = i < count ? from[i] : 0.0f;
    from = to;
  };
  for (int axis = 0; axis < 3; ++axis) {
    pad(packet.origin[axis], padded.values[axis]);
    pad(packet.direction[axis], padded.values[3 + axis]);
  }
  pad(packet.t_min, padded.values[6]);
  pad(packet.t_max, padded.values[7]);
  return packet;
}

/// Answers up to kGroup rays: in packets as long as those of a packet stay together, then each alone, interleaved.
template <bool any_hit>
void trace_group(const TreeView& tree, const RayBatch& rays, GroupHits& hits) noexcept {
  const int count = static_cast<int>(rays.count);
  Waiting waiting;
  for (int first = 0; first < count; first += kLanes) {
    const int lanes = count - first < kLanes ? count - first : kLanes;
    Padded padded;
    const RayBatch packet_rays = packet_of(rays, static_cast<std::size_t>(first), lanes, padded);
    Packet<any_hit> packet(tree, packet_rays, (1u << lanes) - 1u, waiting, first);
    packet.run();
    packet.limits().store(hits.t + first);
    packet.u().store(hits.u + first);
    packet.v().store(hits.v + first);
    if constexpr (any_hit) {
      const WideMask done = WideMask::of(packet.done());
      select(done, WideUInt(0u), WideUInt(kNoPrimitive)).store(hits.primitive_slot + first);
    } else {
      packet.slots().store(hits.primitive_slot + first);
    }
    for (std::uint32_t left = packet.left_out(); left != 0; left &= left - 1)
      hits.primitive_slot[first + __builtin_ctz(left)] = kLeftOut;
  }
  // Gathered first, since whether a ray is done is a coin toss to the processor.
  std::uint8_t alone[kGroup];
  static_assert(kGroup <= 256);
  int alone_count = 0;
  for (int i = 0; i < count; ++i) {
    alone[alone_count] = static_cast<std::uint8_t>(i);
    const bool is_done = any_hit && hits.primitive_slot[i] != kNoPrimitive;
    alone_count += static_cast<int>(waiting.count[i] != 0) & static_cast<int>(!is_done);
  }
  const auto start = [&](int i, unsigned char* room, ShallowStack& stack, DeepStack& deep) {
    const bool has_hit = !any_hit && hits.primitive_slot[i] != kNoPrimitive;
    const TraversalHit best{has_hit ? hits.t[i] : -1.0f, hits.u[i], hits.v[i], hits.primitive_slot[i]};
    new (room) InterleavedRay<any_hit>(tree, ray_at(rays, static_cast<std::size_t>(i), hits.t[i]), best, waiting, i,
                                       stack, deep);
  };
  const auto end = [&](int i, const TraversalHit& hit) {
    hits.t[i] = hit.t;
    hits.u[i] = hit.u;
    hits.v[i] = hit.v;
    hits.primitive_slot[i] = hit.primitive_slot;
  };
  InterleavedTraversal<any_hit, decltype(start), decltype(end)>(tree, alone, alone_count, start, end).run();
}

constexpr Kernel make_kernel(const char* isa) {
  return {isa,
          {intersect<Intersector::book>, intersect<Intersector::fast>, intersect<Intersector::watertight>},
          {occluded<Intersector::book>, occluded<Intersector::fast>, occluded<Intersector::watertight>},
          trace_group<false>,
          trace_group<true>};
}

}  // namespace
}  // namespace raylab::bvh
