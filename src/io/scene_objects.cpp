// [[sphere]] and [[mesh]].
#include "file_bytes.hpp"
#include "scene_sections.hpp"
#include "toml_reader.hpp"

namespace raylab {
namespace {

/// The model that a [[mesh]] names by `file`, or by `obj`, which takes OBJ alone.
void read_model(TableReader& reader, const std::filesystem::path& folder, MeshEntry& entry, FileKind& kind) {
  const TomlValue* obj = reader.find("obj");
  const TomlValue* file = reader.find("file");
  if (obj != nullptr && file != nullptr) obj->fail_here(reader.path_of("obj") + ": expected only one of file, obj");
  const TomlValue& named = obj != nullptr ? *obj : reader.require("file");
  const std::string path = reader.path_of(obj != nullptr ? "obj" : "file");
  entry.name = string_of(named, path);
  entry.file = folder / entry.name;
  if (!is_file(entry.file)) named.fail(path, "an existing file");
  kind = model_kind(entry.file, false);
  if (obj != nullptr && kind != FileKind::obj) {
    named.fail_here(path + ": found " + content_of(entry.file).words + ", which is named by file and not by obj");
  }
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

std::vector<MeshEntry> read_meshes(std::span<const TomlValue> tables, const std::filesystem::path& folder,
                                   const dvec3& origin, SceneMaterials& materials, MeshFiles& files) {
  std::vector<MeshEntry> entries;
  for (std::size_t i = 0; i < tables.size(); ++i) {
    TableReader reader(tables[i], "mesh." + std::to_string(i));
    MeshEntry entry;
    entry.table = &tables[i];
    for (const char* key : {"file", "obj", "material", "mtl"}) reader.find(key);
    const TomlValue* material = tables[i].find("material");
    const TomlValue* mtl = tables[i].find("mtl");
    entry.placement = MeshPlacement::read(reader, origin);
    reader.finish();
    if (material != nullptr && mtl != nullptr) {
      mtl->fail_here(reader.path_of("mtl") + " has no effect: material replaces what the MTL files say");
    }
    if (mtl != nullptr && string_of(*mtl, reader.path_of("mtl")) != "seed") {
      mtl->fail(reader.path_of("mtl"), "\"seed\"");
    }
    FileKind kind = FileKind::other;
    read_model(reader, folder, entry, kind);
    if (material != nullptr) entry.material = materials.use(*material, reader.path_of("material"));
    entry.options = {.ignore_materials = entry.material.has_value(), .plain_materials = mtl != nullptr};
    files.expect(entry.file, kind, entry.options);
    entries.push_back(std::move(entry));
  }
  return entries;
}

void load_mesh(const MeshEntry& entry, MeshFiles& files, Scene& scene) {
  MeshWithMaterials read = files.take(entry.file, entry.options);
  entry.placement.apply(read.mesh, *entry.table, entry.name);
  if (entry.material) read.materials.common = *entry.material;
  scene.geometry.meshes.push_back(std::move(read.mesh));
  scene.mesh_materials.push_back(std::move(read.materials));
  scene.mesh_names.push_back(entry.name);
}

}  // namespace raylab
