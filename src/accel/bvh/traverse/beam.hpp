#pragma once
// What the rays of a packet have in common, as bounds: with these a node's boxes and a block's triangles are tested for
// all rays at once, and only what some ray may hit is then tested ray by ray (Boulos, Wald and Shirley 2006, "Geometric
// and Arithmetic Culling Methods for Entire Ray Packets").
#include "block_test.hpp"

namespace raylab::bvh {
namespace {

/// Bounds of a number over the rays of a packet.
struct Bounds {
  float lower, upper;

  Bounds() = default;
  Bounds(float l, float u) : lower(l), upper(u) {}
  /// Of numbers that are often the same in all lanes.
  Bounds(Wide x, WideMask lanes) : lower(greatest(select(lanes, x, Wide(-kInfinity)))), upper(lower) {
    if (any(lanes & (x != Wide(upper)))) lower = least(select(lanes, x, Wide(kInfinity)));
  }
};

/// Whether nodes are tested so, and blocks: where a register holds few rays and few numbers it costs more than it
/// saves, as it does in trees without nodes below the root.
constexpr bool kTracesBeams = kLanes >= 8;
constexpr bool kBlocksByBeam = kLanes >= 16;

/// Rays whose directions have the same signs, none of them being 0.
class Beam {
 public:
  Beam() = default;
  /// Of the rays in `lanes`. Their shears are needed where there are blocks.
  Beam(const WideVec3& origin, const WideVec3& direction, const ShearedRay<Wide>* sheared, WideMask lanes) {
    const std::uint32_t all = lanes.bits();
    if (all == 0) return;
    const Wide zero(0.0f);
    for (int axis = 0; axis < 3; ++axis) {
      const Wide d = (&direction.x)[axis], o = (&origin.x)[axis];
      if (any(lanes & (o != o))) return;  // no bounds hold for NaN
      const std::uint32_t downwards = (d < zero).bits() & all;
      if (downwards == all) octant_ |= 1 << axis;
      if (downwards != all && ((zero < d).bits() & all) != all) return;
    }
    float most = 0.0f;
    for (int axis = 0; axis < 3; ++axis) {
      origin_[axis] = Bounds((&origin.x)[axis], lanes);
      const Bounds d((&direction.x)[axis], lanes);
      width_ = max(width_, origin_[axis].upper - origin_[axis].lower);
      growth_ = max(growth_, d.upper - d.lower);
      const Bounds reciprocal(1.0f / d.upper, 1.0f / d.lower);
      to_near_[axis] = {reciprocal.lower * kShrink, reciprocal.upper * kShrink};
      to_far_[axis] = {reciprocal.lower * kGrow, reciprocal.upper * kGrow};
      // An infinite factor times 0 would be NaN.
      if (!(-kInfinity < to_far_[axis].lower && to_far_[axis].upper < kInfinity)) return;
      if (const float smallest = max(d.lower, -d.upper); most < smallest) {
        most = smallest;
        axes_[2] = axis;
      }
    }
    is_usable_ = true;
    if (sheared == nullptr) return;
    axes_[0] = (axes_[2] + 1) % 3;
    axes_[1] = (axes_[2] + 2) % 3;
    has_axes_ = sheared->axes.z_is(axes_[2], lanes);
    if (!has_axes_) return;
    shear_[0] = Bounds(sheared->shear_x, lanes);
    shear_[1] = Bounds(sheared->shear_y, lanes);
  }

  bool is_usable() const { return kTracesBeams && is_usable_; }
  /// That of all directions.
  int octant() const { return octant_; }
  /// Whether the watertight test has one order of axes for all rays; then axis(i) is the i-th.
  bool has_axes() const { return kBlocksByBeam && has_axes_; }
  int axis(int i) const { return axes_[i]; }

  /// The children of a node that some ray may hit in an interval of t are those with near <= far. None that the test of
  /// single rays finds is lost: rounding is monotonic, so what is computed from bounds bounds what is computed from the
  /// rays.
  SlabInterval<Float<kWidth>> operator()(const Node& node, const Bounds& t) const {
    using F = Float<kWidth>;
    F near(t.lower), far(t.upper);
    for (int axis = 0; axis < 3; ++axis) {
      const int down = octant_ >> axis & 1;
      const Bounds &o = origin_[axis], &n = to_near_[axis], &f = to_far_[axis];
      const F to_near = F::load(node.planes[2 * axis + down]) - F(down != 0 ? o.lower : o.upper);
      const F to_far = F::load(node.planes[2 * axis + 1 - down]) - F(down != 0 ? o.upper : o.lower);
      near = max(near, min(to_near * F(n.lower), to_near * F(n.upper)));
      far = min(far, max(to_far * F(f.lower), to_far * F(f.upper)));
    }
    return {near, far};
  }

  /// The children of a node that are at least as large as the rays are apart there, given where these enter.
  Mask<kWidth> larger_than_beam(const Node& node, Float<kWidth> near) const {
    using F = Float<kWidth>;
    const auto extent = [&](int axis) { return F::load(node.planes[2 * axis + 1]) - F::load(node.planes[2 * axis]); };
    return F(width_) + F(growth_) * near <= max(max(extent(0), extent(1)), extent(2));
  }

  /// The lanes of a block whose triangles some ray may pass: those that do not lie, with all three corners, on one side
  /// of all rays. For beams that have axes.
  template <class Block>
  std::uint32_t may_pass(const Block& block) const {
    constexpr int vectors = Corners<Block>::vectors;
    std::uint32_t sides[vectors][kSides];
    for (int i = 0; i < vectors; ++i) find_sides(block, i, sides[i]);
    return block.lanes & ~all_corners_aside(block, sides);
  }

 private:
  using F = Float16Lanes;
  static constexpr int kSides = 4;  ///< left, right, below and above
  /// By how much a vertex must be aside, as a part of its distance from the origin along the axes: the watertight test
  /// displaces it by at most six roundings of 2^-24 of that. It may decide in double on the vertices as they are, which
  /// what is aside by more than the displacement does not change. The flushing of denormals counts as kSmallestSide.
  static constexpr float kSideError = 0x1p-20f;
  static constexpr float kSmallestSide = 0x1p-100f;

  struct Interval {
    F lower, upper;

    F size() const { return max(abs(lower), abs(upper)); }
  };
  /// Coordinates of vertices relative to the origins.
  template <class Block>
  Interval from_origin(const Block& block, int vector, int i) const {
    const F at = F::load(block.position[axes_[i]] + vector * kBlockSize);
    return {at - F(origin_[axes_[i]].upper), at - F(origin_[axes_[i]].lower)};
  }

  /// For each side the vertices of a vector that all rays leave there, a bit each.
  template <class Block>
  void find_sides(const Block& block, int vector, std::uint32_t (&sides)[kSides]) const {
    const Interval x[2] = {from_origin(block, vector, 0), from_origin(block, vector, 1)},
                   z = from_origin(block, vector, 2);
    const F margin = max(max(x[0].size(), x[1].size()), z.size()) * F(kSideError) + F(kSmallestSide);
    for (int i = 0; i < 2; ++i) {
      const F least_shear(shear_[i].lower), most_shear(shear_[i].upper);
      const F p = least_shear * z.lower, q = least_shear * z.upper, r = most_shear * z.lower, s = most_shear * z.upper;
      sides[2 * i] = (margin < x[i].lower - max(max(p, q), max(r, s))).bits();
      sides[2 * i + 1] = (margin < min(min(p, q), min(r, s)) - x[i].upper).bits();
    }
  }

  /// The lanes with a side where all three corners are.
  static std::uint32_t all_corners_aside(const SharedBlock& block, const std::uint32_t (&sides)[1][kSides]) {
    return common_to_all(sides[0], block.corner[0], block.corner[1], block.corner[2]);
  }
  static std::uint32_t all_corners_aside(const SeparateBlock&, const std::uint32_t (&sides)[3][kSides]) {
    std::uint32_t aside = 0;
    for (int side = 0; side < kSides; ++side) aside |= sides[0][side] & sides[1][side] & sides[2][side];
    return aside;
  }

  bool is_usable_ = false, has_axes_ = false;
  int octant_ = 0;
  int axes_[3];
  Bounds origin_[3], to_near_[3], to_far_[3];
  Bounds shear_[2];                     ///< in the order of the axes
  float width_ = 0.0f, growth_ = 0.0f;  ///< how far the rays are apart at t = 0, and by how much more with t
};

}  // namespace
}  // namespace raylab::bvh
