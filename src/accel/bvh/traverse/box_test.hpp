#pragma once
// Rays against the boxes of a node. Local to the including file, as all of the traversal is: see core/simd/lanes.hpp.
#include "core/simd/permutation.hpp"
#include "geometry/slab_test.hpp"
#include "kernel.hpp"

namespace raylab::bvh {
namespace {

/// One ray against all children of a node.
class BoxTest {
 public:
  explicit BoxTest(const TraversalRay& ray) : t_min_(ray.t_min()) {
    const Float<4> direction = Float<4>::load(ray.direction);
    const Float<4> reciprocal = Float<4>(1.0f) / direction;
    Float<4>::load(ray.origin).store(origin_);
    (reciprocal * Float<4>(kShrink)).store(to_near_);
    (reciprocal * Float<4>(kGrow)).store(to_far_);
    octant_ = static_cast<int>(sign_bits(direction) & 7u);
    for (int axis = 0; axis < 3; ++axis)
      near_plane_[axis] = static_cast<std::uint32_t>(2 * axis + (octant_ >> axis & 1)) * kPlaneBytes;
  }

  /// Bit a set: component a of the direction is negative.
  int octant() const { return octant_; }

  SlabInterval<Float<kWidth>> operator()(const Node& node, Float<kWidth> limit) const {
    using F = Float<kWidth>;
    const auto three = [](const float(&v)[4]) { return Vec3<F>(F(v[0]), F(v[1]), F(v[2])); };
    const SlabPlanes<F> planes{{plane(node, 0, 0), plane(node, 1, 0), plane(node, 2, 0)},
                               {plane(node, 0, 1), plane(node, 1, 1), plane(node, 2, 1)}};
    return slab_interval<F>({three(origin_), three(to_near_), three(to_far_)}, planes, F(t_min_), limit);
  }

 private:
  Float<kWidth> plane(const Node& node, int axis, int far) const {
    const char* const planes = reinterpret_cast<const char*>(node.planes);
    const std::uint32_t at = far != 0 ? near_plane_[axis] ^ kPlaneBytes : near_plane_[axis];
    return Float<kWidth>::load(reinterpret_cast<const float*>(planes + at));
  }
  static constexpr std::uint32_t kPlaneBytes = kWidth * sizeof(float);

  alignas(16) float origin_[4], to_near_[4], to_far_[4];  // the last of each is not used
  float t_min_;
  std::uint32_t near_plane_[3];  ///< in bytes from the first
  int octant_;
};

/// A packet of rays against one child of a node.
class PacketBoxTest {
 public:
  PacketBoxTest(const WideVec3& origin, const WideVec3& direction) : ray_(slab_ray(origin, reciprocal_of(direction))) {
    // By the sign of the reciprocal, -0 being downwards.
    down_x_ = ray_.to_near.x < Wide(0.0f);
    down_y_ = ray_.to_near.y < Wide(0.0f);
    down_z_ = ray_.to_near.z < Wide(0.0f);
  }

  int octant(int lane) const {
    return static_cast<int>((down_x_.bits() >> lane & 1u) | (down_y_.bits() >> lane & 1u) << 1 |
                            (down_z_.bits() >> lane & 1u) << 2);
  }

  SlabInterval<Wide> operator()(const Node& node, int child, Wide t_min, Wide limit) const {
    const auto plane = [&](int i) { return Wide(node.planes[i][child]); };
    const Wide lower_x = plane(0), upper_x = plane(1), lower_y = plane(2), upper_y = plane(3), lower_z = plane(4),
               upper_z = plane(5);
    const SlabPlanes<Wide> planes{
        {select(down_x_, upper_x, lower_x), select(down_y_, upper_y, lower_y), select(down_z_, upper_z, lower_z)},
        {select(down_x_, lower_x, upper_x), select(down_y_, lower_y, upper_y), select(down_z_, lower_z, upper_z)}};
    return slab_interval(ray_, planes, t_min, limit);
  }
  /// The same where all rays that count are of one octant: no lane has planes of its own.
  SlabInterval<Wide> in_octant(int octant, const Node& node, int child, Wide t_min, Wide limit) const {
    const int x = octant & 1, y = 2 | (octant >> 1 & 1), z = 4 | octant >> 2;
    const auto plane = [&](int i) { return Wide(node.planes[i][child]); };
    return slab_interval<Wide>(ray_, {{plane(x), plane(y), plane(z)}, {plane(x ^ 1), plane(y ^ 1), plane(z ^ 1)}},
                               t_min, limit);
  }

 private:
  static WideVec3 reciprocal_of(const WideVec3& d) { return {Wide(1.0f) / d.x, Wide(1.0f) / d.y, Wide(1.0f) / d.z}; }

  SlabRay<Wide> ray_;
  WideMask down_x_, down_y_, down_z_;
};

}  // namespace
}  // namespace raylab::bvh
