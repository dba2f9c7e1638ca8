#pragma once
// A scene as flat arrays. It owns no accelerator and no camera: one scene serves several of both in one process.
#include <cstdint>
#include <string>
#include <vector>

#include "raylab/geometry/geometry.hpp"
#include "raylab/scene/environment.hpp"
#include "raylab/scene/material.hpp"

namespace raylab {

/// How a picture is to be made, as a scene file's [render] table says.
struct RenderSettings {
  int width = 800;
  int height = 800;
  int samples_per_pixel = 64;
  int max_depth = 7;  ///< path segments, the camera ray included
};

/// Materials of a mesh: one for each triangle, or one for all.
struct MeshMaterials {
  std::uint32_t common = 0;
  std::vector<std::uint16_t> per_triangle;  ///< empty: `common` for all

  std::uint32_t of(std::uint32_t triangle) const { return per_triangle.empty() ? common : per_triangle[triangle]; }
};

struct Scene {
  std::string name;  ///< for messages and file attributes
  RenderSettings render;
  Environment environment;
  Geometry geometry;
  std::vector<MeshMaterials> mesh_materials;    ///< one for each mesh
  std::vector<std::string> mesh_names;          ///< one for each mesh, for messages
  std::vector<std::uint32_t> sphere_materials;  ///< one for each sphere
  std::vector<Material> materials;
  std::vector<TextureImage> textures;

  std::uint32_t material_of(std::uint32_t geometry_id, std::uint32_t primitive) const {
    return geometry.is_sphere(geometry_id) ? sphere_materials[primitive] : mesh_materials[geometry_id].of(primitive);
  }

  /// Bytes of geometry, material ids and textures.
  std::size_t bytes() const;
};

}  // namespace raylab
