#pragma once
// One ray against the triangles of a block; as local to the including file as box_test.hpp. No sum of products is
// contracted and the order of operations is the same for all instruction sets, so all give the same hits, bit for bit.
#include "box_test.hpp"

namespace raylab::bvh {
namespace {

using detail::kDoubtfulFacing;
using detail::kTrustedSignSlope;
using detail::kTrustedSlope;
constexpr float kBookSmallestDeterminant = 1e-8f;

/// A t that is not trusted errs by no more than |t| kRoughError slope (detail::kTrustedSlope has the slope, an
/// error over a depth): some 50 roundings of 2^-24, in theory. Where that decides on which side of the limit it
/// is, t need not be computed again. Below kSmallestError the slope's own rounding would count.
constexpr float kRoughError = 0x1p-18f;
constexpr float kSmallestError = 0x1p-100f;

/// The axes in the order in which intersect_watertight takes them: z along the largest component of the direction, x
/// and y swapped where that is negative. From a table, as it is a guess to a processor that branches.
struct AxisOrder {
  std::int8_t kx, ky, kz;
};
struct AxisOrders {
  AxisOrder of[64];
};
constexpr AxisOrders make_axis_orders() {
  AxisOrders orders{};
  for (int i = 0; i < 64; ++i) {
    const bool x_over_y = (i & 1) != 0, x_over_z = (i & 2) != 0, y_over_z = (i & 4) != 0;
    const int kz = x_over_y ? (x_over_z ? 0 : 2) : (y_over_z ? 1 : 2);
    const int kx = (kz + 1) % 3, ky = (kz + 2) % 3;
    const bool down = (i >> (3 + kz) & 1) != 0;
    orders.of[i] = {static_cast<std::int8_t>(down ? ky : kx), static_cast<std::int8_t>(down ? kx : ky),
                    static_cast<std::int8_t>(kz)};
  }
  return orders;
}
constexpr AxisOrders kAxisOrders = make_axis_orders();
inline int axis_order_index(__m128 direction) {
  const __m128 size = _mm_andnot_ps(_mm_set1_ps(-0.0f), direction);
  const __m128 over = _mm_cmpgt_ps(_mm_shuffle_ps(size, size, _MM_SHUFFLE(3, 1, 0, 0)),
                                   _mm_shuffle_ps(size, size, _MM_SHUFFLE(3, 2, 2, 1)));
  return (_mm_movemask_ps(over) & 7) | (_mm_movemask_ps(direction) & 7) << 3;
}

/// What is known of each position of a block, for the corners of its triangles, one a lane.
template <class Block>
class Corners;
template <>
class Corners<SharedBlock> {
 public:
  static constexpr int vectors = 1;  ///< of positions
  explicit Corners(const SharedBlock& block)
      : at_{Lookup16(block.corner[0]), Lookup16(block.corner[1]), Lookup16(block.corner[2])} {}
  Float16 operator()(int k, const Float16 (&values)[1]) const { return at_[k](values[0]); }

 private:
  Lookup16 at_[3];
};
template <>
class Corners<SeparateBlock> {
 public:
  static constexpr int vectors = 3;
  explicit Corners(const SeparateBlock&) {}
  Float16 operator()(int k, const Float16 (&values)[3]) const { return values[k]; }
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
    const AxisOrder& order = kAxisOrders.of[axis_order_index(load_direction(ray))];
    kx_ = order.kx;
    ky_ = order.ky;
    kz_ = order.kz;
    direction_z_ = ray.direction[kz_];
    shear_x_ = ray.direction[kx_] / direction_z_;
    shear_y_ = ray.direction[ky_] / direction_z_;
    origin_x_ = ray.origin[kx_];
    origin_y_ = ray.origin[ky_];
    origin_z_ = ray.origin[kz_];
  }

  /// Of the last block in which lanes were found: by lane the edge functions, or t, beta and gamma; by position z and
  /// max(|x|, |y|). Also the lanes where float does not decide whether they are hit, or how far away.
  struct Found {
    std::uint32_t unsure, imprecise;
    alignas(64) float t[kBlockSize];
    alignas(64) float u[kBlockSize];
    alignas(64) float v[kBlockSize];
    alignas(64) float w[kBlockSize];
    alignas(64) float z[3 * kBlockSize];
    alignas(64) float xy[3 * kBlockSize];
  };

  /// The lanes whose edge functions do not differ in sign, for decide_one().
  template <class Block>
  std::uint32_t find_inside(const Block& block, Found& out) const {
    constexpr int vectors = Corners<Block>::vectors;
    Float16 x[vectors], y[vectors], z[vectors], u, v, w;
    const std::uint32_t found = inside(block, Corners<Block>(block), x, y, z, u, v, w);
    keep(x, y, z, u, v, w, out);
    return found;
  }

  /// The lanes whose edge functions do not differ in sign.
  template <bool any_hit, class Block>
  std::uint32_t find(const Block& block, [[maybe_unused]] float limit, Found& out) const {
    constexpr int vectors = Corners<Block>::vectors;
    const Float16 zero = Float16::splat(0.0f);
    const Corners<Block> corner(block);
    Float16 x[vectors], y[vectors], z[vectors], u, v, w;
    const std::uint32_t found = inside(block, corner, x, y, z, u, v, w);
    if (found == 0) return 0;
    if constexpr (!kDividesAllLanes) {
      keep(x, y, z, u, v, w, out);
      return found;
    }
    const Float16 smallest = min(w, min(v, u));
    const Float16 largest = max(w, max(v, u));
    Float16 xy[vectors];
    for (int i = 0; i < vectors; ++i) xy[i] = max(abs(x[i]), abs(y[i]));
    const Float16 det = u + v + w;
    const Float16 az = corner(0, z), bz = corner(1, z), cz = corner(2, z);
    const Float16 inv_det = Float16::splat(1.0f) / det;
    const Float16 beta = v * inv_det;
    const Float16 gamma = w * inv_det;
    const Float16 ab = bz - az, ac = cz - az;
    const Float16 hit_z = az + beta * ab + gamma * ac;
    const Float16 t = hit_z / Float16::splat(direction_z_);
    const Float16 size = abs(det);
    const Float16 xy_size = max(corner(0, xy), max(corner(1, xy), corner(2, xy)));
    const Float16 z_size = max(abs(az), max(abs(bz), abs(cz)));
    const Float16 error = z_size * (max(abs(ab), abs(ac)) * xy_size);
    const Float16 depth = abs(hit_z) * size;
    const std::uint32_t precise = less(error, Float16::splat(kTrustedSlope) * depth) |
                                  (less(t, zero) & less(error, Float16::splat(kTrustedSignSlope) * depth));
    const std::uint32_t sure = less(Float16::splat(0x1p-100f), size) & less(size, Float16::splat(0x1p120f)) &
                               ~equal(smallest, zero) & ~equal(largest, zero);
    const Float16 margin = max(error, Float16::splat(kSmallestError)) * Float16::splat(kRoughError) * abs(t);
    std::uint32_t decided = precise | less(margin, (t - Float16::splat(limit)) * depth);
    if constexpr (any_hit) {
      decided |= less(margin, (Float16::splat(limit) - t) * depth) &
                 less(margin, (t - Float16::splat(ray_.t_min)) * depth);
    }
    out.unsure = found & ~sure;
    out.imprecise = found & ~decided;
    t.store(out.t);
    beta.store(out.v);
    gamma.store(out.w);
    return out.unsure | out.imprecise |
           (found & less(Float16::splat(ray_.t_min), t) & less_equal(t, Float16::splat(limit)));
  }

  /// With any_hit the distance need not be right.
  template <bool any_hit, class Block>
  bool decide(const Block& block, const Found& found, int lane, float limit, KernelHit& hit) const {
    if constexpr (kDividesAllLanes) {
      if ((found.unsure >> lane & 1u) != 0) [[unlikely]]
        return hit_triangle_again(block, lane, ray_, limit, hit);
      hit = {found.t[lane], found.v[lane], found.w[lane], block.first + static_cast<std::uint32_t>(lane)};
      if ((found.imprecise >> lane & 1u) != 0) {
        hit.t = plane_distance(block, lane, ray_, hit.t);
        if (!(hit.t > ray_.t_min)) return false;
      }
      return hit.t <= limit;
    }
    return decide_one<any_hit>(block, found, lane, limit, hit);
  }

  /// decide() after find_inside().
  template <bool any_hit, class Block>
  bool decide_one(const Block& block, const Found& found, int lane, float limit, KernelHit& hit) const {
    const int a = corner_of(block, 0, lane), b = corner_of(block, 1, lane), c = corner_of(block, 2, lane);
    const float u = found.u[lane], v = found.v[lane], w = found.w[lane];
    const float det = u + v + w;
    const float inv_det = 1.0f / det;
    const float beta = v * inv_det;
    const float gamma = w * inv_det;
    const float ab = found.z[b] - found.z[a], ac = found.z[c] - found.z[a];
    const float z = found.z[a] + beta * ab + gamma * ac;
    float t = z / direction_z_;
    const float size = __builtin_fabsf(det);
    // False for not a number, too.
    const bool sure = (u != 0.0f) & (v != 0.0f) & (w != 0.0f) & (size > 0x1p-100f) & (size < 0x1p120f);
    if (!sure) [[unlikely]]
      return hit_triangle_again(block, lane, ray_, limit, hit);
    const float xy_size = largest_of(found.xy[a], found.xy[b], found.xy[c]);
    const float z_size = largest_of(__builtin_fabsf(found.z[a]), __builtin_fabsf(found.z[b]), __builtin_fabsf(found.z[c]));
    const float error = z_size * (larger_of(__builtin_fabsf(ab), __builtin_fabsf(ac)) * xy_size);
    const float depth = __builtin_fabsf(z) * size;
    if (!(error < (t < 0.0f ? kTrustedSignSlope : kTrustedSlope) * depth)) {
      const float margin = larger_of(error, kSmallestError) * kRoughError * __builtin_fabsf(t);
      if (margin < (t - limit) * depth) return false;
      if (!(any_hit && margin < (limit - t) * depth && margin < (t - ray_.t_min) * depth))
        t = plane_distance(block, lane, ray_, t);
    }
    hit = {t, beta, gamma, block.first + static_cast<std::uint32_t>(lane)};
    return (t > ray_.t_min) & (t <= limit);
  }

 private:
  template <class Block, int vectors>
  std::uint32_t inside(const Block& block, const Corners<Block>& corner, Float16 (&x)[vectors], Float16 (&y)[vectors],
                       Float16 (&z)[vectors], Float16& u, Float16& v, Float16& w) const {
    for (int i = 0; i < vectors; ++i) {
      const int first = i * kBlockSize;
      z[i] = Float16::load(block.position[kz_] + first) - Float16::splat(origin_z_);
      x[i] =
          Float16::load(block.position[kx_] + first) - Float16::splat(origin_x_) - Float16::splat(shear_x_) * z[i];
      y[i] =
          Float16::load(block.position[ky_] + first) - Float16::splat(origin_y_) - Float16::splat(shear_y_) * z[i];
    }
    const Float16 ax = corner(0, x), bx = corner(1, x), cx = corner(2, x);
    const Float16 ay = corner(0, y), by = corner(1, y), cy = corner(2, y);
    u = cx * by - cy * bx;
    v = ax * cy - ay * cx;
    w = bx * ay - by * ax;
    const Float16 zero = Float16::splat(0.0f);
    return block.lanes & ~(less(min(w, min(v, u)), zero) & less(zero, max(w, max(v, u))));
  }

  /// What decide_one() reads.
  template <int vectors>
  static void keep(const Float16 (&x)[vectors], const Float16 (&y)[vectors], const Float16 (&z)[vectors], Float16 u,
                   Float16 v, Float16 w, Found& out) {
    u.store(out.u);
    v.store(out.v);
    w.store(out.w);
    for (int i = 0; i < vectors; ++i) {
      z[i].store(out.z + i * kBlockSize);
      max(abs(x[i]), abs(y[i])).store(out.xy + i * kBlockSize);
    }
  }

  static float larger_of(float a, float b) { return a > b ? a : b; }
  static float largest_of(float a, float b, float c) { return larger_of(larger_of(a, b), c); }

  const KernelRay& ray_;
  int kx_, ky_, kz_;
  float origin_x_, origin_y_, origin_z_;
  float shear_x_, shear_y_, direction_z_;
};

/// As intersect_moeller_trumbore does, operation by operation.
template <Intersector kind>
class BlockTest {
 public:
  explicit BlockTest(const KernelRay& ray) : ray_(ray) {}

  struct Found {
    alignas(64) float t[kBlockSize];
    alignas(64) float u[kBlockSize];
    alignas(64) float v[kBlockSize];
  };

  template <bool any_hit, class Block>
  std::uint32_t find(const Block& block, float limit, Found& out) const {
    constexpr int vectors = Corners<Block>::vectors;
    constexpr float smallest_determinant = kind == Intersector::book ? kBookSmallestDeterminant : 0.0f;
    const Float16 zero = Float16::splat(0.0f), one = Float16::splat(1.0f);
    const Corners<Block> corner(block);
    Float16 d[3], e1[3], e2[3], s[3];
    for (int axis = 0; axis < 3; ++axis) {
      Float16 position[vectors];
      for (int i = 0; i < vectors; ++i) position[i] = Float16::load(block.position[axis] + i * kBlockSize);
      const Float16 a = corner(0, position);
      e1[axis] = corner(1, position) - a;
      e2[axis] = corner(2, position) - a;
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
      t.store(out.t);
      u.store(out.u);
      v.store(out.v);
    }
    return found;
  }

  template <bool any_hit, class Block>
  bool decide(const Block& block, const Found& found, int lane, float limit, KernelHit& hit) const {
    hit = {found.t[lane], found.u[lane], found.v[lane], block.first + static_cast<std::uint32_t>(lane)};
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
};

}  // namespace
}  // namespace raylab::bvh
