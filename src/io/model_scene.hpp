#pragma once
#include <string>

#include "file_kind.hpp"
#include "obj_reader.hpp"
#include "raylab/io/scene_file.hpp"

namespace raylab {

/// The text of a scene file that shows a model: a camera from the front, the right and above that has all of it in
/// view, a sky and a key light if the model's own lights do not light it, and a ground if asked for. `name` is how the
/// text names the model's file; `library` holds its materials.
std::string model_scene_text(const MeshWithMaterials& model, const MaterialLibrary& library, FileKind kind,
                             const std::string& name, const ModelOptions& options);

}  // namespace raylab
