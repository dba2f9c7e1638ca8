// Shading normals made from faces.
#include <algorithm>
#include <cmath>

#include "catch.hpp"
#include "geometry/smooth_normals.hpp"
#include "raylab/measure/shapes.hpp"

using namespace raylab;

namespace {

/// Two unit squares that share an edge along z and meet at an angle, each with vertices of its own.
TriangleMesh folded(double degrees) {
  const double angle = degrees * 3.14159265358979 / 180.0;
  const vec3 away(static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)), 0.0f);
  TriangleMesh mesh;
  mesh.positions = {{-1, 0, 0}, {-1, 0, 1}, {0, 0, 1}, {0, 0, 0}, {0, 0, 0}, {0, 0, 1}, away + vec3(0, 0, 1), away};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
  return mesh;
}

vec3 corner_normal(const TriangleMesh& mesh, std::uint32_t triangle, int corner) {
  return mesh.normals[mesh.normal_corners(triangle)[corner]];
}

}  // namespace

TEST_CASE("faces that meet at less than the crease are smooth, and others keep their edge", "[unit]") {
  TriangleMesh mesh = folded(20.0);
  smooth_normals(mesh, 30.0f);
  const vec3 shared = corner_normal(mesh, 1, 1);
  CHECK(shared == corner_normal(mesh, 2, 1));
  CHECK(glm::dot(shared, corner_normal(mesh, 0, 0)) < 0.999f);
  CHECK(corner_normal(mesh, 0, 0) == vec3(0, 1, 0));
  smooth_normals(mesh, 10.0f);
  CHECK(mesh.normals.empty());
  CHECK(mesh.normal_indices.empty());
}

TEST_CASE("an edge of three faces stays sharp", "[unit]") {
  TriangleMesh mesh = folded(20.0);
  mesh.positions.emplace_back(0.0f, 1.0f, 0.5f);
  mesh.triangles.emplace_back(3u, 2u, 8u);
  mesh.triangles[1] = {0, 2, 3};
  smooth_normals(mesh, 30.0f);
  CHECK(mesh.normals.empty());
}

TEST_CASE("faces without area and faces that cancel leave finite unit normals", "[unit]") {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 1}, {0, 1, 3}, {1, 1, 1}};
  smooth_normals(mesh, 180.0f);
  for (const vec3& n : mesh.normals) CHECK(std::abs(glm::length(n) - 1.0f) < 1e-6f);
}

TEST_CASE("the normals of a sphere's triangles are the sphere's", "[unit]") {
  TriangleMesh mesh = icosphere(vec3(0.0f), 1.0f, 3);
  smooth_normals(mesh, 40.0f);
  REQUIRE(mesh.normals.size() > 0);
  float worst = 1.0f;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      worst =
          std::min(worst, glm::dot(corner_normal(mesh, i, c), glm::normalize(mesh.positions[mesh.triangles[i][c]])));
    }
  }
  CHECK(worst > 0.9999f);
}

TEST_CASE("a vertex of a fan inscribed in a sphere has the sphere's normal, however uneven the fan", "[unit]") {
  // Which is what the weights are for (Max 1999, "Weights for Computing Vertex Normals from Facet Normals").
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 1}};
  const double down[] = {0.1, 0.9, 0.3, 1.2, 0.5}, around[] = {0.0, 0.5, 2.0, 3.5, 4.6};
  for (int i = 0; i < 5; ++i) {
    mesh.positions.emplace_back(std::sin(down[i]) * std::cos(around[i]), std::sin(down[i]) * std::sin(around[i]),
                                std::cos(down[i]));
    mesh.triangles.emplace_back(0, 1 + i, 1 + (i + 1) % 5);
  }
  smooth_normals(mesh, 180.0f);
  for (std::uint32_t i = 0; i < 5; ++i) CHECK(corner_normal(mesh, i, 0).z > 1.0f - 1e-6f);
}
