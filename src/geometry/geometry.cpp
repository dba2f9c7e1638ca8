#include "raylab/geometry/geometry.hpp"

#include <cmath>

namespace raylab {

namespace {

template <class T>
std::size_t array_bytes(const std::vector<T>& v) {
  return v.capacity() * sizeof(T);
}

bool usable(const vec3& p) {
  // Written so that NaN fails.
  return std::abs(p.x) <= kLargestCoordinate && std::abs(p.y) <= kLargestCoordinate &&
         std::abs(p.z) <= kLargestCoordinate;
}

}  // namespace

std::size_t TriangleMesh::bytes() const {
  return array_bytes(positions) + array_bytes(triangles) + array_bytes(normals) + array_bytes(normal_indices) +
         array_bytes(texcoords) + array_bytes(texcoord_indices);
}

std::size_t Geometry::triangle_count() const {
  std::size_t count = 0;
  for (const TriangleMesh& mesh : meshes) count += mesh.triangles.size();
  return count;
}

Bounds Geometry::bounds() const {
  Bounds all;
  for_each_valid_primitive(*this, [&](const PrimitiveId& id) { all.extend(primitive_bounds(*this, id)); });
  return all;
}

std::size_t Geometry::bytes() const {
  std::size_t total = array_bytes(spheres);
  for (const TriangleMesh& mesh : meshes) total += mesh.bytes();
  return total;
}

bool is_valid_triangle(const TriangleMesh& mesh, std::uint32_t triangle) {
  const uvec3& i = mesh.triangles[triangle];
  const std::size_t n = mesh.positions.size();
  return i.x < n && i.y < n && i.z < n && usable(mesh.positions[i.x]) && usable(mesh.positions[i.y]) &&
         usable(mesh.positions[i.z]);
}

bool is_valid_sphere(const Sphere& sphere) {
  // A denormal radius would be positive or zero depending on the thread's flags.
  constexpr float smallest = std::numeric_limits<float>::min();
  return usable(sphere.center) && sphere.radius >= smallest && sphere.radius <= kLargestCoordinate;
}

std::vector<PrimitiveId> valid_primitives(const Geometry& geometry) {
  std::vector<PrimitiveId> valid;
  valid.reserve(geometry.primitive_count());
  for_each_valid_primitive(geometry, [&](const PrimitiveId& id) { valid.push_back(id); });
  return valid;
}

Bounds primitive_bounds(const Geometry& geometry, const PrimitiveId& id) {
  if (geometry.is_sphere(id.geometry)) return sphere_bounds(geometry.spheres[id.primitive]);
  return triangle_bounds(triangle_corners(geometry.meshes[id.geometry], id.primitive));
}

Bounds sphere_bounds(const Sphere& sphere) {
  Bounds b{sphere.center - sphere.radius, sphere.center + sphere.radius};
  for (int axis = 0; axis < 3; ++axis) {
    b.lower[axis] = next_float_down(b.lower[axis]);
    b.upper[axis] = next_float_up(b.upper[axis]);
  }
  return b;
}

}  // namespace raylab
