#include "primitives.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "raylab/core/parallel.hpp"

namespace raylab::bvh {

namespace {

constexpr std::size_t kChunk = 16384;

bool make_primitive(const Geometry& geometry, const PrimitiveId& id, Primitive& out) {
  out.geometry = id.geometry;
  out.primitive = id.primitive;
  Bounds b;
  float size = 0.0f;
  if (geometry.is_sphere(id.geometry)) {
    const Sphere& sphere = geometry.spheres[id.primitive];
    if (!is_valid_sphere(sphere)) return false;
    b = sphere_bounds(sphere);
  } else {
    const TriangleMesh& mesh = geometry.meshes[id.geometry];
    if (!is_valid_triangle(mesh, id.primitive)) return false;
    b = triangle_bounds(triangle_corners(mesh, id.primitive));
    size = max_component(b.diagonal());
  }
  out.lower = b.lower;
  out.upper = b.upper;
  grow(out, size);
  return true;
}

}  // namespace

void grow(Primitive& p, float size) {
  for (int axis = 0; axis < 3; ++axis) {
    p.lower[axis] -= size * 0x1p-21f + std::abs(p.lower[axis]) * 0x1p-23f;
    p.upper[axis] += size * 0x1p-21f + std::abs(p.upper[axis]) * 0x1p-23f;
  }
}

Primitives collect_primitives(const Geometry& geometry, double spare) {
  struct Chunk {
    std::uint32_t geometry;
    std::size_t first, count;
    std::size_t target;
    std::size_t valid = 0;
  };
  std::vector<Chunk> chunks;
  std::size_t total = 0;
  for (std::uint32_t g = 0; g <= geometry.sphere_geometry(); ++g) {
    const std::size_t size = geometry.is_sphere(g) ? geometry.spheres.size() : geometry.meshes[g].triangles.size();
    for (std::size_t first = 0; first < size; first += kChunk) {
      const std::size_t count = std::min(kChunk, size - first);
      chunks.push_back({g, first, count, total});
      total += count;
    }
  }
  Primitives primitives{HugeArray<Primitive>(total + static_cast<std::size_t>(spare * static_cast<double>(total))), 0};
  Primitive* const all = primitives.all.data();
  parallel_for(chunks.size(), [&](std::size_t c) {
    Chunk& chunk = chunks[c];
    Primitive* out = all + chunk.target;
    for (std::size_t i = chunk.first; i < chunk.first + chunk.count; ++i) {
      if (make_primitive(geometry, {chunk.geometry, static_cast<std::uint32_t>(i)}, *out)) ++out;
    }
    chunk.valid = static_cast<std::size_t>(out - all) - chunk.target;
  });
  for (const Chunk& chunk : chunks) {
    if (primitives.count != chunk.target) std::copy_n(all + chunk.target, chunk.valid, all + primitives.count);
    primitives.count += chunk.valid;
  }
  return primitives;
}

}  // namespace raylab::bvh
