#pragma once
#include <algorithm>
#include <cstdlib>

#include "raylab/geometry/geometry.hpp"

namespace raylab::fuzz {

/// Ends the program when an index of the mesh leads nowhere or a position is not finite.
inline void check_mesh(const TriangleMesh& mesh) {
  const auto check = [](const std::vector<uvec3>& indices, std::size_t count) {
    for (const uvec3& i : indices) {
      if (std::max({i.x, i.y, i.z}) >= count) std::abort();
    }
  };
  check(mesh.triangles, mesh.positions.size());
  if (!mesh.normals.empty())
    check(mesh.normal_indices.empty() ? mesh.triangles : mesh.normal_indices, mesh.normals.size());
  if (!mesh.texcoords.empty())
    check(mesh.texcoord_indices.empty() ? mesh.triangles : mesh.texcoord_indices, mesh.texcoords.size());
  for (const vec3& p : mesh.positions) {
    if (!is_finite(p)) std::abort();
  }
}

}  // namespace raylab::fuzz
