#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "raylab/geometry/geometry.hpp"
#include "raylab/scene/scene.hpp"

namespace raylab {

/// A mesh from an OBJ file with the materials of its MTL files.
struct ObjMesh {
  TriangleMesh mesh;
  std::vector<Material> materials;             ///< as read; Texture::image indexes `textures`
  std::vector<TextureImage> textures;
  std::vector<std::uint16_t> triangle_materials;  ///< index into `materials` of each triangle; empty: all 0
  std::vector<std::string> warnings;           ///< "file:line: message"
  std::vector<std::string> notes;              ///< how each material was understood
  std::vector<std::filesystem::path> files;    ///< every file read, for the scene hash
};

struct ObjOptions {
  bool ignore_materials = false;  ///< the scene gives the material: MTL files are not read
};

/// Reads an OBJ file and its MTL files and textures. Polygons become triangles (concave ones too). Indices that
/// are out of range or vertices that are not finite are errors with file:line. Throws Error (input).
ObjMesh read_obj(const std::filesystem::path& file, const ObjOptions& options = {});

}  // namespace raylab
