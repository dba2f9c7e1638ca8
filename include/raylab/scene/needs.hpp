#pragma once
// The third rule: model no more than a scene needs.
#include <string>
#include <vector>

#include "raylab/scene/scene.hpp"

namespace raylab {

/// What a scene makes use of. Computed once; what it does not name is not stored, not sampled and not branched on.
struct SceneNeeds {
  bool triangles = false;
  bool spheres = false;
  bool shading_normals = false;  ///< some scattering mesh has normals that differ from the faces'
  bool texcoords = false;        ///< some image texture is looked up
  bool textures = false;         ///< some colour varies over a surface (checker or image)
  bool lambertian = false;
  bool rough_metal = false;   ///< metal with a density: fuzz > 0
  bool mirror = false;        ///< metal without blur
  bool dielectric = false;
  bool area_lights = false;   ///< some primitive emits
  bool environment = false;   ///< the background is not black
  bool environment_sampling = false;  ///< the background is a picture: directions are chosen by its brightness

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
