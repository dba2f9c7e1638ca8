#pragma once
// The traversal, over whatever vectors the including file has chosen (simd_*.hpp). All of it is local to that
// file, and calls no inline function of a shared header: see layout.hpp. No sum of products is contracted and the
// order of operations is the same for all instruction sets, so all give the same hits, bit for bit.
#include "kernel.hpp"

namespace raylab::bvh {
namespace {

constexpr float kGrow = 1.0f + 0x1p-20f;
constexpr float kShrink = 1.0f - 0x1p-20f;
/// Of z where the triangle test no longer trusts its sign: no smaller than in watertight_hit.
constexpr float kZError = 0x1p-19f;
constexpr float kBookSmallestDeterminant = 1e-8f;

inline bool negative(float x) { return __builtin_signbit(x) != 0; }

/// The slab test of a ray against all children of a node. A child is hit unless the ray certainly misses it: the
/// near planes are taken a little nearer and the far planes a little farther than computed (Ize 2013, JCGT 2:2;
/// the factors also cover the rounding of the triangle test). A direction of 0 has an infinite reciprocal; where
/// that gives NaN, the origin is in the plane; then max and min drop that bound, or another of the same side too.
template <class Vector>
class BoxTest {
 public:
  static constexpr int width = Vector::lanes;

  explicit BoxTest(const KernelRay& ray) : t_min_(Vector::splat(ray.t_min)) {
    for (int axis = 0; axis < 3; ++axis) {
      const float reciprocal = 1.0f / ray.direction[axis];
      origin_[axis] = Vector::splat(ray.origin[axis]);
      to_near_[axis] = Vector::splat(reciprocal * kShrink);
      to_far_[axis] = Vector::splat(reciprocal * kGrow);
      const bool down = negative(ray.direction[axis]);
      near_plane_[axis] = 2 * axis + (down ? 1 : 0);
      octant_ |= (down ? 1 : 0) << axis;
    }
  }

  int octant() const { return octant_; }

  void operator()(const Node<width>& node, Vector limit, Vector& near, Vector& far) const {
    const Vector x = plane(node, 0, 0) * to_near_[0];
    const Vector y = plane(node, 1, 0) * to_near_[1];
    const Vector z = plane(node, 2, 0) * to_near_[2];
    const Vector far_x = plane(node, 0, 1) * to_far_[0];
    const Vector far_y = plane(node, 1, 1) * to_far_[1];
    const Vector far_z = plane(node, 2, 1) * to_far_[2];
    near = max(max(x, y), max(z, t_min_));
    far = min(min(far_x, far_y), min(far_z, limit));
  }

 private:
  Vector plane(const Node<width>& node, int axis, int far) const {
    return Vector::load(node.planes[near_plane_[axis] ^ far]) - origin_[axis];
  }

  Vector origin_[3], to_near_[3], to_far_[3];
  Vector t_min_;
  int near_plane_[3];
  int octant_ = 0;
};

/// One ray against the triangles of a block: find() gives the lanes that may be hit, decide() whether one of them
/// is, with t_min < t <= limit. Of the lanes found there is seldom more than one, so where vectors are short
/// (kDividesAllLanes false) the distance is computed for those alone.
template <Intersector kind>
class BlockTest;

/// As intersect_watertight does, operation by operation.
template <>
class BlockTest<Intersector::watertight> {
 public:
  explicit BlockTest(const KernelRay& ray) : ray_(ray) {
    const float x = __builtin_fabsf(ray.direction[0]);
    const float y = __builtin_fabsf(ray.direction[1]);
    const float z = __builtin_fabsf(ray.direction[2]);
    kz_ = x > y ? (x > z ? 0 : 2) : (y > z ? 1 : 2);
    kx_ = kz_ == 2 ? 0 : kz_ + 1;
    ky_ = kx_ == 2 ? 0 : kx_ + 1;
    direction_z_ = ray.direction[kz_];
    if (direction_z_ < 0.0f) {
      const int k = kx_;
      kx_ = ky_;
      ky_ = k;
    }
    shear_x_ = ray.direction[kx_] / direction_z_;
    shear_y_ = ray.direction[ky_] / direction_z_;
    origin_x_ = ray.origin[kx_];
    origin_y_ = ray.origin[ky_];
    origin_z_ = ray.origin[kz_];
  }

  /// The lanes whose edge functions do not differ in sign.
  std::uint32_t find(const TriangleBlock& block, [[maybe_unused]] float limit) {
    const Float16 zero = Float16::splat(0.0f);
    const Float16 z = Float16::load(block.position[kz_]) - Float16::splat(origin_z_);
    const Float16 x =
        Float16::load(block.position[kx_]) - Float16::splat(origin_x_) - Float16::splat(shear_x_) * z;
    const Float16 y =
        Float16::load(block.position[ky_]) - Float16::splat(origin_y_) - Float16::splat(shear_y_) * z;
    const Lookup16 at_a(block.corner[0]), at_b(block.corner[1]), at_c(block.corner[2]);
    const Float16 ax = at_a(x), bx = at_b(x), cx = at_c(x);
    const Float16 ay = at_a(y), by = at_b(y), cy = at_c(y);
    const Float16 u = cx * by - cy * bx;
    const Float16 v = ax * cy - ay * cx;
    const Float16 w = bx * ay - by * ax;
    const Float16 smallest = min(w, min(v, u));
    const Float16 largest = max(w, max(v, u));
    const std::uint32_t found = block.lanes & ~(less(smallest, zero) & less(zero, largest));
    if (found == 0) return 0;
    const Float16 xy = max(abs(x), abs(y));
    if constexpr (!kDividesAllLanes) {
      u.store(u_);
      v.store(v_);
      w.store(w_);
      z.store(z_);
      xy.store(xy_);
      return found;
    }
    const Float16 det = u + v + w;
    const Float16 az = at_a(z), bz = at_b(z), cz = at_c(z);
    const Float16 inv_det = Float16::splat(1.0f) / det;
    const Float16 beta = v * inv_det;
    const Float16 gamma = w * inv_det;
    const Float16 hit_z = az + beta * (bz - az) + gamma * (cz - az);
    const Float16 t = hit_z / Float16::splat(direction_z_);
    const Float16 size = abs(det);
    const Float16 xy_size = max(at_a(xy), max(at_b(xy), at_c(xy)));
    const Float16 z_size = max(abs(az), max(abs(bz), abs(cz)));
    const std::uint32_t sure = less(Float16::splat(0x1p-100f), size) & less(size, Float16::splat(0x1p120f)) &
                               less(Float16::splat(kZError) * z_size * xy_size * xy_size, abs(hit_z) * size);
    unsure_ = found & ~(sure & ~equal(smallest, zero) & ~equal(largest, zero));
    t.store(t_);
    beta.store(v_);
    gamma.store(w_);
    return unsure_ | (found & less(Float16::splat(ray_.t_min), t) & less_equal(t, Float16::splat(limit)));
  }

  bool decide(const TriangleBlock& block, int lane, float limit, KernelHit& hit) const {
    if constexpr (kDividesAllLanes) {
      if ((unsure_ >> lane & 1u) != 0) [[unlikely]]
        return hit_triangle_again(block, lane, ray_, limit, hit);
      hit = {t_[lane], v_[lane], w_[lane], block.first + static_cast<std::uint32_t>(lane)};
      return hit.t <= limit;
    }
    const int a = block.corner[0][lane], b = block.corner[1][lane], c = block.corner[2][lane];
    const float u = u_[lane], v = v_[lane], w = w_[lane];
    const float det = u + v + w;
    const float inv_det = 1.0f / det;
    const float beta = v * inv_det;
    const float gamma = w * inv_det;
    const float z = z_[a] + beta * (z_[b] - z_[a]) + gamma * (z_[c] - z_[a]);
    const float t = z / direction_z_;
    const float size = __builtin_fabsf(det);
    const float xy_size = largest_of(xy_[a], xy_[b], xy_[c]);
    const float z_size = largest_of(__builtin_fabsf(z_[a]), __builtin_fabsf(z_[b]), __builtin_fabsf(z_[c]));
    // False for not a number, too.
    const bool sure = (u != 0.0f) & (v != 0.0f) & (w != 0.0f) & (size > 0x1p-100f) & (size < 0x1p120f) &
                      (__builtin_fabsf(z) * size > kZError * z_size * xy_size * xy_size);
    if (!sure) [[unlikely]]
      return hit_triangle_again(block, lane, ray_, limit, hit);
    hit = {t, beta, gamma, block.first + static_cast<std::uint32_t>(lane)};
    return (t > ray_.t_min) & (t <= limit);
  }

 private:
  static float largest_of(float a, float b, float c) {
    const float ab = a > b ? a : b;
    return ab > c ? ab : c;
  }

  const KernelRay& ray_;
  int kx_, ky_, kz_;
  float origin_x_, origin_y_, origin_z_;
  float shear_x_, shear_y_, direction_z_;
  // Of the last block in which lanes were found. By lane the edge functions, or t, beta and gamma; by vertex z and
  // max(|x|, |y|).
  std::uint32_t unsure_;
  alignas(64) float t_[kBlockSize];
  alignas(64) float u_[kBlockSize];
  alignas(64) float v_[kBlockSize];
  alignas(64) float w_[kBlockSize];
  alignas(64) float z_[kBlockSize];
  alignas(64) float xy_[kBlockSize];
};

/// As intersect_moeller_trumbore does, operation by operation.
template <Intersector kind>
class BlockTest {
 public:
  explicit BlockTest(const KernelRay& ray) : ray_(ray) {}

  std::uint32_t find(const TriangleBlock& block, float limit) {
    constexpr float smallest_determinant = kind == Intersector::book ? kBookSmallestDeterminant : 0.0f;
    const Float16 zero = Float16::splat(0.0f), one = Float16::splat(1.0f);
    const Lookup16 at_a(block.corner[0]), at_b(block.corner[1]), at_c(block.corner[2]);
    Float16 d[3], e1[3], e2[3], s[3];
    for (int axis = 0; axis < 3; ++axis) {
      const Float16 position = Float16::load(block.position[axis]);
      const Float16 a = at_a(position);
      e1[axis] = at_b(position) - a;
      e2[axis] = at_c(position) - a;
      s[axis] = Float16::splat(ray_.origin[axis]) - a;
      d[axis] = Float16::splat(ray_.direction[axis]);
    }
    Float16 p[3], q[3];
    cross(d, e2, p);
    cross(s, e1, q);
    const Float16 det = dot(e1, p);
    const Float16 inv_det = one / det;
    const Float16 u = dot(s, p) * inv_det;
    const Float16 v = dot(d, q) * inv_det;
    const Float16 t = dot(e2, q) * inv_det;
    const std::uint32_t found = block.lanes & less(Float16::splat(smallest_determinant), abs(det)) &
                                less_equal(zero, u) & less_equal(u, one) & less_equal(zero, v) &
                                less_equal(u + v, one) & less(Float16::splat(ray_.t_min), t) &
                                less_equal(t, Float16::splat(limit));
    if (found != 0) {
      t.store(t_);
      u.store(u_);
      v.store(v_);
    }
    return found;
  }

  bool decide(const TriangleBlock& block, int lane, float limit, KernelHit& hit) const {
    hit = {t_[lane], u_[lane], v_[lane], block.first + static_cast<std::uint32_t>(lane)};
    return hit.t <= limit;
  }

 private:
  static Float16 dot(const Float16 (&a)[3], const Float16 (&b)[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  }
  static void cross(const Float16 (&a)[3], const Float16 (&b)[3], Float16 (&out)[3]) {
    out[0] = a[1] * b[2] - b[1] * a[2];
    out[1] = a[2] * b[0] - b[2] * a[0];
    out[2] = a[0] * b[1] - b[0] * a[1];
  }

  const KernelRay& ray_;
  alignas(64) float t_[kBlockSize];
  alignas(64) float u_[kBlockSize];
  alignas(64) float v_[kBlockSize];
};

/// Makes the hit, which is no farther than the best one, the best. Of equally near ones the smallest id wins.
inline void take(const KernelHit& hit, const TreeView& tree, KernelHit& best, float& limit) {
  if (hit.t == best.t && !id_precedes(tree.context, hit.place, best.place)) return;
  best = hit;
  limit = hit.t;
}

inline const void* item_address(const TreeView& tree, Ref ref) {
  static_assert(sizeof(Item) == 256);
  return reinterpret_cast<const char*>(tree.items) + (static_cast<std::size_t>(ref & ~3u) << 6);
}

/// Asks for an item before its turn comes. Harmless for what is no item.
inline void prefetch(const TreeView& tree, Ref ref) {
  const char* const item = static_cast<const char*>(item_address(tree, ref));
  for (std::size_t line = 0; line < sizeof(Item); line += 64) __builtin_prefetch(item + line);
}

/// Nearest hit. Children are visited in the order of the octant of the ray's direction, which needs no sorting
/// and, being an order of the binary tree below, is the same for nodes of any width; what begins behind the best
/// hit so far is dropped when its turn comes.
template <class NodeVector, Intersector kind>
KernelHit intersect(const TreeView& tree, const KernelRay& ray) noexcept {
  constexpr int width = NodeVector::lanes;
  const BoxTest<NodeVector> box_test(ray);
  BlockTest<kind> block_test(ray);
  KernelHit best{-1.0f, 0.0f, 0.0f, kNoPrimitive};
  float limit = ray.limit;

  alignas(64) float distances[stack_size(width)];
  alignas(64) Ref refs[stack_size(width)];
  distances[0] = -1.0f;
  refs[0] = make_ref(RefKind::end, 0);
  int top = 0;
  Ref ref = tree.root;
  for (;;) {
    if (ref_kind(ref) == RefKind::node) {
      const auto& node = *static_cast<const Node<width>*>(item_address(tree, ref));
      NodeVector near, far;
      box_test(node, NodeVector::splat(limit), near, far);
      const int count = push_ordered(near, far, node.child, node.order[box_test.octant()], distances + top + 1,
                                     refs + top + 1, ref);
      if (count != 0) {
        top += count - 1;
        prefetch(tree, refs[top]);
        continue;
      }
    } else if (ref_kind(ref) == RefKind::triangles) {
      const auto& block = *static_cast<const TriangleBlock*>(item_address(tree, ref));
      for (std::uint32_t found = block_test.find(block, limit); found != 0; found &= found - 1) {
        KernelHit hit;
        if (block_test.decide(block, __builtin_ctz(found), limit, hit)) take(hit, tree, best, limit);
      }
    } else if (ref_kind(ref) == RefKind::sphere) {
      float t;
      const std::uint32_t place = ref_index(ref);
      if (hit_sphere<kind>(tree.context, place, ray, limit, t)) take({t, 0.0f, 0.0f, place}, tree, best, limit);
    } else {
      return best;
    }
    while (distances[top] > limit) --top;
    ref = refs[top--];
  }
}

/// Any hit. No order, no distances.
template <class NodeVector, Intersector kind>
bool occluded(const TreeView& tree, const KernelRay& ray) noexcept {
  constexpr int width = NodeVector::lanes;
  const BoxTest<NodeVector> box_test(ray);
  BlockTest<kind> block_test(ray);
  const NodeVector limit = NodeVector::splat(ray.limit);

  alignas(64) Ref refs[stack_size(width)];
  refs[0] = make_ref(RefKind::end, 0);
  int top = 0;
  Ref ref = tree.root;
  for (;;) {
    if (ref_kind(ref) == RefKind::node) {
      const auto& node = *static_cast<const Node<width>*>(item_address(tree, ref));
      NodeVector near, far;
      box_test(node, limit, near, far);
      const int count = push_any(near, far, node.child, refs + top + 1, ref);
      if (count != 0) {
        top += count - 1;
        prefetch(tree, refs[top]);
        continue;
      }
    } else if (ref_kind(ref) == RefKind::triangles) {
      const auto& block = *static_cast<const TriangleBlock*>(item_address(tree, ref));
      for (std::uint32_t found = block_test.find(block, ray.limit); found != 0; found &= found - 1) {
        KernelHit hit;
        if (block_test.decide(block, __builtin_ctz(found), ray.limit, hit)) return true;
      }
    } else if (ref_kind(ref) == RefKind::sphere) {
      float t;
      if (hit_sphere<kind>(tree.context, ref_index(ref), ray, ray.limit, t)) return true;
    } else {
      return false;
    }
    ref = refs[top--];
  }
}

/// A query that is taken forward item by item, so that several can take turns: while one works the items of the others
/// are on their way from memory, which is what a ray in a large tree mostly waits for.
template <class NodeVector, Intersector kind, bool any_hit>
class Flight {
 public:
  static constexpr int width = NodeVector::lanes;

  Flight(const TreeView& tree, const KernelRay& ray)
      : tree_(tree), ray_(ray), box_test_(ray_), block_test_(ray_), limit_(ray.limit), ref_(tree.root) {
    distances_[0] = -1.0f;
    refs_[0] = make_ref(RefKind::end, 0);
  }
  Flight(const Flight&) = delete;
  Flight& operator=(const Flight&) = delete;

  const KernelHit& best() const { return best_; }

  /// Visits one item and asks for the next. False when there is none, or the answer is known.
  bool step() {
    if (ref_kind(ref_) == RefKind::node) {
      const auto& node = *static_cast<const Node<width>*>(item_address(tree_, ref_));
      NodeVector near, far;
      box_test_(node, NodeVector::splat(limit_), near, far);
      const int count = push_ordered(near, far, node.child, node.order[box_test_.octant()], distances_ + top_ + 1,
                                     refs_ + top_ + 1, ref_);
      if (count != 0) {
        top_ += count - 1;
        prefetch(tree_, ref_);
        return true;
      }
    } else if (ref_kind(ref_) == RefKind::triangles) {
      const auto& block = *static_cast<const TriangleBlock*>(item_address(tree_, ref_));
      for (std::uint32_t found = block_test_.find(block, limit_); found != 0; found &= found - 1) {
        KernelHit hit;
        if (!block_test_.decide(block, __builtin_ctz(found), limit_, hit)) continue;
        take(hit, tree_, best_, limit_);
        if (any_hit) return false;
      }
    } else {
      float t;
      const std::uint32_t place = ref_index(ref_);
      if (hit_sphere<kind>(tree_.context, place, ray_, limit_, t)) {
        take({t, 0.0f, 0.0f, place}, tree_, best_, limit_);
        if (any_hit) return false;
      }
    }
    while (distances_[top_] > limit_) --top_;
    ref_ = refs_[top_--];
    if (ref_kind(ref_) == RefKind::end) return false;
    prefetch(tree_, ref_);
    return true;
  }

 private:
  const TreeView& tree_;
  KernelRay ray_;
  BoxTest<NodeVector> box_test_;
  BlockTest<kind> block_test_;
  KernelHit best_{-1.0f, 0.0f, 0.0f, kNoPrimitive};
  float limit_;
  Ref ref_;
  int top_ = 0;
  alignas(64) float distances_[stack_size(width)];
  alignas(64) Ref refs_[stack_size(width)];
};

}  // namespace
}  // namespace raylab::bvh
