#pragma once
#include <filesystem>

#include "material_library.hpp"
#include "obj_reader.hpp"

namespace raylab {

/// Reads a PLY file, ASCII or binary of either byte order: the positions, normals and texture coordinates of element
/// "vertex" (also those of faces' corners, "texcoord"), the polygons of "face" and the strips of "tristrips".
/// Everything else is left out, colours with a warning. Polygons and normals are treated as read_obj treats them. The
/// material is lambertian with the picture that a comment TextureFile names, else the default. Throws Error (input)
/// with file:line for text and "file, byte N" for binary data.
MeshWithMaterials read_ply_into(MaterialLibrary& library, const std::filesystem::path& file, const ObjOptions& options);

}  // namespace raylab
