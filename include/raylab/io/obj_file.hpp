#pragma once
#include <compare>
#include <filesystem>
#include <string>
#include <vector>

#include "raylab/geometry/geometry.hpp"
#include "raylab/scene/scene.hpp"

namespace raylab {

/// A mesh from an OBJ file with the materials of its MTL files.
struct ObjMesh {
  TriangleMesh mesh;
  MeshMaterials mesh_materials;              ///< indices into `materials`
  std::vector<Material> materials;           ///< those that faces use; Texture::image indexes `textures`
  std::vector<TextureImage> textures;        ///< those that materials use
  std::vector<std::string> warnings;         ///< "file:line: message"
  std::vector<std::string> notes;            ///< how each material was understood
  std::vector<std::filesystem::path> files;  ///< every file read, for the scene hash
};

struct ObjOptions {
  bool ignore_materials = false;  ///< the scene gives the material: the model's are not read
  bool plain_materials = false;   ///< of MTL files the plain convention alone, also where exporters say more

  auto operator<=>(const ObjOptions&) const = default;
};

/// Reads an OBJ file and the MTL files and textures it uses. Polygons become triangles, concave ones too; faces of
/// fewer than three distinct corners are left out with a warning. A mesh has normals or texture coordinates when
/// some face has; the other faces then get their geometric normal, or (0, 0). Faces without a material, or with
/// one that no MTL file defines, are lambertian grey (0.5); what is missing is named in a warning, and a missing
/// texture is magenta. A corner whose normal or texture coordinate is not there has none, with a warning. Indices of
/// vertices that are out of range, numbers that are none and vertices that are not finite are errors with file:line.
/// Throws Error (input).
ObjMesh read_obj(const std::filesystem::path& file, const ObjOptions& options = {});

}  // namespace raylab
