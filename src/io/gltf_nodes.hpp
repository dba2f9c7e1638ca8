#pragma once
#include <vector>

#include "gltf_document.hpp"
#include "raylab/core/vec.hpp"

namespace raylab {

/// A linear map and a translation.
struct GltfAffine {
  glm::dmat3 linear = glm::dmat3(1.0);
  dvec3 translation = dvec3(0.0);

  bool operator==(const GltfAffine&) const = default;
};

/// A mesh as a node shows it.
struct GltfMeshUse {
  int mesh;  ///< index that is not checked yet
  GltfAffine to_world;
};

/// The meshes of the default scene, or of all roots where none is the default, or all there are where there are no
/// nodes. Throws Error (input) for nodes that are not there or form no trees.
std::vector<GltfMeshUse> mesh_uses(GltfDocument& document);

}  // namespace raylab
