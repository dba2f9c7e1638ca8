#pragma once
// Boxes in vectors, and their costs, for the search for splits.
#include <algorithm>
#include <cstdint>
#include <cstring>

#include "primitives.hpp"

namespace raylab::bvh {

/// Three coordinates, and a fourth number that is not used.
using Four = float __attribute__((vector_size(16)));
using FourInts = std::int32_t __attribute__((vector_size(16)));

inline Four four(float x) { return Four{} + x; }
inline Four min(Four a, Four b) { return a < b ? a : b; }
inline Four max(Four a, Four b) { return a > b ? a : b; }
inline Four lower_of(const Primitive& p) {
  Four v;
  std::memcpy(&v, &p, sizeof v);
  return v;
}
inline Four upper_of(const Primitive& p) {
  Four v;
  std::memcpy(&v, reinterpret_cast<const char*>(&p) + sizeof v, sizeof v);
  return v;
}

struct Box {
  Four lower = four(kInfinity);
  Four upper = four(-kInfinity);

  void extend(Four point) {
    lower = min(lower, point);
    upper = max(upper, point);
  }
  void extend(const Box& box) {
    lower = min(lower, box.lower);
    upper = max(upper, box.upper);
  }
  void extend(const Primitive& p) {
    lower = min(lower, lower_of(p));
    upper = max(upper, upper_of(p));
  }
};

inline bool is_empty(const Box& box) {
  const FourInts inside_out = box.upper < box.lower;
  return (inside_out[0] | inside_out[1] | inside_out[2]) != 0;
}

/// Of areas relative to the largest side of a box, so that the squares stay in the range of float.
inline Four area_scale(const Box& box) {
  const Four extent = box.upper - box.lower;
  return four(1.0f / std::max(extent[0], std::max(extent[1], extent[2])));
}

/// Half the area of a box whose sides are multiplied by `scale`; not a number if it is empty.
inline float scaled_area(const Box& box, Four scale) {
  const Four d = (box.upper - box.lower) * scale;
  return d[0] * (d[1] + d[2]) + d[1] * d[2];
}

/// Twice the centre.
inline Four center(const Primitive& p) { return lower_of(p) + upper_of(p); }

/// Cost of testing n primitives that one leaf or several hold.
inline float leaf_cost(std::uint32_t n) {
  const std::uint32_t tests = (n + 7) / 8;
  return static_cast<float>(tests);
}

}  // namespace raylab::bvh
