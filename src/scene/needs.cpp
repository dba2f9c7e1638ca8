#include "raylab/scene/needs.hpp"

#include <cmath>

namespace raylab {

namespace {

bool is_light(const Material& m) { return m.kind == Material::Kind::diffuse_light; }
bool is_mirror(const Material& m) { return m.kind == Material::Kind::metal && m.fuzz == 0.0f; }

/// Which materials the triangles of a mesh have.
std::vector<bool> materials_of(const Scene& scene, std::size_t mesh) {
  std::vector<bool> used(scene.materials.size(), false);
  const MeshMaterials& m = scene.mesh_materials[mesh];
  if (m.per_triangle.empty()) {
    if (!scene.geometry.meshes[mesh].triangles.empty()) used[m.common] = true;
  } else {
    for (const std::uint16_t id : m.per_triangle) used[id] = true;
  }
  return used;
}

/// Whether every shading normal is, to within a tenth of a degree, the normal of its face: shading cannot tell.
bool normals_are_flat(const TriangleMesh& mesh) {
  constexpr float kCosine = 0.9999985f;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle t = triangle_corners(mesh, i);
    const vec3 n = glm::cross(t.p1 - t.p0, t.p2 - t.p0);
    const float length = glm::length(n);
    if (!(length > 0.0f)) continue;
    const uvec3& corners = mesh.normal_corners(i);
    for (int k = 0; k < 3; ++k) {
      if (!(glm::dot(n, mesh.normals[corners[k]]) >= kCosine * length)) return false;
    }
  }
  return true;
}

struct MeshReads {
  bool normals = false;
  bool texcoords = false;
};

MeshReads mesh_reads(const Scene& scene, std::size_t mesh) {
  MeshReads reads;
  const std::vector<bool> used = materials_of(scene, mesh);
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (!used[i]) continue;
    const Material& m = scene.materials[i];
    reads.normals |= !is_light(m);
    reads.texcoords |= m.color.kind == Texture::Kind::image;
  }
  return reads;
}

template <class T>
std::size_t release(std::vector<T>& v) {
  const std::size_t bytes = v.capacity() * sizeof(T);
  std::vector<T>().swap(v);
  return bytes;
}

}  // namespace

SceneNeeds scene_needs(const Scene& scene) {
  SceneNeeds needs;
  needs.spheres = !scene.geometry.spheres.empty();
  for (std::size_t i = 0; i < scene.geometry.meshes.size(); ++i) {
    needs.shading_normals |= !scene.geometry.meshes[i].normals.empty() && mesh_reads(scene, i).normals;
    const std::vector<bool> used = materials_of(scene, i);
    for (std::size_t k = 0; k < used.size(); ++k) {
      needs.area_lights |= used[k] && is_light(scene.materials[k]);
      needs.plane_mirrors |= used[k] && is_mirror(scene.materials[k]) && scene.geometry.meshes[i].normals.empty();
    }
  }
  for (const std::uint32_t id : scene.sphere_materials) {
    const Material& m = scene.materials[id];
    needs.area_lights |= is_light(m);
    needs.specular_spheres |= is_mirror(m) || m.kind == Material::Kind::dielectric;
  }
  needs.environment_sampling = scene.environment.kind == Environment::Kind::image && !scene.environment.is_black();
  needs.specular_spheres = needs.specular_spheres && (needs.area_lights || needs.environment_sampling);
  return needs;
}

SceneNeeds all_needs() { return {true, true, true, true, true, true}; }

std::size_t drop_unneeded(Scene& scene) {
  std::size_t freed = 0;
  for (std::size_t i = 0; i < scene.geometry.meshes.size(); ++i) {
    TriangleMesh& mesh = scene.geometry.meshes[i];
    const MeshReads reads = mesh_reads(scene, i);
    if (!reads.texcoords) freed += release(mesh.texcoords) + release(mesh.texcoord_indices);
    if (!mesh.normals.empty() && (!reads.normals || normals_are_flat(mesh))) {
      freed += release(mesh.normals) + release(mesh.normal_indices);
    }
  }
  return freed;
}

std::vector<std::string> describe(const SceneNeeds& needs) {
  std::vector<std::string> lines;
  const auto line = [&](bool needed, const char* name, const char* what) {
    lines.push_back(std::string(needed ? "  yes  " : "  no   ") + name + ": " + what);
  };
  line(needs.spheres, "spheres", "hits may be of spheres");
  line(needs.shading_normals, "shading normals", "stored and interpolated");
  line(needs.area_lights, "area lights", "emitting primitives are sampled");
  line(needs.environment_sampling, "background sampling", "directions chosen by a picture's brightness");
  line(needs.plane_mirrors, "plane mirrors", "lights are sampled over them too");
  line(needs.specular_spheres, "specular spheres", "lights are sampled over them too, off them and through");
  return lines;
}

}  // namespace raylab
