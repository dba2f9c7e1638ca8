#pragma once
#include <filesystem>

#include "material_library.hpp"
#include "obj_reader.hpp"

namespace raylab {

/// Reads a model of a format that others read, as binary glTF, which the program raylab-import makes of it: a process
/// of its own with limits of memory and time. It is the program that the environment variable RAYLAB_IMPORT names, else
/// the one that is installed or built with the running program. Messages name the model, not what was made of it.
/// Throws Error (input): there is no such program, it fails, dies or takes too long, or its output is not readable.
MeshWithMaterials read_foreign_into(MaterialLibrary& library, const std::filesystem::path& file,
                                    const ObjOptions& options);

}  // namespace raylab
