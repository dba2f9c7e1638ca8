#pragma once
// The primitives of a geometry as the builder sees them.
#include <cstddef>
#include <cstdint>

#include "huge_array.hpp"
#include "raylab/accel/accelerator.hpp"
#include "raylab/core/bounds.hpp"

namespace raylab::bvh {

/// A primitive while the tree is built: its conservative bounds and its id.
struct alignas(16) Primitive {
  vec3 lower;
  std::uint32_t geometry;
  vec3 upper;
  std::uint32_t primitive;

  PrimitiveId id() const { return {geometry, primitive}; }
};
static_assert(sizeof(Primitive) == 32);

/// Grows the box of a triangle of that size, or of a sphere (size 0), so that no ray misses it that the test of
/// the primitive lets hit. Where the test is off, it is by the rounding of coordinates relative to the origin of
/// the ray, so by a few units in the last place of the distance, which the box test allows for, and of the size of
/// the triangle.
void grow(Primitive& p, float size);

struct Primitives {
  HugeArray<Primitive> all;  ///< the valid ones first, then room for more
  std::size_t count = 0;     ///< of the valid ones
};

/// The valid primitives in the order of their ids, with room for `spare` times as many more.
Primitives collect_primitives(const Geometry& geometry, double spare);

}  // namespace raylab::bvh
