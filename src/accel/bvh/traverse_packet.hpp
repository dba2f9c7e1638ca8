#pragma once
// Several rays at once, one in each lane of a vector: a node's box, or a triangle, is loaded and prepared once for
// all of them. Included after simd_*.hpp, and as local to the including file.
#include <type_traits>

#include "packet_tests.hpp"
#include "traverse.hpp"

namespace raylab::bvh {
namespace {

/// Where no more rays of a packet than this go into a subtree, they go alone: a vector with few lanes in use
/// costs as much as a full one (Benthin, Wald, Woop, Ernst and Mark 2012, "Combining Single and Packet-Ray
/// Tracing").
constexpr int kFewRays = kLanes / 2;

/// What the two packet traversals share.
template <class NodeVector>
class Packet {
 public:
  static constexpr int width = NodeVector::lanes;
  static constexpr Intersector kind = Intersector::watertight;

  Packet(const TreeView& tree, const PacketRays& rays)
      : tree_(tree),
        rays_(rays),
        origin_(WideVec3::load(rays.origin[0], rays.origin[1], rays.origin[2])),
        direction_(WideVec3::load(rays.direction[0], rays.direction[1], rays.direction[2])),
        t_min_(Wide::load(rays.t_min)),
        box_test_(origin_, direction_),
        triangle_test_(origin_, direction_) {
    const Wide t_max = Wide::load(rays.t_max);
    best_t_ = select(t_max < Wide(kInfinity), next_down_positive(t_max), Wide(0x1.fffffep127f));
    const WideVec3 size = abs(direction_);
    const Wide largest = greater(size.x, greater(size.y, size.z));
    const WideMask in_range = (largest <= Wide(kDirectionRange)) & (largest * Wide(kDirectionRange) >= Wide(1.0f));
    left_out_ = WideMask::of(rays.lanes) & !in_range;
    lanes_ = WideMask::of(rays.lanes) & in_range & (t_min_ < t_max);
  }

  std::uint32_t intersect(PacketHits& hits) {
    traverse<false>();
    best_t_.store(hits.t);
    best_u_.store(hits.u);
    best_v_.store(hits.v);
    for (int i = 0; i < kLanes; ++i) hits.place[i] = places_[i];
    hits.turns = turns_;
    return left_out_.bits();
  }

  std::uint32_t occluded(PacketHits& hits) {
    traverse<true>();
    for (int i = 0; i < kLanes; ++i) hits.place[i] = (done_.bits() >> i & 1u) != 0 ? 0 : kNoPrimitive;
    hits.turns = turns_;
    return left_out_.bits();
  }

 private:
  template <bool any_hit>
  void traverse() {
    for (std::uint32_t& place : places_) place = kNoPrimitive;
    refs_[0] = tree_.root;
    masks_[0] = lanes_;
    nears_[0] = t_min_;
    int top = 0;
    while (top >= 0) {
      const Ref ref = refs_[top];
      WideMask active = masks_[top];
      if constexpr (any_hit) {
        active = active & !done_;
      } else {
        active = active & (nears_[top] <= best_t_);
      }
      --top;
      const std::uint32_t bits = active.bits();
      if (bits == 0) continue;
      if (ref_kind(ref) != RefKind::sphere && __builtin_popcount(bits) <= kFewRays) {
        in_turns<any_hit>(ref, bits);
      } else if (ref_kind(ref) == RefKind::node) {
        top = push_children(at<Node<width>>(tree_, ref), active, top);
      } else if (ref_kind(ref) == RefKind::triangles) {
        hit_block<any_hit>(at<SharedBlock>(tree_, ref), active);
      } else if (ref_kind(ref) == RefKind::separate) {
        hit_block<any_hit>(at<SeparateBlock>(tree_, ref), active);
      } else if (ref_kind(ref) == RefKind::sphere) {
        hit_spheres<any_hit>(ref_index(ref), active);
      }
    }
  }

  /// The children that some ray may hit, the nearest for the first ray on top.
  int push_children(const Node<width>& node, WideMask active, int top) {
    const std::uint32_t order = node.order[box_test_.octant(__builtin_ctz(active.bits()))][0];
    for (int i = width - 1; i >= 0; --i) {
      const int child = static_cast<int>(order >> (4 * i) & 15u);
      const Ref ref = node.child[child];
      if (ref_kind(ref) == RefKind::end) continue;
      Wide near;
      const WideMask hit = active & box_test_(node, child, t_min_, best_t_, near);
      if (!any(hit)) continue;
      ++top;
      refs_[top] = ref;
      masks_[top] = hit;
      nears_[top] = near;
    }
    return top;
  }

  template <bool any_hit, class Block>
  void hit_block(const Block& block, WideMask active) {
    constexpr bool shared = std::is_same_v<Block, SharedBlock>;
    PacketTriangleTest::Vertex vertices[shared ? kBlockSize : 3];
    const auto transform = [&](int i, int position) {
      vertices[i] = triangle_test_.transform(block.position[0][position], block.position[1][position],
                                             block.position[2][position]);
    };
    const int count = __builtin_popcount(block.lanes);
    int transformed = 0;
    for (int lane = 0; lane < count; ++lane) {
      int a = 0, b = 1, c = 2;
      if constexpr (shared) {
        a = corner_of(block, 0, lane);
        b = corner_of(block, 1, lane);
        c = corner_of(block, 2, lane);
        // Vertices are numbered in the order in which the triangles name them.
        for (const int last = largest_of(a, b, c); transformed <= last; ++transformed)
          transform(transformed, transformed);
      } else {
        for (int k = 0; k < 3; ++k) transform(k, corner_of(block, k, lane));
      }
      PacketTriangleTest::Found found;
      if (!triangle_test_.find<any_hit>(active, vertices[a], vertices[b], vertices[c], t_min_, best_t_, found))
        continue;
      if (any(found.unsure)) {
        best_t_.store(limits_);
        for (std::uint32_t left = found.unsure.bits(); left != 0; left &= left - 1) {
          const int i = __builtin_ctz(left);
          KernelHit hit;
          if (hit_triangle_again(block, lane, ray(i), limits_[i], hit)) take(i, hit);
        }
        best_t_ = Wide::load(limits_);
      }
      if (any(found.imprecise)) {
        double normal[3];
        block_normal(block, lane, normal);
        found.t = select(found.imprecise, triangle_test_.plane_distance(block, lane, normal, found.t), found.t);
        found.hit = found.hit | (found.imprecise & (t_min_ < found.t) & (found.t <= best_t_));
      }
      accept<any_hit>(found.hit, found.t, found.beta, found.gamma, block.first + static_cast<std::uint32_t>(lane));
      if constexpr (any_hit) {
        active = active & !done_;
        if (!any(active)) return;
      }
    }
  }

  template <bool any_hit>
  void hit_spheres(std::uint32_t place, WideMask active) {
    float sphere[4];
    sphere_at(tree_.context, place, sphere);
    active = active & may_hit_sphere(origin_, direction_, sphere);
    if (!any(active)) return;
    Wide t;
    const WideMask hit = active & sphere_distance(origin_, direction_, sphere, t_min_, best_t_, t);
    accept<any_hit>(hit, t, Wide(0.0f), Wide(0.0f), place);
  }

  /// A subtree for the few rays that go there.
  template <bool any_hit>
  void in_turns(Ref ref, std::uint32_t lanes) {
    static_assert(kFewRays <= kTurns);
    int lane_of[kFewRays];
    int count = 0;
    for (; lanes != 0; lanes &= lanes - 1) lane_of[count++] = __builtin_ctz(lanes);
    best_t_.store(limits_);
    turns_ += answer_in_turns<NodeVector, any_hit>(
        {tree_.lines, ref, tree_.ids, tree_.context}, count, [&](int i) { return ray(lane_of[i]); },
        [&](int i, const KernelHit& hit) { take(lane_of[i], hit); });
    best_t_ = Wide::load(limits_);
  }

  /// Makes the hits of some lanes, none of them farther than the best one, the best. Of equally near ones the
  /// smallest id wins.
  template <bool any_hit>
  void accept(WideMask lanes, Wide t, Wide u, Wide v, std::uint32_t place) {
    // After the scalar tests some may be farther than they were.
    lanes = lanes & (t <= best_t_);
    if constexpr (any_hit) {
      done_ = done_ | lanes;
      return;
    }
    const WideMask equal = lanes & (t == best_t_) & done_;
    for (std::uint32_t left = equal.bits(); left != 0; left &= left - 1) {
      const int i = __builtin_ctz(left);
      if (!id_precedes(tree_.context, place, places_[i])) lanes = lanes & !WideMask::of(1u << i);
    }
    if (any(lanes)) __builtin_prefetch(tree_.ids + place);
    best_t_ = select(lanes, t, best_t_);
    best_u_ = select(lanes, u, best_u_);
    best_v_ = select(lanes, v, best_v_);
    done_ = done_ | lanes;
    for (std::uint32_t left = lanes.bits(); left != 0; left &= left - 1) places_[__builtin_ctz(left)] = place;
  }

  /// The same for one lane; the caller keeps best_t_ in limits_ meanwhile.
  void take(int i, const KernelHit& hit) {
    const WideMask lane = WideMask::of(1u << i);
    if (hit.t == limits_[i] && any(done_ & lane) && !id_precedes(tree_.context, hit.place, places_[i])) return;
    limits_[i] = hit.t;
    best_u_ = select(lane, Wide(hit.u), best_u_);
    best_v_ = select(lane, Wide(hit.v), best_v_);
    done_ = done_ | lane;
    places_[i] = hit.place;
  }

  KernelRay ray(int i) const {
    return {{rays_.origin[0][i], rays_.origin[1][i], rays_.origin[2][i]},
            {rays_.direction[0][i], rays_.direction[1][i], rays_.direction[2][i]},
            rays_.t_min[i],
            limits_[i]};
  }

  static int largest_of(int a, int b, int c) {
    const int ab = a > b ? a : b;
    return ab > c ? ab : c;
  }

  const TreeView& tree_;
  const PacketRays& rays_;
  WideVec3 origin_, direction_;
  Wide t_min_;
  PacketBoxTest box_test_;
  PacketTriangleTest triangle_test_;
  WideMask lanes_, left_out_;
  WideMask done_{};  ///< lanes that have hit something
  Wide best_t_, best_u_{}, best_v_{};
  alignas(64) float limits_[kLanes];
  std::uint32_t places_[kLanes];
  int turns_ = 0;
  Ref refs_[stack_size(width)];
  WideMask masks_[stack_size(width)];
  Wide nears_[stack_size(width)];
};

template <class NodeVector>
std::uint32_t intersect_packet(const TreeView& tree, const PacketRays& rays, PacketHits& hits) noexcept {
  return Packet<NodeVector>(tree, rays).intersect(hits);
}
template <class NodeVector>
std::uint32_t occluded_packet(const TreeView& tree, const PacketRays& rays, PacketHits& hits) noexcept {
  return Packet<NodeVector>(tree, rays).occluded(hits);
}

template <class NodeVector, bool any_hit>
void trace_rays(const TreeView& tree, const KernelRay* rays, int count, KernelHit* hits) noexcept {
  for (int i = 0; i < count; ++i) hits[i] = {0.0f, 0.0f, 0.0f, kNoPrimitive};
  answer_in_turns<NodeVector, any_hit>(
      tree, count, [&](int i) { return rays[i]; }, [&](int i, const KernelHit& hit) { hits[i] = hit; });
}

template <class NodeVector>
constexpr Kernel make_kernel(const char* isa) {
  return {isa,
          NodeVector::lanes,
          {intersect<NodeVector, Intersector::book>, intersect<NodeVector, Intersector::fast>,
           intersect<NodeVector, Intersector::watertight>},
          {occluded<NodeVector, Intersector::book>, occluded<NodeVector, Intersector::fast>,
           occluded<NodeVector, Intersector::watertight>},
          kLanes,
          intersect_packet<NodeVector>,
          occluded_packet<NodeVector>,
          trace_rays<NodeVector, false>,
          trace_rays<NodeVector, true>};
}

}  // namespace
}  // namespace raylab::bvh
