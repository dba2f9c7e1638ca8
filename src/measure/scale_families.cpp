#include "raylab/measure/scale_families.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "raylab/core/error.hpp"
#include "raylab/measure/ray_sets.hpp"
#include "raylab/measure/shapes.hpp"

namespace raylab {

namespace {

constexpr std::array<std::string_view, 5> kNames{"soup", "sphere", "terrain", "thin", "stadium"};

/// The icosphere whose number of triangles comes closest, by ratio.
TriangleMesh sphere_of(std::size_t triangles, const vec3& center, float radius) {
  const double levels = std::log(static_cast<double>(triangles) / 20.0) / std::log(4.0);
  return icosphere(center, radius, std::max(0, static_cast<int>(std::lround(levels))));
}

/// A square grid of cells, two triangles each, over [-half, half]² with heights from `height(x, z)`.
template <class Height>
TriangleMesh height_field(std::size_t triangles, float half, const Height& height) {
  const auto cells =
      static_cast<std::uint32_t>(std::max(1.0, std::round(std::sqrt(static_cast<double>(triangles) / 2.0))));
  TriangleMesh mesh;
  for (std::uint32_t j = 0; j <= cells; ++j) {
    for (std::uint32_t i = 0; i <= cells; ++i) {
      const float x = half * (2.0f * static_cast<float>(i) / static_cast<float>(cells) - 1.0f);
      const float z = half * (2.0f * static_cast<float>(j) / static_cast<float>(cells) - 1.0f);
      mesh.positions.emplace_back(x, height(x, z), z);
    }
  }
  for (std::uint32_t j = 0; j < cells; ++j) {
    for (std::uint32_t i = 0; i < cells; ++i) {
      const std::uint32_t a = j * (cells + 1) + i;
      const std::uint32_t b = a + cells + 1;
      mesh.triangles.emplace_back(a, b, a + 1);
      mesh.triangles.emplace_back(a + 1, b, b + 1);
    }
  }
  mesh.pad_positions();
  return mesh;
}

/// Hills upon hills, each half as high and twice as dense as the one below.
float hills(float x, float z) {
  float height = 0.0f;
  float size = 0.2f;
  for (float frequency = 3.0f; frequency < 400.0f; frequency *= 2.0f, size *= 0.5f) {
    height += size * std::sin(frequency * x + 1.3f * frequency) * std::sin(frequency * z - 0.7f * frequency);
  }
  return height;
}

TriangleMesh thin_triangles(std::size_t count, std::uint64_t seed) {
  constexpr float kWidth = 1e-4f;
  UniformFloats uniform(seed);
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < count; ++i) {
    const vec3 start = uniform.in_box(vec3(-1.0f), vec3(1.0f));
    const vec3 along = glm::normalize(uniform.in_box(vec3(-1.0f), vec3(1.0f)) + vec3(1e-3f));
    const vec3 aside =
        glm::cross(along, glm::normalize(uniform.in_box(vec3(-1.0f), vec3(1.0f)) + vec3(0.0f, 0.0f, 1e-3f)));
    mesh.positions.insert(mesh.positions.end(), {start, start + along, start + kWidth * aside});
    mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
  }
  mesh.pad_positions();
  return mesh;
}

}  // namespace

std::span<const std::string_view> scale_family_names() { return kNames; }

ScaleFamily make_scale_family(std::string_view name, std::size_t triangles, std::size_t rays, std::uint64_t seed) {
  triangles = std::max<std::size_t>(triangles, 100);
  ScaleFamily family;
  auto& meshes = family.geometry.meshes;
  Bounds detail;
  if (name == "soup") {
    // Edges as long as the mean distance to the next triangle: some overlap, most do not.
    const float size = 2.0f / std::cbrt(static_cast<float>(triangles));
    meshes.push_back(triangle_soup(triangles, 1.0f, size, seed));
  } else if (name == "sphere") {
    meshes.push_back(sphere_of(triangles, vec3(0.0f), 1.0f));
  } else if (name == "terrain") {
    meshes.push_back(height_field(triangles, 1.0f, hills));
  } else if (name == "thin") {
    meshes.push_back(thin_triangles(triangles, seed));
  } else if (name == "stadium") {
    constexpr std::size_t kBowl = 200;
    constexpr float kHalf = 1000.0f;
    meshes.push_back(height_field(kBowl, kHalf, [](float x, float z) { return (x * x + z * z) / (4.0f * kHalf); }));
    meshes.push_back(sphere_of(triangles, vec3(0.0f, 1.0f, 0.0f), 1.0f));
    detail.extend(vec3(-1.0f, 0.0f, -1.0f));
    detail.extend(vec3(1.0f, 2.0f, 1.0f));
  } else {
    throw Error(ErrorKind::usage, "--family",
                "unknown family \"" + std::string(name) + "\"; expected soup, sphere, terrain, thin or stadium");
  }
  const std::size_t aimed = detail.empty() ? 0 : rays / 2;
  family.rays = random_rays(family.geometry.bounds(), rays - aimed, seed);
  if (aimed > 0) {
    const std::vector<Ray> more = random_rays(detail, aimed, seed + 1);
    family.rays.insert(family.rays.end(), more.begin(), more.end());
  }
  return family;
}

}  // namespace raylab
