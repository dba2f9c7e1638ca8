// [[sphere]] and [[mesh]].
#include "core/angle.hpp"
#include "file_bytes.hpp"
#include "obj_reader.hpp"
#include "scene_sections.hpp"
#include "toml_reader.hpp"

namespace raylab {
namespace {

void place_mesh(TriangleMesh& mesh, const MeshEntry& entry) {
  if (entry.scale == 1.0f && entry.rotate_y == 0.0f && entry.translate == vec3(0.0f)) return;
  const SineCosine turn = sine_cosine_of_degrees(static_cast<double>(entry.rotate_y));
  const auto rotated = [&](const dvec3& v) {
    return dvec3(turn.cosine * v.x + turn.sine * v.z, v.y, turn.cosine * v.z - turn.sine * v.x);
  };
  for (vec3& p : mesh.positions) {
    // In double, and rounded once.
    p = vec3(rotated(dvec3(p) * double{entry.scale}) + dvec3(entry.translate));
    if (!is_finite(p)) {
      entry.table->fail_here("mesh " + entry.name + ": a vertex is too far away once scaled and moved");
    }
  }
  if (entry.rotate_y == 0.0f) return;
  for (vec3& n : mesh.normals) n = vec3(glm::normalize(rotated(dvec3(n))));
}

}  // namespace

void read_spheres(std::span<const TomlValue> tables, SceneMaterials& materials, Scene& scene) {
  scene.geometry.spheres.reserve(tables.size());
  scene.sphere_materials.reserve(tables.size());
  for (std::size_t i = 0; i < tables.size(); ++i) {
    TableReader reader(tables[i], "sphere." + std::to_string(i));
    for (const char* key : {"center", "radius", "material"}) reader.find(key);
    reader.finish();
    Sphere sphere{};
    sphere.center = vec3_of(reader.require("center"), reader.path_of("center"), kAnyNumber);
    sphere.radius = number_of(reader.require("radius"), reader.path_of("radius"), kPositive);
    const std::uint32_t material = materials.use(reader.require("material"), reader.path_of("material"));
    scene.geometry.spheres.push_back(sphere);
    scene.sphere_materials.push_back(material);
  }
}

std::vector<MeshEntry> read_meshes(std::span<const TomlValue> tables, SceneMaterials& materials) {
  std::vector<MeshEntry> entries;
  for (std::size_t i = 0; i < tables.size(); ++i) {
    TableReader reader(tables[i], "mesh." + std::to_string(i));
    MeshEntry entry;
    entry.table = &tables[i];
    const TomlValue* material = reader.find("material");
    const TomlValue* mtl = reader.find("mtl");
    reader.string("obj", entry.name);
    reader.number("scale", entry.scale, kPositive);
    reader.number("rotate_y", entry.rotate_y, kAnyNumber);
    reader.vector("translate", entry.translate, kAnyNumber);
    reader.finish();
    reader.require("obj");
    if (material != nullptr && mtl != nullptr) {
      mtl->fail_here(reader.path_of("mtl") + " has no effect: material replaces what the MTL files say");
    }
    if (mtl != nullptr && string_of(*mtl, reader.path_of("mtl")) != "seed") {
      mtl->fail(reader.path_of("mtl"), "\"seed\"");
    }
    if (material != nullptr) entry.material = materials.use(*material, reader.path_of("material"));
    entries.push_back(std::move(entry));
  }
  return entries;
}

void load_mesh(const MeshEntry& entry, const std::filesystem::path& folder, MaterialLibrary& library, Scene& scene) {
  const std::filesystem::path file = folder / entry.name;
  if (!is_file(file)) {
    entry.table->find("obj")->fail("mesh.obj", "an existing file");
  }
  MeshWithMaterials read = read_obj_into(library, file, {.ignore_materials = entry.material.has_value()});
  place_mesh(read.mesh, entry);
  if (entry.material) read.materials.common = *entry.material;
  scene.geometry.meshes.push_back(std::move(read.mesh));
  scene.mesh_materials.push_back(std::move(read.materials));
  scene.mesh_names.push_back(entry.name);
}

}  // namespace raylab
