#pragma once
// What a kernel offers, of the three traversals. Included after simd_*.hpp, and as local to the including file.
#include "flight.hpp"
#include "traverse_packet.hpp"

namespace raylab::bvh {
namespace {

struct Padded {
  alignas(64) float values[8][kLanes];
};
/// Rays from `first` on, as whole vectors.
inline RayColumns packet_of(const RayColumns& rays, int first, int count, Padded& padded) {
  RayColumns packet{{rays.origin[0] + first, rays.origin[1] + first, rays.origin[2] + first},
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

/// Answers up to kGroup rays: in packets as long as those of a packet stay together, then alone.
template <class NodeVector, bool any_hit>
void trace_group(const TreeView& tree, const RayColumns& rays, int count, GroupHits& hits) noexcept {
  using OneRay = Flight<NodeVector, any_hit>;
  Waiting waiting;
  for (int first = 0; first < count; first += kLanes) {
    const int lanes = count - first < kLanes ? count - first : kLanes;
    Padded padded;
    const RayColumns packet_rays = packet_of(rays, first, lanes, padded);
    Packet<NodeVector, any_hit> packet(tree, packet_rays, (1u << lanes) - 1u, waiting, first);
    packet.run();
    packet.limits().store(hits.t + first);
    packet.u().store(hits.u + first);
    packet.v().store(hits.v + first);
    if constexpr (any_hit) {
      const WideMask done = WideMask::of(packet.done());
      select(done, WideUInt(0u), WideUInt(kNoPrimitive)).store(hits.place + first);
    } else {
      packet.places().store(hits.place + first);
    }
    for (std::uint32_t left = packet.left_out(); left != 0; left &= left - 1)
      hits.place[first + __builtin_ctz(left)] = kLeftOut;
  }
  // Gathered first, since whether a ray is done is a coin toss to the processor.
  std::uint8_t alone[kGroup];
  static_assert(kGroup <= 256);
  int alone_count = 0;
  for (int i = 0; i < count; ++i) {
    alone[alone_count] = static_cast<std::uint8_t>(i);
    const bool is_done = any_hit && hits.place[i] != kNoPrimitive;
    alone_count += static_cast<int>(waiting.count[i] != 0) & static_cast<int>(!is_done);
  }
  const auto start = [&](int i, unsigned char* room, FlightStack& stack, typename OneRay::Deep& deep) {
    const bool has_hit = !any_hit && hits.place[i] != kNoPrimitive;
    const KernelHit best{has_hit ? hits.t[i] : -1.0f, hits.u[i], hits.v[i], hits.place[i]};
    new (room) OneRay(tree, ray_at(rays, static_cast<std::size_t>(i), hits.t[i]), best, waiting, i, stack,
                     deep);
  };
  const auto end = [&](int i, const KernelHit& hit) {
    hits.t[i] = hit.t;
    hits.u[i] = hit.u;
    hits.v[i] = hit.v;
    hits.place[i] = hit.place;
  };
  Fleet<NodeVector, any_hit, decltype(start), decltype(end)>(tree, alone, alone_count, start, end).run();
}

template <class NodeVector>
constexpr Kernel make_kernel(const char* isa) {
  return {isa,
          NodeVector::lanes,
          {intersect<NodeVector, Intersector::book>, intersect<NodeVector, Intersector::fast>,
           intersect<NodeVector, Intersector::watertight>},
          {occluded<NodeVector, Intersector::book>, occluded<NodeVector, Intersector::fast>,
           occluded<NodeVector, Intersector::watertight>},
          trace_group<NodeVector, false>,
          trace_group<NodeVector, true>};
}

}  // namespace
}  // namespace raylab::bvh
