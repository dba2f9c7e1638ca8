#pragma once
// The third rule: model no more than a scene needs.
#include <string>
#include <vector>

#include "raylab/scene/scene.hpp"

namespace raylab {

/// What a renderer has to be ready for. Computed once; what it does not name is not stored, not sampled and not
/// branched on. Each one decides something: what no one asks about is not listed.
struct SceneNeeds {
  bool spheres = false;
  bool shading_normals = false;       ///< some scattering mesh has normals that differ from the faces'
  bool area_lights = false;           ///< some primitive emits
  bool environment_sampling = false;  ///< the background is a picture: directions are chosen by its brightness
  bool plane_mirrors = false;         ///< some flat faces are of smooth metal: lights are sampled over them too
  bool specular_spheres =
      false;  ///< some spheres are of glass or smooth metal: what lights there are is sampled over them

  bool operator==(const SceneNeeds&) const = default;
};

/// What the scene uses, from its materials, meshes and background.
SceneNeeds scene_needs(const Scene& scene);

/// Everything on, for measuring what leaving things out saves.
SceneNeeds all_needs();

/// Frees the attributes of each mesh that no material of it reads: texture coordinates without an image texture;
/// normals of meshes that only emit, or that equal the faces' normals. Returns the bytes freed.
std::size_t drop_unneeded(Scene& scene);

/// One line a need, for `--check`.
std::vector<std::string> describe(const SceneNeeds& needs);

}  // namespace raylab
