#pragma once
// Several rays at once, one in each lane of a vector: a node's box, or a triangle, is loaded and prepared once for all
// of them. Included after traverse.hpp, and as local to the including file.
// Lane by lane the operations on triangles are those of BlockTest, so the hits are the same bit for bit.
#include <new>
#include <type_traits>

#include "raylab/core/wide.hpp"
#include "traverse.hpp"

namespace raylab::bvh {
namespace {

/// Where no more rays of a packet than this go into a subtree, they go alone: a vector with few lanes in use
/// costs as much as a full one (Benthin, Wald, Woop, Ernst and Mark 2012, "Combining Single and Packet-Ray Tracing").
constexpr int kFewRays = kLanes / 2;

/// kx, ky, kz of BlockTest for each lane, without its swap for directions down the z axis: that turns all three edge
/// functions around, which changes no answer.
class PacketTriangleTest {
 public:
  PacketTriangleTest(const WideVec3& origin, const WideVec3& direction) : origin_(origin), direction_(direction) {
    const WideVec3 size = abs(direction);
    const WideMask x_over_y = size.x > size.y;
    z_is_x_ = x_over_y & (size.x > size.z);
    z_is_y_ = (!x_over_y) & (size.y > size.z);
    Wide x, y;
    permute(direction, x, y, direction_z_);
    shear_x_ = x / direction_z_;
    shear_y_ = y / direction_z_;
  }

  struct Vertex {
    Wide x, y, z;
  };
  Vertex transform(float px, float py, float pz) const {
    Vertex v;
    permute({Wide(px) - origin_.x, Wide(py) - origin_.y, Wide(pz) - origin_.z}, v.x, v.y, v.z);
    v.x = v.x - shear_x_ * v.z;
    v.y = v.y - shear_y_ * v.z;
    return v;
  }

  struct Found {
    WideMask hit;     ///< certainly, at t, with t_min < t <= limit
    WideMask near_zero;  ///< with a t too close to 0 for floats: see plane_distance()
    WideMask unsure;     ///< only the scalar test can tell
    Wide t, beta, gamma;
  };
  /// False where no lane has a hit.
  bool operator()(WideMask lanes, const Vertex& a, const Vertex& b, const Vertex& c, Wide t_min, Wide limit,
                  Found& found) const {
    const Wide zero(0.0f);
    const Wide u = c.x * b.y - c.y * b.x;
    const Wide v = a.x * c.y - a.y * c.x;
    const Wide w = b.x * a.y - b.y * a.x;
    const Wide smallest = lesser(w, lesser(v, u));
    const Wide largest = greater(w, greater(v, u));
    const WideMask inside = lanes & !((smallest < zero) & (zero < largest));
    if (!any(inside)) return false;
    const Wide det = u + v + w;
    const Wide inv_det = Wide(1.0f) / det;
    found.beta = v * inv_det;
    found.gamma = w * inv_det;
    const Wide z = a.z + found.beta * (b.z - a.z) + found.gamma * (c.z - a.z);
    found.t = z / direction_z_;
    const Wide size = magnitude(det);
    const Wide xy_size = greater(largest_xy(a), greater(largest_xy(b), largest_xy(c)));
    const Wide z_size = greater(magnitude(a.z), greater(magnitude(b.z), magnitude(c.z)));
    const WideMask off_zero = Wide(kZError) * z_size * xy_size * xy_size < magnitude(z) * size;
    const WideMask sure =
        inside & (Wide(0x1p-100f) < size) & (size < Wide(0x1p120f)) & (smallest != zero) & (largest != zero);
    found.unsure = inside & !sure;
    found.near_zero = sure & !off_zero;
    found.hit = sure & off_zero & (t_min < found.t) & (found.t <= limit);
    return any(found.hit | found.near_zero | found.unsure);
  }

  /// watertight_plane_distance() for all lanes, of a triangle of the block with this normal.
  Wide plane_distance(const TriangleBlock& block, int lane, const double (&n)[3], Wide otherwise) const {
    const auto corner = [&](int k) {
      const int vertex = block.corner[k][lane];
      return WideVec3(Wide(block.position[0][vertex]), Wide(block.position[1][vertex]), Wide(block.position[2][vertex]));
    };
    const WideVec3 p0 = corner(0);
    const WideDouble facing = WideDouble(direction_.x) * n[0] + WideDouble(direction_.y) * n[1] +
                              WideDouble(direction_.z) * n[2];
    const WideDouble distance = (WideDouble(p0.x) - WideDouble(origin_.x)) * n[0] +
                                (WideDouble(p0.y) - WideDouble(origin_.y)) * n[1] +
                                (WideDouble(p0.z) - WideDouble(origin_.z)) * n[2];
    const WideDouble z(direction_z_);
    const WideDouble origin_z(z_of(origin_));
    const auto at_corner = [&](const WideVec3& p) { return (WideDouble(z_of(p)) - origin_z) / z; };
    const WideDouble t0 = at_corner(p0), t1 = at_corner(corner(1)), t2 = at_corner(corner(2));
    const WideDouble t = at_most(at_least(distance / facing, at_most(at_most(t0, t1), t2)), at_least(at_least(t0, t1), t2));
    return select(facing.to_sign() == Wide(0.0f), otherwise, t.to_float());
  }

 private:
  static Wide largest_xy(const Vertex& v) { return greater(magnitude(v.x), magnitude(v.y)); }
  Wide z_of(const WideVec3& v) const { return select(z_is_x_, v.x, select(z_is_y_, v.y, v.z)); }
  void permute(const WideVec3& v, Wide& x, Wide& y, Wide& z) const {
    x = select(z_is_x_, v.y, select(z_is_y_, v.z, v.x));
    y = select(z_is_x_, v.z, select(z_is_y_, v.x, v.y));
    z = z_of(v);
  }

  WideVec3 origin_, direction_;
  WideMask z_is_x_, z_is_y_;
  Wide direction_z_, shear_x_, shear_y_;
};

/// BoxTest with the lanes for rays instead of children.
class PacketBoxTest {
 public:
  explicit PacketBoxTest(const WideVec3& origin, const WideVec3& direction) : origin_(origin) {
    const WideVec3 reciprocal(Wide(1.0f) / direction.x, Wide(1.0f) / direction.y, Wide(1.0f) / direction.z);
    to_near_ = reciprocal * Wide(kShrink);
    to_far_ = reciprocal * Wide(kGrow);
    // By the sign bit of the reciprocal, -0 being downwards.
    down_x_ = reciprocal.x < Wide(0.0f);
    down_y_ = reciprocal.y < Wide(0.0f);
    down_z_ = reciprocal.z < Wide(0.0f);
  }

  int octant(int lane) const {
    return static_cast<int>((down_x_.bits() >> lane & 1u) | (down_y_.bits() >> lane & 1u) << 1 |
                            (down_z_.bits() >> lane & 1u) << 2);
  }

  template <int width>
  WideMask operator()(const Node<width>& node, int child, Wide t_min, Wide limit, Wide& near) const {
    const Wide lower_x(node.planes[0][child]), upper_x(node.planes[1][child]);
    const Wide lower_y(node.planes[2][child]), upper_y(node.planes[3][child]);
    const Wide lower_z(node.planes[4][child]), upper_z(node.planes[5][child]);
    const Wide x = (select(down_x_, upper_x, lower_x) - origin_.x) * to_near_.x;
    const Wide y = (select(down_y_, upper_y, lower_y) - origin_.y) * to_near_.y;
    const Wide z = (select(down_z_, upper_z, lower_z) - origin_.z) * to_near_.z;
    const Wide far_x = (select(down_x_, lower_x, upper_x) - origin_.x) * to_far_.x;
    const Wide far_y = (select(down_y_, lower_y, upper_y) - origin_.y) * to_far_.y;
    const Wide far_z = (select(down_z_, lower_z, upper_z) - origin_.z) * to_far_.z;
    near = greater(greater(x, y), greater(z, t_min));
    return near <= lesser(lesser(far_x, far_y), lesser(far_z, limit));
  }

 private:
  WideVec3 origin_, to_near_, to_far_;
  WideMask down_x_, down_y_, down_z_;
};

/// The lanes whose rays may hit a sphere: conservative, since the line's distance from the centre, squared, errs by a
/// few roundings of the centre's distance, squared. NaN and overflow count as perhaps.
inline WideMask may_hit_sphere(const WideVec3& origin, const WideVec3& direction, const float (&sphere)[4]) {
  const WideVec3 oc = origin - WideVec3(Wide(sphere[0]), Wide(sphere[1]), Wide(sphere[2]));
  const Wide radius2(sphere[3] * sphere[3]);
  const Wide a = dot(direction, direction);
  const Wide distance2 = dot(oc, oc);
  const WideVec3 moment = cross(oc, direction);
  const WideMask passes = dot(moment, moment) > a * (radius2 * Wide(1.0f + 0x1p-18f) + Wide(0x1p-18f) * distance2);
  // Outside, and leaving.
  const WideMask leaves = (distance2 > radius2 * Wide(1.0f + 0x1p-16f)) & (dot(oc, direction) > Wide(0.0f)) &
                          (Wide(0x1p-100f) < dot(oc, direction));
  return !(passes | leaves);
}

/// intersect_sphere() operation by operation: the nearest t with t_min < t <= limit, in the lanes it gives.
inline WideMask sphere_distance(const WideVec3& origin, const WideVec3& direction, const float (&sphere)[4], Wide t_min,
                                Wide limit, Wide& t) {
  const WideDouble dx(direction.x), dy(direction.y), dz(direction.z);
  const WideDouble ox = WideDouble(origin.x) - sphere[0];
  const WideDouble oy = WideDouble(origin.y) - sphere[1];
  const WideDouble oz = WideDouble(origin.z) - sphere[2];
  const double radius = sphere[3];
  const WideDouble a = dx * dx + dy * dy + dz * dz;
  const WideDouble b = -(ox * dx + oy * dy + oz * dz);
  const WideDouble mx = oy * dz - dy * oz, my = oz * dx - dz * ox, mz = ox * dy - dx * oy;
  const WideDouble discriminant = WideDouble(radius * radius) * a - (mx * mx + my * my + mz * mz);
  const WideDouble q = b + flipped_with(square_root(discriminant), b);
  const Wide t0 = ((ox * ox + oy * oy + oz * oz - radius * radius) / q).to_float();
  const Wide t1 = (q / a).to_float();
  const WideMask meets = discriminant.to_sign() >= Wide(0.0f);
  const Wide nearer = select(t0 < t1, t0, t1);
  const Wide farther = select(t0 < t1, t1, t0);
  const WideMask first = (t_min < nearer) & (nearer <= limit);
  t = select(first, nearer, farther);
  // Where q is 0 both roots are, and are not numbers here: no hit, since t_min is not negative.
  return meets & (first | ((t_min < farther) & (farther <= limit)));
}

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
    const WideMask in_range =
        (largest <= Wide(kDirectionRange)) & (largest * Wide(kDirectionRange) >= Wide(1.0f));
    left_out_ = WideMask::of(rays.lanes) & !in_range;
    lanes_ = WideMask::of(rays.lanes) & in_range & (t_min_ < t_max);
  }

  std::uint32_t intersect(PacketHits& hits) {
    traverse<false>();
    best_t_.store(hits.t);
    best_u_.store(hits.u);
    best_v_.store(hits.v);
    for (int i = 0; i < kLanes; ++i) hits.place[i] = places_[i];
    return left_out_.bits();
  }

  std::uint32_t occluded(std::uint32_t& occluded) {
    traverse<true>();
    occluded = done_.bits();
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
        top = push_children(*static_cast<const Node<width>*>(item_address(tree_, ref)), active, top);
      } else if (ref_kind(ref) == RefKind::triangles) {
        hit_block<any_hit>(*static_cast<const TriangleBlock*>(item_address(tree_, ref)), active);
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

  template <bool any_hit>
  void hit_block(const TriangleBlock& block, WideMask active) {
    PacketTriangleTest::Vertex vertices[kBlockSize];
    const int count = __builtin_popcount(block.lanes);
    int transformed = 0;
    for (int lane = 0; lane < count; ++lane) {
      const int a = block.corner[0][lane], b = block.corner[1][lane], c = block.corner[2][lane];
      // Vertices are numbered in the order in which the triangles name them.
      for (const int last = largest_of(a, b, c); transformed <= last; ++transformed) {
        vertices[transformed] = triangle_test_.transform(block.position[0][transformed], block.position[1][transformed],
                                                         block.position[2][transformed]);
      }
      PacketTriangleTest::Found found;
      if (!triangle_test_(active, vertices[a], vertices[b], vertices[c], t_min_, best_t_, found)) continue;
      if (any(found.unsure)) {
        best_t_.store(limits_);
        for (std::uint32_t left = found.unsure.bits(); left != 0; left &= left - 1) {
          const int i = __builtin_ctz(left);
          KernelHit hit;
          if (hit_triangle_again(block, lane, ray(i), limits_[i], hit)) take(i, hit);
        }
        best_t_ = Wide::load(limits_);
      }
      if (any(found.near_zero)) {
        double normal[3];
        block_normal(block, lane, normal);
        found.t = select(found.near_zero, triangle_test_.plane_distance(block, lane, normal, found.t), found.t);
        found.hit = found.hit | (found.near_zero & (t_min_ < found.t) & (found.t <= best_t_));
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
    using OneRay = Flight<NodeVector, kind, any_hit>;
    static_assert(std::is_trivially_destructible_v<OneRay>);
    alignas(OneRay) unsigned char room[kFewRays][sizeof(OneRay)];
    OneRay* flights[kFewRays];
    int lane_of[kFewRays];
    int flying = 0;
    const TreeView subtree{tree_.items, ref, tree_.context};
    best_t_.store(limits_);
    for (; lanes != 0; lanes &= lanes - 1) {
      lane_of[flying] = __builtin_ctz(lanes);
      flights[flying] = new (room[flying]) OneRay(subtree, ray(lane_of[flying]));
      ++flying;
    }
    while (flying != 0) {
      for (int i = 0; i < flying;) {
        if (flights[i]->step()) {
          ++i;
          continue;
        }
        if (flights[i]->best().place != kNoPrimitive) take(lane_of[i], flights[i]->best());
        --flying;
        flights[i] = flights[flying];
        lane_of[i] = lane_of[flying];
      }
    }
    best_t_ = Wide::load(limits_);
  }

  /// Makes the hits of some lanes, none of them farther than the best one, the best. Of equally near ones the smallest
  /// id wins.
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
  Ref refs_[stack_size(width)];
  WideMask masks_[stack_size(width)];
  Wide nears_[stack_size(width)];
};

template <class NodeVector>
std::uint32_t intersect_packet(const TreeView& tree, const PacketRays& rays, PacketHits& hits) noexcept {
  return Packet<NodeVector>(tree, rays).intersect(hits);
}
template <class NodeVector>
std::uint32_t occluded_packet(const TreeView& tree, const PacketRays& rays, std::uint32_t& occluded) noexcept {
  return Packet<NodeVector>(tree, rays).occluded(occluded);
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
          occluded_packet<NodeVector>};
}

}  // namespace
}  // namespace raylab::bvh
