// What the raster view draws of a scene.
#include "raster_geometry.hpp"

#include "../catch.hpp"

using namespace raylab;

TEST_CASE("while moving, large meshes are drawn with fewer triangles over the same surface", "[unit][preview]") {
  Scene scene;
  TriangleMesh grid;  // 100 x 100 squares of a bowl
  constexpr std::uint32_t n = 100;
  for (std::uint32_t y = 0; y <= n; ++y) {
    for (std::uint32_t x = 0; x <= n; ++x) {
      const vec2 at(static_cast<float>(x) / n, static_cast<float>(y) / n);
      grid.positions.emplace_back(at.x, at.y, at.x * at.x + at.y * at.y);
    }
  }
  for (std::uint32_t y = 0; y < n; ++y) {
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t i = y * (n + 1) + x;
      grid.triangles.emplace_back(i, i + 1, i + n + 2);
      grid.triangles.emplace_back(i, i + n + 2, i + n + 1);
    }
  }
  grid.triangles.emplace_back(0, 1, 99999999);  // invalid: left out
  scene.geometry.meshes.push_back(grid);
  scene.mesh_materials.resize(1);
  const RasterGeometry full = raster_geometry(scene, 100000);
  REQUIRE(full.full.size() == 1);
  CHECK(full.full[0].count == 3 * 2 * n * n);
  CHECK(full.coarse_triangles() == 2 * n * n);
  const RasterGeometry few = raster_geometry(scene, 1000);
  CHECK(few.full[0].count == 3 * 2 * n * n);
  CHECK(few.coarse_triangles() > 300);
  CHECK(few.coarse_triangles() < 3000);
  double area = 0.0;
  for (const RasterDraw& draw : few.coarse) {
    for (std::uint32_t i = draw.first; i < draw.first + draw.count; i += 3) {
      const auto p = [&](std::uint32_t k) { return few.vertices[few.indices[i + k]].position; };
      area += 0.5 * glm::cross(p(1) - p(0), p(2) - p(0)).z;  // seen from above, signed
    }
  }
  CHECK(area > 0.85);  // of the square: no holes, nothing twice
  CHECK(area < 1.001);

  // The same once more as another mesh, and one of no area: each keeps to its own vertices.
  scene.geometry.meshes.push_back(grid);
  for (vec3& p : grid.positions) p = vec3(p.x, 0.0f, 0.0f);
  scene.geometry.meshes.push_back(grid);
  scene.mesh_materials = {{0, {}}, {1, {}}, {2, {}}};
  const RasterGeometry three = raster_geometry(scene, 1000);
  REQUIRE(three.coarse.size() == 3);
  CHECK(three.coarse[1].count == three.coarse[0].count);
  CHECK(three.coarse[2].count == 0);
  int foreign = 0;
  for (const RasterDraw& draw : three.coarse) {
    for (std::uint32_t i = draw.first; i < draw.first + draw.count; ++i) {
      foreign += three.indices[i] / ((n + 1) * (n + 1)) != draw.material;
    }
  }
  CHECK(foreign == 0);
}
