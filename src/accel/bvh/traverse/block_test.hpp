#pragma once
// One ray against the triangles of a block, a triangle a lane.
#include "box_test.hpp"
#include "geometry/scalar_tests.hpp"

namespace raylab::bvh {
namespace {

using Float16Lanes = Float<kBlockSize>;

/// What is known of each position of a block, for the corners of its triangles, one a lane.
template <class Block>
class Corners;
template <>
class Corners<SharedBlock> {
 public:
  static constexpr int vectors = 1;  ///< of positions
  explicit Corners(const SharedBlock& block)
      : at_{Permutation16(block.corner[0]), Permutation16(block.corner[1]), Permutation16(block.corner[2])} {}
  Float16Lanes operator()(int k, const Float16Lanes (&values)[1]) const { return at_[k](values[0]); }

 private:
  Permutation16 at_[3];
};
template <>
class Corners<SeparateBlock> {
 public:
  static constexpr int vectors = 3;
  explicit Corners(const SeparateBlock&) {}
  Float16Lanes operator()(int k, const Float16Lanes (&values)[3]) const { return values[k]; }
};

template <class Block>
Vec3<float> corner_at(const Block& block, int k, int lane) {
  const int at = corner_of(block, k, lane);
  return {block.position[0][at], block.position[1][at], block.position[2][at]};
}
inline Vec3<float> three(const float (&v)[4]) { return {v[0], v[1], v[2]}; }

/// The triangle in a lane of a block where floats do not decide it. Fills in all of the hit.
template <class Block>
[[gnu::noinline, gnu::cold]] bool compute_in_double(const Block& block, int lane, const TraversalRay& ray, float limit,
                                                    ScalarHit& hit) {
  const bool is_hit =
      watertight_in_double(PreparedRay(three(ray.origin), three(ray.direction)), corner_at(block, 0, lane),
                           corner_at(block, 1, lane), corner_at(block, 2, lane), hit);
  return is_hit && hit.t > ray.t_min() && hit.t <= limit;
}
/// No reference to `hit` is passed on, so that it stays in registers: a wide load of what was just written to memory
/// in parts would wait for it.
template <class Block>
[[gnu::always_inline]] inline bool hit_in_double(const Block& block, int lane, const TraversalRay& ray, float limit,
                                                 TraversalHit& hit) {
  ScalarHit found;
  const bool is_hit = compute_in_double(block, lane, ray, limit, found);
  hit = {found.t, found.u, found.v, block.first + static_cast<std::uint32_t>(lane)};
  return is_hit;
}
/// Distance to the plane of the triangle in a lane.
template <class Block>
[[gnu::noinline]] float plane_distance_of(const Block& block, int lane, const TraversalRay& ray, float otherwise) {
  const Vec3<float> direction = three(ray.direction);
  return plane_distance<float>(AxisOrder<float>(direction), three(ray.origin), direction, corner_at(block, 0, lane),
                               corner_at(block, 1, lane), corner_at(block, 2, lane), otherwise);
}

/// One ray against the triangles of a block: find() gives the lanes that may be hit, decide() whether one of them is,
/// with t_min < t <= limit. Of the lanes found there is seldom more than one, so where vectors are short
/// (kSixteenAtOnce false) the distance is computed for those alone.
template <Intersector kind>
class BlockTest;

template <>
class BlockTest<Intersector::watertight> {
  using F = Float16Lanes;

 public:
  explicit BlockTest(const TraversalRay& ray) : ray_(ray), sheared_(three(ray.direction)) {
    for (int i = 0; i < 3; ++i) origin_[i] = ray.origin[i == 0 ? axes().kx : (i == 1 ? axes().ky : axes().kz)];
  }

  /// Results for a block: for each lane the edge functions, or t, beta and gamma; for each position z and max(|x|,
  /// |y|). Lanes whose hit floats do not decide are `unsure`; those whose distance floats do not decide, `imprecise`.
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
  [[gnu::always_inline]] std::uint32_t find_inside(const Block& block, Found& out) const {
    constexpr int vectors = Corners<Block>::vectors;
    F x[vectors], y[vectors], z[vectors];
    EdgeFunctions<F> edges;
    const std::uint32_t found = inside(block, Corners<Block>(block), x, y, z, edges);
    store(x, y, z, edges, out);
    return found;
  }

  /// The lanes that may be hit, for decide().
  template <bool any_hit, class Block>
  std::uint32_t find(const Block& block, [[maybe_unused]] float limit, Found& out) const {
    constexpr int vectors = Corners<Block>::vectors;
    const Corners<Block> corner(block);
    F x[vectors], y[vectors], z[vectors];
    EdgeFunctions<F> edges;
    const std::uint32_t found = inside(block, corner, x, y, z, edges);
    if (found == 0) return 0;
    if constexpr (!kSixteenAtOnce) {
      store(x, y, z, edges, out);
      return found;
    } else {
      F xy[vectors];
      for (int i = 0; i < vectors; ++i) xy[i] = max(abs(x[i]), abs(y[i]));
      const F xy_size = max(corner(0, xy), max(corner(1, xy), corner(2, xy)));
      const WatertightHit<F> hit =
          watertight_hit<F>(edges, corner(0, z), corner(1, z), corner(2, z), xy_size, F(sheared_.direction_z));
      const F t_min(ray_.t_min()), to(limit);
      out.unsure = found & (!hit.sure).bits();
      out.imprecise = found & (!(hit.precise | side_is_certain<any_hit>(hit, t_min, to))).bits();
      hit.t.store(out.t);
      hit.beta.store(out.v);
      hit.gamma.store(out.w);
      return out.unsure | out.imprecise | (found & ((t_min < hit.t) & (hit.t <= to)).bits());
    }
  }

  /// With any_hit the distance need not be right.
  template <bool any_hit, class Block>
  bool decide(const Block& block, const Found& found, int lane, float limit, TraversalHit& hit) const {
    if constexpr (kSixteenAtOnce) {
      if ((found.unsure >> lane & 1u) != 0) [[unlikely]]
        return hit_in_double(block, lane, ray_, limit, hit);
      hit = {found.t[lane], found.v[lane], found.w[lane], block.first + static_cast<std::uint32_t>(lane)};
      if ((found.imprecise >> lane & 1u) != 0) {
        hit.t = plane_distance_of(block, lane, ray_, hit.t);
        if (!(hit.t > ray_.t_min())) return false;
      }
      return hit.t <= limit;
    } else {
      return decide_one<any_hit>(block, found, lane, limit, hit);
    }
  }

  /// decide() after find_inside().
  template <bool any_hit, class Block>
  bool decide_one(const Block& block, const Found& found, int lane, float limit, TraversalHit& hit) const {
    const int a = corner_of(block, 0, lane), b = corner_of(block, 1, lane), c = corner_of(block, 2, lane);
    const float xy_size = max(max(found.xy[a], found.xy[b]), found.xy[c]);
    const WatertightHit<float> h = watertight_hit<float>({found.u[lane], found.v[lane], found.w[lane]}, found.z[a],
                                                         found.z[b], found.z[c], xy_size, sheared_.direction_z);
    if (!h.sure) [[unlikely]]
      return hit_in_double(block, lane, ray_, limit, hit);
    hit = {h.t, h.beta, h.gamma, block.first + static_cast<std::uint32_t>(lane)};
    if (!h.precise && !side_is_certain<any_hit>(h, ray_.t_min(), limit))
      hit.t = plane_distance_of(block, lane, ray_, h.t);
    return (hit.t > ray_.t_min()) & (hit.t <= limit);
  }

 private:
  const AxisOrder<float>& axes() const { return sheared_.axes; }

  /// The lanes whose edge functions do not differ in sign; gives them, and the positions in the ray's space.
  template <class Block, int vectors>
  [[gnu::always_inline]] std::uint32_t inside(const Block& block, const Corners<Block>& corner, F (&x)[vectors],
                                              F (&y)[vectors], F (&z)[vectors], EdgeFunctions<F>& edges) const {
    const auto from_origin = [&](int axis, float origin, int i) {
      return F::load(block.position[axis] + i * kBlockSize) - F(origin);
    };
    for (int i = 0; i < vectors; ++i) {
      const Vec3<F> p = sheared(from_origin(axes().kx, origin_[0], i), from_origin(axes().ky, origin_[1], i),
                                from_origin(axes().kz, origin_[2], i), F(sheared_.shear_x), F(sheared_.shear_y));
      x[i] = p.x;
      y[i] = p.y;
      z[i] = p.z;
    }
    edges = edge_functions<F>(corner(0, x), corner(0, y), corner(1, x), corner(1, y), corner(2, x), corner(2, y));
    return block.lanes & ~differ_in_sign(edges).bits();
  }

  /// What decide_one() reads.
  template <int vectors>
  static void store(const F (&x)[vectors], const F (&y)[vectors], const F (&z)[vectors], const EdgeFunctions<F>& edges,
                    Found& out) {
    edges.u.store(out.u);
    edges.v.store(out.v);
    edges.w.store(out.w);
    for (int i = 0; i < vectors; ++i) {
      z[i].store(out.z + i * kBlockSize);
      max(abs(x[i]), abs(y[i])).store(out.xy + i * kBlockSize);
    }
  }

  const TraversalRay& ray_;
  ShearedRay<float> sheared_;
  float origin_[3];  ///< in the order of the axes
};

/// Möller and Trumbore's.
template <Intersector kind>
class BlockTest {
 public:
  explicit BlockTest(const TraversalRay& ray) : ray_(ray) {}

  struct Found {
    alignas(64) float t[kBlockSize];
    alignas(64) float u[kBlockSize];
    alignas(64) float v[kBlockSize];
  };

  template <bool any_hit, class Block>
  std::uint32_t find(const Block& block, float limit, Found& out) const {
    using F = Float16Lanes;
    constexpr int vectors = Corners<Block>::vectors;
    const Corners<Block> corner(block);
    F x[vectors], y[vectors], z[vectors];
    for (int i = 0; i < vectors; ++i) {
      x[i] = F::load(block.position[0] + i * kBlockSize);
      y[i] = F::load(block.position[1] + i * kBlockSize);
      z[i] = F::load(block.position[2] + i * kBlockSize);
    }
    const auto at = [&](int k) { return Vec3<F>(corner(k, x), corner(k, y), corner(k, z)); };
    const MoellerTrumboreHit<F> hit = moeller_trumbore<F>(Vec3<F>(three(ray_.origin)), Vec3<F>(three(ray_.direction)),
                                                          at(0), at(1), at(2), smallest_determinant(kind));
    const std::uint32_t found = block.lanes & (hit.inside & (F(ray_.t_min()) < hit.t) & (hit.t <= F(limit))).bits();
    if (found != 0) {
      hit.t.store(out.t);
      hit.u.store(out.u);
      hit.v.store(out.v);
    }
    return found;
  }

  template <bool any_hit, class Block>
  bool decide(const Block& block, const Found& found, int lane, float limit, TraversalHit& hit) const {
    hit = {found.t[lane], found.u[lane], found.v[lane], block.first + static_cast<std::uint32_t>(lane)};
    return hit.t <= limit;
  }

 private:
  const TraversalRay& ray_;
};

}  // namespace
}  // namespace raylab::bvh
