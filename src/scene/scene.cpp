#include "raylab/scene/scene.hpp"

namespace raylab {

std::size_t Scene::bytes() const {
  std::size_t total = geometry.bytes() + sphere_materials.capacity() * sizeof(std::uint32_t) +
                      environment.picture.texels.capacity() * sizeof(Rgb);
  for (const MeshMaterials& m : mesh_materials) total += m.per_triangle.capacity() * sizeof(std::uint16_t);
  for (const TextureImage& t : textures) total += t.texels.capacity() * sizeof(Rgb);
  return total;
}

}  // namespace raylab
