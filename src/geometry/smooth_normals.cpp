#include "smooth_normals.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/angle.hpp"
#include "point_table.hpp"

namespace raylab {
namespace {

/// For each position the number of its place.
std::vector<std::uint32_t> places(const std::vector<vec3>& positions) {
  std::vector<vec3> distinct;
  distinct.reserve(positions.size());
  PointTable table(distinct, positions.size());
  std::vector<std::uint32_t> place;
  place.reserve(positions.size());
  for (const vec3& p : positions) place.push_back(table.index_of(p + 0.0f));  // -0 becomes 0
  return place;
}

struct Face {
  dvec3 normal = dvec3(0.0);  ///< unit; zero without area
  std::array<double, 3> weights{};
};

Face face_of(const Triangle& t) {
  const std::array<dvec3, 3> p = {dvec3(t.p0), dvec3(t.p1), dvec3(t.p2)};
  const dvec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
  const double length = glm::length(normal);
  if (!(length > 0.0) || !std::isfinite(length)) return {};
  Face face;
  face.normal = normal / length;
  for (std::size_t c = 0; c < 3; ++c) {
    const dvec3 a = p[(c + 1) % 3] - p[c], b = p[(c + 2) % 3] - p[c];
    face.weights[c] = length / (glm::dot(a, a) * glm::dot(b, b));
  }
  return face;
}

/// A triangle at a vertex.
struct Corner {
  std::uint32_t triangle;
  std::uint32_t at;              ///< 0, 1 or 2
  std::uint32_t next, previous;  ///< the places of the other vertices
  std::uint32_t fan;             ///< corners joined over smooth edges have the same
};

/// Joins the corners of one vertex that share an edge which is smooth.
void find_fans(std::vector<Corner>& corners, const std::vector<Face>& faces, double least_cosine,
               std::vector<std::array<std::uint32_t, 2>>& edges) {
  const auto root = [&](std::uint32_t i) {
    while (corners[i].fan != i) i = corners[i].fan = corners[corners[i].fan].fan;
    return i;
  };
  // The edges of the vertex by their other end: those of one edge come to stand together. `edges` is kept to save
  // allocations.
  edges.clear();
  for (std::uint32_t i = 0; i < corners.size(); ++i) {
    corners[i].fan = i;
    edges.push_back({corners[i].next, i});
    edges.push_back({corners[i].previous, i});
  }
  std::sort(edges.begin(), edges.end());
  for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
    while (end < edges.size() && edges[end][0] == edges[begin][0]) ++end;
    // An edge of more than two faces bounds no smooth surface.
    if (end - begin != 2) continue;
    const std::uint32_t a = edges[begin][1], b = edges[begin + 1][1];
    const dvec3 &n = faces[corners[a].triangle].normal, &m = faces[corners[b].triangle].normal;
    if (glm::dot(n, m) >= least_cosine) corners[root(a)].fan = root(b);
  }
  for (std::uint32_t i = 0; i < corners.size(); ++i) corners[i].fan = root(i);
}

}  // namespace

void smooth_normals(TriangleMesh& mesh, float degrees) {
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  const std::vector<std::uint32_t> vertex = places(mesh.positions);
  std::vector<Face> faces(count);
  std::vector<std::uint32_t> start(mesh.positions.size() + 1, 0);  // of each vertex's corners
  for (std::uint32_t i = 0; i < count; ++i) {
    faces[i] = face_of(triangle_corners(mesh, i));
    for (int c = 0; c < 3; ++c) ++start[vertex[mesh.triangles[i][c]] + 1];
  }
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<std::uint32_t> corner_at(std::size_t{3} * count);  // 3 triangle + corner
  std::vector<std::uint32_t> filled(start.begin(), start.end() - 1);
  for (std::uint32_t i = 0; i < count; ++i) {
    for (std::uint32_t c = 0; c < 3; ++c)
      corner_at[filled[vertex[mesh.triangles[i][static_cast<int>(c)]]]++] = 3 * i + c;
  }

  // A crease of 180 degrees smooths all, rounding included; one of 0 leaves a plane smooth.
  const double cosine = sine_cosine_of_degrees(static_cast<double>(degrees)).cosine;
  const double least_cosine = degrees >= 180.0f ? -2.0 : cosine - 1e-12;
  mesh.normals.clear();
  mesh.normal_indices.assign(count, uvec3(0));
  bool smooth = false;
  std::vector<Corner> corners;
  std::vector<std::array<std::uint32_t, 2>> edges;
  std::vector<dvec3> sums;
  std::vector<double> weights;
  std::vector<std::uint32_t> normal_of_fan;
  for (std::size_t v = 0; v + 1 < start.size(); ++v) {
    corners.clear();
    for (std::uint32_t k = start[v]; k < start[v + 1]; ++k) {
      const std::uint32_t triangle = corner_at[k] / 3, at = corner_at[k] % 3;
      const uvec3& t = mesh.triangles[triangle];
      corners.push_back(
          {triangle, at, vertex[t[static_cast<int>((at + 1) % 3)]], vertex[t[static_cast<int>((at + 2) % 3)]], 0});
    }
    find_fans(corners, faces, least_cosine, edges);
    sums.assign(corners.size(), dvec3(0.0));
    weights.assign(corners.size(), 0.0);
    for (const Corner& c : corners) {
      const Face& face = faces[c.triangle];
      sums[c.fan] += face.weights[c.at] * face.normal;
      weights[c.fan] += face.weights[c.at];
    }
    normal_of_fan.assign(corners.size(), 0xffffffffu);
    for (const Corner& c : corners) {
      const dvec3& own = faces[c.triangle].normal;
      const double length = glm::length(sums[c.fan]);
      // Faces that cancel, or have no area, leave a corner with its own face's normal, or with none that matters.
      const bool cancels = !(length > 1e-6 * weights[c.fan]) || !std::isfinite(length);
      std::uint32_t& index = normal_of_fan[c.fan];
      if (cancels || index == 0xffffffffu) {
        const dvec3 none = own == dvec3(0.0) ? dvec3(0.0, 1.0, 0.0) : own;
        index = static_cast<std::uint32_t>(mesh.normals.size());
        mesh.normals.emplace_back(cancels ? none : sums[c.fan] / length);
      }
      mesh.normal_indices[c.triangle][static_cast<int>(c.at)] = index;
      smooth = smooth || glm::dot(dvec3(mesh.normals[index]), own) < 1.0 - 1e-9;
    }
  }
  if (smooth) return;
  mesh.normals = {};
  mesh.normal_indices = {};
}

}  // namespace raylab
