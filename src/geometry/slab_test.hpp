#pragma once
// Ray against axis-aligned boxes, over the number type F: one ray and a box a lane, or one box and a ray a lane.
#include "core/simd/lanes.hpp"

namespace raylab {
namespace {

/// Factors of the distances to the far and the near planes: a box is hit unless the ray certainly misses it (Ize 2013,
/// "Robust BVH Ray Traversal", JCGT 2:2; they also cover the rounding of the triangle test).
constexpr float kGrow = 1.0f + 0x1p-20f;
constexpr float kShrink = 1.0f - 0x1p-20f;

/// A ray made ready: its origin, and the reciprocals of its direction times the factors. A component of 0 has an
/// infinite reciprocal, which gives NaN where the origin is in the plane; max and min then ignore that bound, perhaps
/// with another one of its side.
template <class F>
struct SlabRay {
  Vec3<F> origin, to_near, to_far;
};
template <class F>
SlabRay<F> slab_ray(const Vec3<F>& origin, const Vec3<F>& reciprocal) {
  return {origin, reciprocal * F(kShrink), reciprocal * F(kGrow)};
}

/// The planes of a box that a ray meets first and last, by axis.
template <class F>
struct SlabPlanes {
  Vec3<F> near, far;
};

template <class F>
struct SlabInterval {
  F near, far;  ///< the box is hit where near <= far
};

/// The part of the interval [t_min, limit] of a ray inside a box.
template <class F>
[[gnu::always_inline]] inline SlabInterval<F> slab_interval(const SlabRay<F>& ray, const SlabPlanes<F>& planes,
                                                            const F& t_min, const F& limit) {
  const Vec3<F> near = (planes.near - ray.origin) * ray.to_near;
  const Vec3<F> far = (planes.far - ray.origin) * ray.to_far;
  return {max(max(near.x, near.y), max(near.z, t_min)), min(min(far.x, far.y), min(far.z, limit))};
}

}  // namespace
}  // namespace raylab
