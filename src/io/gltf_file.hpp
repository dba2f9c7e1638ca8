#pragma once
#include <filesystem>

#include "material_library.hpp"
#include "obj_reader.hpp"
#include "raylab/io/obj_file.hpp"

namespace raylab {

/// Reads a glTF 2.0 file, .gltf or .glb, with its buffers, materials and pictures, into a library that other meshes of
/// the scene share. All that the default scene shows (or all roots where no scene is the default, or all meshes where
/// there are no nodes) becomes one mesh in world coordinates. Of its primitives, points and lines are left out; those
/// without normals are flat where others have some. What has no material is lambertian grey (0.5), and a missing
/// texture magenta. What of the file is not shown is said once a kind in a warning, "FILE: ...", and what of a material
/// is not, in its note.
///
/// Throws Error (input): no glTF 2.0, an extension that it needs and that is not understood, buffers that are missing
/// or too short, indices that are out of range, positions that are not finite, nodes that are reached twice.
///
/// Before memory is asked for, what the mesh takes is held against a budget: 64 MiB or 1024 times the bytes of the file
/// and its buffers, whichever is more, as nodes may share meshes. The rest takes at most three times the bytes of the
/// file and its buffers, and some hundred bytes for each value of its JSON, of which there may be 2^23.
MeshWithMaterials read_gltf_into(MaterialLibrary& library, const std::filesystem::path& file,
                                 const ObjOptions& options);

}  // namespace raylab
