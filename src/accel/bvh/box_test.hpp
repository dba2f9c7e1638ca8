#pragma once
// One ray against the boxes of a node, over whatever vectors the including file has chosen (simd_*.hpp). All of it is
// local to that file, and calls no inline function of a shared header: see layout.hpp.
#include <immintrin.h>

#include "kernel.hpp"

namespace raylab::bvh {
namespace {

constexpr float kGrow = 1.0f + 0x1p-20f;
constexpr float kShrink = 1.0f - 0x1p-20f;

/// x, y and z, and in the last lane something else.
inline __m128 load_direction(const KernelRay& ray) { return _mm_load_ps(ray.direction); }

/// The slab test of a ray against all children of a node. A child is hit unless the ray certainly misses it: the
/// near planes are taken a little nearer and the far planes a little farther than computed (Ize 2013, JCGT 2:2;
/// the factors also cover the rounding of the triangle test). A direction of 0 has an infinite reciprocal; where
/// that gives NaN, the origin is in the plane; then max and min drop that bound, or another of the same side too.
template <class Vector>
class BoxTest {
 public:
  static constexpr int width = Vector::lanes;

  explicit BoxTest(const KernelRay& ray) : t_min_(ray.t_min) {
    const __m128 direction = load_direction(ray);
    const __m128 reciprocal = _mm_div_ps(_mm_set1_ps(1.0f), direction);
    _mm_store_ps(origin_, _mm_load_ps(ray.origin));
    _mm_store_ps(to_near_, _mm_mul_ps(reciprocal, _mm_set1_ps(kShrink)));
    _mm_store_ps(to_far_, _mm_mul_ps(reciprocal, _mm_set1_ps(kGrow)));
    octant_ = _mm_movemask_ps(direction) & 7;
    for (int axis = 0; axis < 3; ++axis)
      near_plane_[axis] = static_cast<std::uint32_t>(2 * axis + (octant_ >> axis & 1)) * kPlaneBytes;
  }

  int octant() const { return octant_; }

  void operator()(const Node<width>& node, Vector limit, Vector& near, Vector& far) const {
    const Vector x = plane(node, 0, 0) * Vector::splat(to_near_[0]);
    const Vector y = plane(node, 1, 0) * Vector::splat(to_near_[1]);
    const Vector z = plane(node, 2, 0) * Vector::splat(to_near_[2]);
    const Vector far_x = plane(node, 0, 1) * Vector::splat(to_far_[0]);
    const Vector far_y = plane(node, 1, 1) * Vector::splat(to_far_[1]);
    const Vector far_z = plane(node, 2, 1) * Vector::splat(to_far_[2]);
    near = max(max(x, y), max(z, Vector::splat(t_min_)));
    far = min(min(far_x, far_y), min(far_z, limit));
  }

 private:
  Vector plane(const Node<width>& node, int axis, int far) const {
    const char* const planes = reinterpret_cast<const char*>(node.planes);
    const std::uint32_t at = far != 0 ? near_plane_[axis] ^ kPlaneBytes : near_plane_[axis];
    return Vector::load(reinterpret_cast<const float*>(planes + at)) - Vector::splat(origin_[axis]);
  }
  static constexpr std::uint32_t kPlaneBytes = width * sizeof(float);

  alignas(16) float origin_[4], to_near_[4], to_far_[4];  // the last of each is not used
  float t_min_;
  std::uint32_t near_plane_[3];  ///< in bytes from the first
  int octant_;
};

}  // namespace
}  // namespace raylab::bvh
