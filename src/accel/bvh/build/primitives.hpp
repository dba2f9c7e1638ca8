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

/// Grows the box of a triangle of that size, or of a sphere (size 0), so that every ray that the primitive's test
/// accepts meets the box. The test errs by rounding coordinates relative to the ray's origin: by a few ulp of the
/// distance, which the box test allows for, and of the triangle's size.
void grow(Primitive& p, float size);

struct Primitives {
  HugeArray<Primitive> all;  ///< the valid ones first, then room for more
  std::size_t count = 0;     ///< of the valid ones
};

/// The valid primitives in the order of their ids, with room for `spare` times as many more.
Primitives collect_primitives(const Geometry& geometry, double spare);

}  // namespace raylab::bvh
