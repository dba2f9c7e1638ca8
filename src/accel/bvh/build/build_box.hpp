#pragma once
// Boxes in vectors, and their costs, for the search for splits.
#include <emmintrin.h>

#include <algorithm>
#include <cstdint>

#include "primitives.hpp"

namespace raylab::bvh {

inline __m128 load(const vec3& v) { return _mm_load_ps(&v.x); }  // of a Primitive or BinaryNode: 16 bytes, aligned

struct Box {
  __m128 lower = _mm_set1_ps(kInfinity);
  __m128 upper = _mm_set1_ps(-kInfinity);

  void extend(__m128 point) {
    lower = _mm_min_ps(lower, point);
    upper = _mm_max_ps(upper, point);
  }
  void extend(const Box& box) {
    lower = _mm_min_ps(lower, box.lower);
    upper = _mm_max_ps(upper, box.upper);
  }
  void extend(const Primitive& p) {
    lower = _mm_min_ps(lower, load(p.lower));
    upper = _mm_max_ps(upper, load(p.upper));
  }
};

inline bool is_empty(const Box& box) { return (_mm_movemask_ps(_mm_cmplt_ps(box.upper, box.lower)) & 7) != 0; }

/// Of areas relative to the largest side of a box, so that the squares stay in the range of float.
inline __m128 area_scale(const Box& box) {
  alignas(16) float extent[4];
  _mm_store_ps(extent, _mm_sub_ps(box.upper, box.lower));
  return _mm_set1_ps(1.0f / std::max(extent[0], std::max(extent[1], extent[2])));
}

/// Half the area of a box whose sides are multiplied by `scale`; not a number if it is empty.
inline float scaled_area(const Box& box, __m128 scale) {
  alignas(16) float d[4];
  _mm_store_ps(d, _mm_mul_ps(_mm_sub_ps(box.upper, box.lower), scale));
  return d[0] * (d[1] + d[2]) + d[1] * d[2];
}

/// Twice the centre.
inline __m128 center(const Primitive& p) { return _mm_add_ps(load(p.lower), load(p.upper)); }

/// Cost of testing n primitives that one leaf or several hold.
inline float leaf_cost(std::uint32_t n) { return static_cast<float>((n + 7) / 8); }

}  // namespace raylab::bvh
