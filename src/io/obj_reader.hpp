#pragma once
#include <filesystem>

#include "material_library.hpp"
#include "raylab/geometry/geometry.hpp"
#include "raylab/io/obj_file.hpp"
#include "raylab/scene/scene.hpp"

namespace raylab {

struct MeshWithMaterials {
  TriangleMesh mesh;
  MeshMaterials materials;  ///< indices into the library's; left as they are when materials are ignored
};

/// read_obj into a library that other meshes of the scene share.
MeshWithMaterials read_obj_into(MaterialLibrary& library, const std::filesystem::path& file, const ObjOptions& options);

}  // namespace raylab
