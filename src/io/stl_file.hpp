#pragma once
#include <filesystem>

#include "material_library.hpp"
#include "obj_reader.hpp"

namespace raylab {

/// Reads an STL file, text or binary, whatever its header begins with. Corners in the same place become one vertex.
/// Facets of fewer than three distinct corners are left out with a warning, and so are the facets' normals, without
/// one. The material is the default. Throws Error (input) with file:line for text and "file, byte N" for binary data.
MeshWithMaterials read_stl_into(MaterialLibrary& library, const std::filesystem::path& file, const ObjOptions& options);

}  // namespace raylab
