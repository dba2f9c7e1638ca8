#pragma once
// A packet of rays, one in each lane of a vector: a node's box, or a triangle, is loaded and prepared once for all of
// them.
#include <type_traits>

#include "beam.hpp"
#include "interleaved.hpp"
#include "packet_tests.hpp"

namespace raylab::bvh {
namespace {

/// A subtree or block that at most this many rays of a packet enter is left for these rays to visit alone: a vector
/// with few lanes in use costs as much as a full one (Benthin, Wald, Woop, Ernst and Mark 2012, "Combining Single and
/// Packet-Ray Tracing"). The numbers were measured on the primary and diffuse rays of cornell, the bunny and the
/// dragon. Nodes are left early, since rays that have parted do not meet again.
constexpr int kFewAtNode = kLanes * 7 / 8;
constexpr int kFewAtBlock = kLanes / 2;
/// The same at nodes of trees that hold spheres only, whose leaves a single ray tests one by one; measured on one-
/// weekend.
constexpr int kFewAmongSpheres = kLanes / 8;
/// The same at blocks, and at nodes at least as large as the rays are apart, so that these mostly stay together, if the
/// rays are a beam: what none of them meets costs little. Measured on the primary rays of those three, the globe and
/// mirror-room.
constexpr int kFewOfBeam = 2;

/// A packet goes through the tree as long as its rays stay together.
template <bool any_hit>
class Packet {
 public:
  /// Rays of the lanes whose bits are set. What is left for them to visit alone is added to `waiting`, where the ray of
  /// lane 0 is `first`.
  Packet(const TreeView& tree, const RayBatch& rays, std::uint32_t lanes, Waiting& waiting, int first)
      : tree_(tree),
        rays_(rays),
        waiting_(waiting),
        first_(first),
        origin_(load3(rays.origin[0], rays.origin[1], rays.origin[2])),
        direction_(load3(rays.direction[0], rays.direction[1], rays.direction[2])),
        length2_(dot(direction_, direction_)),
        t_min_(Wide::load(rays.t_min)),
        box_test_(origin_, direction_) {
    if (tree.has_blocks) sheared_ = ShearedRay<Wide>(direction_);
    const Wide t_max = Wide::load(rays.t_max);
    best_t_ = select(t_max < Wide(kInfinity), next_down_positive(t_max), Wide(0x1.fffffep127f));
    const Wide largest = max_component(abs(direction_));
    const WideMask in_range = (largest <= Wide(kDirectionRange)) & (largest * Wide(kDirectionRange) >= Wide(1.0f));
    left_out_ = WideMask::of(lanes) & !in_range;
    lanes_ = WideMask::of(lanes) & in_range & (t_min_ < t_max);
    if (!kTracesBeams || !tree.has_levels) return;
    beam_ = Beam(origin_, direction_, kBlocksByBeam && tree.has_blocks ? &sheared_ : nullptr, lanes_);
    if (beam_.is_usable()) beam_t_ = {Bounds(t_min_, lanes_).lower, Bounds(best_t_, lanes_).upper};
  }

  void run() {
    refs_[0] = tree_.root;
    few_[0] = kFewOfBeam;
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
      if (__builtin_popcount(bits) <= few_at(ref_kind(ref), top + 1) && can_wait(bits)) {
        nears_[top + 1].store(limits_);
        for (std::uint32_t left = bits; left != 0; left &= left - 1) {
          const int i = __builtin_ctz(left);
          waiting_.add(first_ + i, ref, limits_[i]);
        }
      } else if (ref_kind(ref) == RefKind::node) {
        top = push_children(at<Node>(tree_, ref), active, top);
      } else if (ref_kind(ref) == RefKind::triangles) {
        hit_block(at<SharedBlock>(tree_, ref), active);
      } else if (ref_kind(ref) == RefKind::separate) {
        hit_block(at<SeparateBlock>(tree_, ref), active);
      } else if (ref_kind(ref) == RefKind::sphere) {
        hit_spheres(ref_index(ref), active);
      }
    }
  }

  /// Lanes whose directions are too long or too short, so that they were left out.
  std::uint32_t left_out() const { return left_out_.bits(); }
  /// Lanes with a hit; the others have slot kNoPrimitive.
  std::uint32_t done() const { return done_.bits(); }
  /// Largest t that counts, or the best so far.
  Wide limits() const { return best_t_; }
  Wide u() const { return best_u_; }
  Wide v() const { return best_v_; }
  WideUInt slots() const { return slots_; }

 private:
  /// Of what is at a place of the stack.
  int few_at(RefKind kind, int place) const {
    if (kind == RefKind::sphere) return 0;
    if (tree_.has_blocks && beam_.is_usable()) return kind == RefKind::node ? few_[place] : kFewOfBeam;
    if (kind == RefKind::node) return tree_.has_blocks ? kFewAtNode : kFewAmongSpheres;
    return kFewAtBlock;
  }
  bool can_wait(std::uint32_t lanes) const {
    for (; lanes != 0; lanes &= lanes - 1) {
      if (waiting_.count[first_ + __builtin_ctz(lanes)] == Waiting::kMost) return false;
    }
    return true;
  }

  /// The children that some ray may hit, the nearest for the first ray on top.
  int push_children(const Node& node, WideMask active, int top) {
    if (beam_.is_usable()) {
      const int octant = beam_.octant();
      alignas(32) std::uint32_t children[kWidth];
      const NodeInterval some = beam_(node, beam_t_);
      const int count = children_in_order(some, node.order[octant], children);
      const std::uint32_t large = beam_.larger_than_beam(node, some.near).bits();
      for (int i = 0; i < count; ++i) {
        few_[top + 1] = (large >> children[i] & 1u) != 0 ? kFewOfBeam : kFewAtNode;
        const int child = static_cast<int>(children[i]);
        top = push(node, child, active, box_test_.in_octant(octant, node, child, t_min_, best_t_), top);
      }
      return top;
    }
    const std::uint32_t order = node.order[box_test_.octant(__builtin_ctz(active.bits()))];
    const auto child = [&](int i) { return static_cast<int>(order >> (4 * i) & 15u); };
    int i = kWidth - 1;
    while (ref_kind(node.child[child(i)]) == RefKind::end) --i;  // unused lanes are last
    for (; i >= 0; --i) top = push(node, child(i), active, box_test_(node, child(i), t_min_, best_t_), top);
    return top;
  }

  /// Puts a child where the next goes, and returns the new top, which is one more if some ray hits it.
  [[gnu::always_inline]] int push(const Node& node, int child, WideMask active, const SlabInterval<Wide>& interval,
                                  int top) {
    const WideMask hit = active & (interval.near <= interval.far);
    nears_[top + 1] = interval.near;
    refs_[top + 1] = node.child[child];
    masks_[top + 1] = hit;
    return top + (any(hit) ? 1 : 0);  // without a branch: whether a box is hit is a coin toss to the processor
  }

  /// Tests the edges of all triangles, then computes distances. A ray passes few triangles of a block, and a triangle
  /// is passed by few rays, so distances triangle by triangle would often use one or two lanes. Therefore each lane
  /// first collects up to two triangles of its own.
  template <class Block>
  void hit_block(const Block& block, WideMask active) {
    constexpr bool shared = std::is_same_v<Block, SharedBlock>;
    const bool by_beam = beam_.has_axes();
    const std::uint32_t lanes = by_beam ? beam_.may_pass(block) : block.lanes;
    WideVec3 vertices[shared ? kBlockSize : 3];
    const auto transform = [&](int i, int position) {
      const auto from_origin = [&](int axis) { return Wide(block.position[axis][position]) - (&origin_.x)[axis]; };
      if (by_beam) {
        vertices[i] = sheared(from_origin(beam_.axis(0)), from_origin(beam_.axis(1)), from_origin(beam_.axis(2)),
                              sheared_.shear_x, sheared_.shear_y);
      } else {
        vertices[i] = to_ray_space(sheared_, WideVec3(from_origin(0), from_origin(1), from_origin(2)));
      }
    };
    if constexpr (shared) {
      std::uint32_t used = by_beam ? 0u : (1u << block.vertices) - 1u;
      for (std::uint32_t left = by_beam ? lanes : 0u; left != 0; left &= left - 1) {
        const int lane = __builtin_ctz(left);
        for (int k = 0; k < 3; ++k) used |= 1u << corner_of(block, k, lane);
      }
      for (; used != 0; used &= used - 1) transform(__builtin_ctz(used), __builtin_ctz(used));
    }
    // Without branches: whether some ray passes a triangle is a coin toss to the processor.
    WideMask passed[kBlockSize];
    std::uint32_t passed_lane[kBlockSize];
    int passed_count = 0;
    for (std::uint32_t left = lanes; left != 0; left &= left - 1) {
      const int lane = __builtin_ctz(left);
      int a = 0, b = 1, c = 2;
      if constexpr (shared) {
        a = corner_of(block, 0, lane);
        b = corner_of(block, 1, lane);
        c = corner_of(block, 2, lane);
      } else {
        for (int k = 0; k < 3; ++k) transform(k, corner_of(block, k, lane));
      }
      const WideMask inside = active & !differ_in_sign(edges_of(vertices[a], vertices[b], vertices[c]));
      passed[passed_count] = inside;
      passed_lane[passed_count] = static_cast<std::uint32_t>(lane);
      passed_count += any(inside) ? 1 : 0;
    }
    WideUInt first(0u), second(0u);
    WideMask has_first = WideMask::of(0), has_second = WideMask::of(0);
    for (int i = 0; i < passed_count; ++i) {
      const WideMask inside = passed[i];
      if (any(inside & has_second)) [[unlikely]] {
        hit_triangles(block, has_first, first);
        hit_triangles(block, has_second, second);
        has_first = has_second = WideMask::of(0);
      }
      const WideUInt triangle(passed_lane[i]);
      const WideMask to_second = inside & has_first;
      first = select(has_first, first, triangle);
      second = select(to_second, triangle, second);
      has_first = has_first | inside;
      has_second = has_second | to_second;
    }
    if (any(has_first)) hit_triangles(block, has_first, first);
    if (any(has_second)) hit_triangles(block, has_second, second);
  }

  /// A triangle of the block for each of the lanes, inside whose edges its ray passes.
  template <class Block>
  void hit_triangles(const Block& block, WideMask lanes, WideUInt triangle) {
    if constexpr (any_hit) lanes = lanes & !done_;
    const WideVec3 p0 = corner_at(block, 0, triangle), p1 = corner_at(block, 1, triangle),
                   p2 = corner_at(block, 2, triangle);
    const WideVec3 a = to_ray_space(sheared_, p0 - origin_), b = to_ray_space(sheared_, p1 - origin_),
                   c = to_ray_space(sheared_, p2 - origin_);
    const Wide xy_size = max(max(abs(a.x), abs(a.y)), max(max(abs(b.x), abs(b.y)), max(abs(c.x), abs(c.y))));
    WatertightHit<Wide> found = watertight_hit<Wide>(edges_of(a, b, c), a.z, b.z, c.z, xy_size, sheared_.direction_z);
    const WideMask sure = lanes & found.sure;
    const WideMask decided = found.precise | side_is_certain<any_hit>(found, t_min_, best_t_);
    WideMask hit = sure & decided & (t_min_ < found.t) & (found.t <= best_t_);
    if (const WideMask unsure = lanes & !found.sure; any(unsure)) {
      best_t_.store(limits_);
      for (std::uint32_t left = unsure.bits(); left != 0; left &= left - 1) {
        const int i = __builtin_ctz(left);
        TraversalHit again;
        if (hit_in_double(block, static_cast<int>(triangle.v[i]), ray(i), limits_[i], again)) take(i, again);
      }
      best_t_ = Wide::load(limits_);
    }
    if (const WideMask imprecise = sure & !decided; any(imprecise)) {
      found.t = select(imprecise, plane_distance(sheared_.axes, origin_, direction_, p0, p1, p2, found.t), found.t);
      hit = hit | (imprecise & (t_min_ < found.t) & (found.t <= best_t_));
    }
    accept(hit, found.t, found.beta, found.gamma, WideUInt(block.first) + triangle);
  }

  void hit_spheres(std::uint32_t slot, WideMask active) {
    const float* const sphere = sphere_at(tree_, slot);
    active = active & may_hit_sphere(origin_, direction_, length2_, sphere);
    if (!any(active)) return;
    Wide t;
    const auto all = [&](int k) { return WideDouble(static_cast<double>(sphere[k])); };
    const WideMask hit = hit_sphere(active, origin_, direction_, {all(0), all(1), all(2)}, all(3), t_min_, best_t_, t);
    if (!any(hit)) return;
    accept(hit, t, Wide(0.0f), Wide(0.0f), WideUInt(slot));
  }

  /// Replaces the best hits of lanes whose new hit is no farther. At equal distance the smallest id wins.
  void accept(WideMask lanes, Wide t, Wide u, Wide v, WideUInt slot) {
    // After the scalar tests some may be farther than they were.
    lanes = lanes & (t <= best_t_);
    if constexpr (any_hit) {
      done_ = done_ | lanes;
      return;
    }
    const WideMask equal = lanes & (t == best_t_) & done_;
    for (std::uint32_t left = equal.bits(); left != 0; left &= left - 1) {
      const int i = __builtin_ctz(left);
      if (!id_precedes(tree_, slot.v[i], slots_.v[i])) lanes = lanes & !WideMask::of(1u << i);
    }
    best_t_ = select(lanes, t, best_t_);
    best_u_ = select(lanes, u, best_u_);
    best_v_ = select(lanes, v, best_v_);
    slots_ = select(lanes, slot, slots_);
    done_ = done_ | lanes;
    if (beam_.is_usable()) beam_t_.upper = Bounds(best_t_, lanes_).upper;
  }

  /// The same for one lane; the caller keeps best_t_ in limits_ meanwhile.
  void take(int i, const TraversalHit& hit) {
    const WideMask lane = WideMask::of(1u << i);
    if (hit.t == limits_[i] && any(done_ & lane) && !id_precedes(tree_, hit.primitive_slot, slots_.v[i])) return;
    limits_[i] = hit.t;
    best_u_ = select(lane, Wide(hit.u), best_u_);
    best_v_ = select(lane, Wide(hit.v), best_v_);
    done_ = done_ | lane;
    slots_.v[i] = hit.primitive_slot;
  }

  TraversalRay ray(int i) const { return ray_at(rays_, i, limits_[i]); }

  static EdgeFunctions<Wide> edges_of(const WideVec3& a, const WideVec3& b, const WideVec3& c) {
    return edge_functions(a.x, a.y, b.x, b.y, c.x, c.y);
  }

  const TreeView& tree_;
  const RayBatch& rays_;
  Waiting& waiting_;
  const int first_;
  WideVec3 origin_, direction_;
  Wide length2_;  ///< of the direction, squared
  Wide t_min_;
  PacketBoxTest box_test_;
  ShearedRay<Wide> sheared_;
  Beam beam_;
  Bounds beam_t_;  ///< least t_min and greatest best_t_ of all rays
  WideMask lanes_, left_out_;
  WideMask done_{};  ///< lanes that have hit something
  Wide best_t_, best_u_{}, best_v_{};
  alignas(64) float limits_[kLanes];
  WideUInt slots_{kNoPrimitive};
  Ref refs_[kStackSize];
  WideMask masks_[kStackSize];
  std::uint8_t few_[kStackSize];  ///< of nodes that a beam has met: the rays that are too few to go on together
  Wide nears_[kStackSize];
};

}  // namespace
}  // namespace raylab::bvh
