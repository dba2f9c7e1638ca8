#include "raster_geometry.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <unordered_map>
#include <unordered_set>

namespace raylab {

namespace {

using Corners = std::array<std::uint32_t, 3>;  // of a triangle, or the three indices of one corner

struct CornersHash {
  std::size_t operator()(const Corners& c) const {
    std::uint64_t h = 0x9e3779b97f4a7c15u;
    for (const std::uint32_t x : c) h = (h ^ x) * 0xff51afd7ed558ccdu, h ^= h >> 32;
    return h;
  }
};

using ByMaterial = std::map<std::uint32_t, std::vector<Corners>>;

/// Adds the mesh's vertices, one for each distinct (position, normal, texture coordinates).
void add_mesh(const Scene& scene, std::uint32_t id, RasterGeometry& out, ByMaterial& triangles) {
  const TriangleMesh& mesh = scene.geometry.meshes[id];
  const bool shared = (mesh.normals.empty() || mesh.normal_indices.empty()) &&
                      (mesh.texcoords.empty() || mesh.texcoord_indices.empty());
  const auto vertex = [&](std::uint32_t p, std::uint32_t n, std::uint32_t t) {
    return RasterVertex{mesh.positions[p], mesh.normals.empty() ? vec3(0.0f) : mesh.normals[n],
                        mesh.texcoords.empty() ? vec2(0.0f) : mesh.texcoords[t]};
  };
  const auto base = static_cast<std::uint32_t>(out.vertices.size());
  if (shared) {
    for (std::uint32_t i = 0; i < mesh.positions.size(); ++i) out.vertices.push_back(vertex(i, i, i));
  }
  std::unordered_map<Corners, std::uint32_t, CornersHash> known;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    if (!is_valid_triangle(mesh, i)) continue;
    Corners corners;
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t p = mesh.triangles[i][k];
      if (shared) {
        corners[k] = base + p;
        continue;
      }
      const std::uint32_t n = mesh.normals.empty() ? 0 : mesh.normal_corners(i)[k];
      const std::uint32_t t = mesh.texcoords.empty() ? 0 : mesh.texcoord_corners(i)[k];
      const auto [entry, is_new] = known.try_emplace({p, n, t}, static_cast<std::uint32_t>(out.vertices.size()));
      if (is_new) out.vertices.push_back(vertex(p, n, t));
      corners[k] = entry->second;
    }
    triangles[scene.mesh_materials[id].of(i)].push_back(corners);
  }
}

/// For each vertex of a mesh, whose vertices are those from `begin` on, the first one of the mesh in its grid
/// cell.
std::vector<std::uint32_t> clusters(const std::vector<RasterVertex>& vertices, std::uint32_t begin, float cell) {
  std::unordered_map<Corners, std::uint32_t, CornersHash> first;
  std::vector<std::uint32_t> of(vertices.size());
  for (std::uint32_t i = begin; i < vertices.size(); ++i) {
    Corners key;
    // The bits of the number, since it may be more than an integer can hold, or none; those of -0 are those of 0.
    for (int k = 0; k < 3; ++k)
      key[k] = std::bit_cast<std::uint32_t>(std::floor(vertices[i].position[k] / cell) + 0.0f);
    of[i] = first.try_emplace(key, i).first->second;
  }
  return of;
}

std::vector<Corners> clustered(const std::vector<Corners>& triangles, const std::vector<std::uint32_t>& cluster) {
  std::unordered_set<Corners, CornersHash> seen;
  std::vector<Corners> kept;
  for (const Corners& t : triangles) {
    Corners c{cluster[t[0]], cluster[t[1]], cluster[t[2]]};
    if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) continue;
    std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
    if (seen.insert(c).second) kept.push_back(c);
  }
  return kept;
}

void add_draw(std::uint32_t material, const std::vector<Corners>& triangles, RasterGeometry& out,
              std::vector<RasterDraw>& draws) {
  const auto first = static_cast<std::uint32_t>(out.indices.size());
  for (const Corners& t : triangles) out.indices.insert(out.indices.end(), t.begin(), t.end());
  draws.push_back({material, first, static_cast<std::uint32_t>(3 * triangles.size())});
}

/// Edge of a grid cell at which a surface of this area has about so many triangles: two to a cell's face.
float cell_for(const std::vector<RasterVertex>& vertices, const ByMaterial& triangles, std::size_t most) {
  double area = 0.0;
  for (const auto& [material, list] : triangles) {
    for (const Corners& t : list) {
      const dvec3 p(vertices[t[0]].position);
      area += 0.5 * glm::length(glm::cross(dvec3(vertices[t[1]].position) - p, dvec3(vertices[t[2]].position) - p));
    }
  }
  return static_cast<float>(std::sqrt(2.0 * area / static_cast<double>(most)));
}

}  // namespace

std::size_t RasterGeometry::coarse_triangles() const {
  std::size_t count = 0;
  for (const RasterDraw& draw : coarse) count += draw.count / 3;
  return count;
}

RasterGeometry raster_geometry(const Scene& scene, std::size_t most_coarse) {
  RasterGeometry out;
  std::vector<std::pair<std::uint32_t, std::vector<Corners>>> coarse;
  const bool simplify = scene.geometry.triangle_count() > most_coarse;
  ByMaterial all;
  for (std::uint32_t id = 0; id < scene.geometry.meshes.size(); ++id) {
    ByMaterial triangles;
    const auto begin = static_cast<std::uint32_t>(out.vertices.size());
    add_mesh(scene, id, out, triangles);
    std::size_t count = 0;
    for (const auto& [material, list] : triangles) count += list.size();
    // Small meshes beside a large one, such as a plinth, cost little and would suffer most.
    const bool large = simplify && count > most_coarse / 8;
    std::vector<std::uint32_t> cluster;
    if (large) cluster = clusters(out.vertices, begin, cell_for(out.vertices, triangles, most_coarse));
    for (auto& [material, list] : triangles) {
      coarse.emplace_back(material, large ? clustered(list, cluster) : list);
      auto& whole = all[material];
      whole.insert(whole.end(), list.begin(), list.end());
    }
  }
  for (const auto& [material, list] : all) add_draw(material, list, out, out.full);
  if (!simplify) {
    out.coarse = out.full;
  } else {
    for (const auto& [material, list] : coarse) add_draw(material, list, out, out.coarse);
  }
  return out;
}

}  // namespace raylab
