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
/// that gives NaN, the origin is in the plane, and max and min ignore it.
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
    near = t_min_;
    far = limit;
    for (int axis = 0; axis < 3; ++axis) {
      const Vector to_near_plane = Vector::load(node.planes[near_plane_[axis]]) - origin_[axis];
      const Vector to_far_plane = Vector::load(node.planes[near_plane_[axis] ^ 1]) - origin_[axis];
      near = max(to_near_plane * to_near_[axis], near);
      far = min(to_far_plane * to_far_[axis], far);
    }
  }

 private:
  Vector origin_[3], to_near_[3], to_far_[3];
  Vector t_min_;
  int near_plane_[3];
  int octant_ = 0;
};

/// Lanes of a block that are hit, with what a hit is made of.
struct BlockHits {
  std::uint32_t accepted;  ///< hit, with t_min < t <= limit
  std::uint32_t unsure;    ///< to be decided again, one by one
  Float16 t, u, v;
};

/// One ray against the triangles of a block.
template <Intersector kind>
class BlockTest;

/// As intersect_watertight does, operation by operation.
template <>
class BlockTest<Intersector::watertight> {
 public:
  explicit BlockTest(const KernelRay& ray) {
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

  BlockHits operator()(const TriangleBlock& block, float t_min, float limit) const {
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
    BlockHits hits;
    const std::uint32_t candidates = block.lanes & ~(less(smallest, zero) & less(zero, largest));
    hits.accepted = hits.unsure = 0;
    if (candidates == 0) return hits;

    const Float16 det = u + v + w;
    const Float16 az = at_a(z), bz = at_b(z), cz = at_c(z);
    const Float16 inv_det = Float16::splat(1.0f) / det;
    hits.u = v * inv_det;
    hits.v = w * inv_det;
    const Float16 hit_z = az + hits.u * (bz - az) + hits.v * (cz - az);
    hits.t = hit_z / Float16::splat(direction_z_);

    const Float16 size = abs(det);
    const Float16 xy = max(abs(x), abs(y));
    const Float16 xy_size = max(at_a(xy), max(at_b(xy), at_c(xy)));
    const Float16 z_size = max(abs(az), max(abs(bz), abs(cz)));
    const std::uint32_t sure = less(Float16::splat(0x1p-100f), size) & less(size, Float16::splat(0x1p120f)) &
                               less(Float16::splat(kZError) * z_size * xy_size * xy_size, abs(hit_z) * size);
    hits.unsure = candidates & (equal(smallest, zero) | equal(largest, zero) | ~sure);
    hits.accepted = candidates & ~hits.unsure & less(Float16::splat(t_min), hits.t) &
                    less_equal(hits.t, Float16::splat(limit));
    return hits;
  }

 private:
  int kx_, ky_, kz_;
  float origin_x_, origin_y_, origin_z_;
  float shear_x_, shear_y_, direction_z_;
};

/// As intersect_moeller_trumbore does, operation by operation.
template <Intersector kind>
class BlockTest {
 public:
  explicit BlockTest(const KernelRay& ray) : ray_(ray) {}

  BlockHits operator()(const TriangleBlock& block, float t_min, float limit) const {
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
    BlockHits hits;
    hits.u = dot(s, p) * inv_det;
    hits.v = dot(d, q) * inv_det;
    hits.t = dot(e2, q) * inv_det;
    hits.unsure = 0;
    hits.accepted = block.lanes & less(Float16::splat(smallest_determinant), abs(det)) & less_equal(zero, hits.u) &
                    less_equal(hits.u, one) & less_equal(zero, hits.v) & less_equal(hits.u + hits.v, one) &
                    less(Float16::splat(t_min), hits.t) & less_equal(hits.t, Float16::splat(limit));
    return hits;
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
};

/// Makes the nearest of the hits the best one, if it is. Of equally near ones the smallest id wins, which in a
/// block is the first lane.
inline void take_nearest(const BlockHits& hits, const TriangleBlock& block, const void* context, KernelHit& best,
                         float& limit) {
  alignas(64) float t[kBlockSize];
  hits.t.store(t);
  int lane = __builtin_ctz(hits.accepted);
  for (std::uint32_t rest = hits.accepted & (hits.accepted - 1); rest != 0; rest &= rest - 1) {
    const int other = __builtin_ctz(rest);
    if (t[other] < t[lane]) lane = other;
  }
  const std::uint32_t place = block.first + static_cast<std::uint32_t>(lane);
  if (t[lane] == best.t && !id_precedes(context, place, best.place)) return;
  alignas(64) float u[kBlockSize];
  alignas(64) float v[kBlockSize];
  hits.u.store(u);
  hits.v.store(v);
  best = {t[lane], u[lane], v[lane], place};
  limit = t[lane];
}

[[gnu::noinline, gnu::cold]] inline void take_unsure(std::uint32_t unsure, const TriangleBlock& block,
                                                     const TreeView& tree, const KernelRay& ray, KernelHit& best,
                                                     float& limit) {
  for (; unsure != 0; unsure &= unsure - 1) {
    KernelHit hit;
    if (!hit_triangle_again(block, __builtin_ctz(unsure), ray, limit, hit)) continue;
    if (hit.t == best.t && !id_precedes(tree.context, hit.place, best.place)) continue;
    best = hit;
    limit = hit.t;
  }
}

/// Nearest hit. Children are visited in the order of the octant of the ray's direction, which needs no sorting
/// and, being an order of the binary tree below, is the same for nodes of any width; nodes that begin behind the
/// best hit so far are dropped when their turn comes.
template <class NodeVector, Intersector kind>
KernelHit intersect(const TreeView& tree, const KernelRay& ray) noexcept {
  constexpr int width = NodeVector::lanes;
  const auto* const nodes = static_cast<const Node<width>*>(tree.nodes);
  const BoxTest<NodeVector> box_test(ray);
  const BlockTest<kind> block_test(ray);
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
      const Node<width>& node = nodes[ref_index(ref)];
      NodeVector near, far;
      box_test(node, NodeVector::splat(limit), near, far);
      top +=
          push_ordered(near, far, node.child, node.order[box_test.octant()], distances + top + 1, refs + top + 1);
    } else if (ref_kind(ref) == RefKind::triangles) {
      const TriangleBlock& block = tree.blocks[ref_index(ref)];
      const BlockHits hits = block_test(block, ray.t_min, limit);
      if (hits.accepted != 0) take_nearest(hits, block, tree.context, best, limit);
      if (hits.unsure != 0) [[unlikely]]
        take_unsure(hits.unsure, block, tree, ray, best, limit);
    } else if (ref_kind(ref) == RefKind::sphere) {
      float t;
      const std::uint32_t place = ref_index(ref);
      if (hit_sphere<kind>(tree.context, place, ray, limit, t) &&
          (t != best.t || id_precedes(tree.context, place, best.place))) {
        best = {t, 0.0f, 0.0f, place};
        limit = t;
      }
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
  const auto* const nodes = static_cast<const Node<width>*>(tree.nodes);
  const BoxTest<NodeVector> box_test(ray);
  const BlockTest<kind> block_test(ray);
  const NodeVector limit = NodeVector::splat(ray.limit);

  alignas(64) Ref refs[stack_size(width)];
  refs[0] = make_ref(RefKind::end, 0);
  int top = 0;
  Ref ref = tree.root;
  for (;;) {
    if (ref_kind(ref) == RefKind::node) {
      const Node<width>& node = nodes[ref_index(ref)];
      NodeVector near, far;
      box_test(node, limit, near, far);
      top += push_any(near, far, node.child, refs + top + 1);
    } else if (ref_kind(ref) == RefKind::triangles) {
      const TriangleBlock& block = tree.blocks[ref_index(ref)];
      const BlockHits hits = block_test(block, ray.t_min, ray.limit);
      if (hits.accepted != 0) return true;
      for (std::uint32_t unsure = hits.unsure; unsure != 0; unsure &= unsure - 1) {
        KernelHit hit;
        if (hit_triangle_again(block, __builtin_ctz(unsure), ray, ray.limit, hit)) return true;
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

template <class NodeVector>
constexpr Kernel make_kernel(const char* isa) {
  return {isa,
          NodeVector::lanes,
          {intersect<NodeVector, Intersector::book>, intersect<NodeVector, Intersector::fast>,
           intersect<NodeVector, Intersector::watertight>},
          {occluded<NodeVector, Intersector::book>, occluded<NodeVector, Intersector::fast>,
           occluded<NodeVector, Intersector::watertight>}};
}

}  // namespace
}  // namespace raylab::bvh
