#include "raylab/measure/shapes.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "raylab/measure/ray_sets.hpp"

namespace raylab {

namespace {

/// Index of the vertex halfway between two others, made when first asked for.
class Midpoints {
 public:
  explicit Midpoints(std::vector<dvec3>& points) : points_(points) {}

  std::uint32_t operator()(std::uint32_t a, std::uint32_t b) {
    const auto [entry, is_new] = known_.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(points_.size()));
    if (is_new) points_.push_back(glm::normalize(points_[a] + points_[b]));
    return entry->second;
  }

 private:
  std::vector<dvec3>& points_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> known_;
};

}  // namespace

TriangleMesh icosphere(const vec3& center, float radius, int levels) {
  const double g = (1.0 + std::sqrt(5.0)) / 2.0;
  std::vector<dvec3> points = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                               {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  for (dvec3& p : points) p = glm::normalize(p);
  TriangleMesh mesh;
  mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int level = 0; level < levels; ++level) {
    Midpoints midpoint(points);
    std::vector<uvec3> finer;
    finer.reserve(mesh.triangles.size() * 4);
    for (const uvec3& t : mesh.triangles) {
      const std::uint32_t xy = midpoint(t.x, t.y);
      const std::uint32_t yz = midpoint(t.y, t.z);
      const std::uint32_t zx = midpoint(t.z, t.x);
      finer.insert(finer.end(), {{t.x, xy, zx}, {t.y, yz, xy}, {t.z, zx, yz}, {xy, yz, zx}});
    }
    mesh.triangles = std::move(finer);
  }
  for (const dvec3& p : points) mesh.positions.emplace_back(dvec3(center) + static_cast<double>(radius) * p);
  mesh.pad_positions();
  return mesh;
}

TriangleMesh box_mesh(const vec3& lower, const vec3& upper) {
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < 8; ++i) {
    mesh.positions.emplace_back((i & 1u) ? upper.x : lower.x, (i & 2u) ? upper.y : lower.y,
                                (i & 4u) ? upper.z : lower.z);
  }
  constexpr std::uint32_t kFaces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                          {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& f : kFaces) {
    mesh.triangles.emplace_back(f[0], f[1], f[2]);
    mesh.triangles.emplace_back(f[0], f[2], f[3]);
  }
  mesh.pad_positions();
  return mesh;
}

TriangleMesh triangle_soup(std::size_t count, float extent, float size, std::uint64_t seed) {
  UniformFloats uniform(seed);
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < count; ++i) {
    const vec3 center = uniform.in_box(vec3(-extent), vec3(extent));
    for (int corner = 0; corner < 3; ++corner) {
      mesh.positions.push_back(center + uniform.in_box(vec3(-size / 2), vec3(size / 2)));
    }
    mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
  }
  mesh.pad_positions();
  return mesh;
}

std::vector<Sphere> sphere_soup(std::size_t count, float extent, float radius, std::uint64_t seed) {
  UniformFloats uniform(seed);
  std::vector<Sphere> spheres;
  for (std::size_t i = 0; i < count; ++i) {
    const vec3 center = uniform.in_box(vec3(-extent), vec3(extent));
    spheres.push_back({center, uniform(0.1f * radius, radius)});
  }
  return spheres;
}

}  // namespace raylab
