#include "raylab/io/scene_file.hpp"

#include <utility>

#include "file_bytes.hpp"
#include "overrides.hpp"
#include "raylab/core/error.hpp"
#include "raylab/scene/needs.hpp"
#include "scene_sections.hpp"
#include "toml_reader.hpp"

namespace raylab {
namespace {

/// Everything is checked before the first mesh is loaded, as that may take long.
void read_scene(const TomlValue& root, const std::filesystem::path& file, MaterialLibrary& library,
                LoadedScene& loaded) {
  const std::filesystem::path folder = file.parent_path();
  TableReader reader(root, "");
  const TomlValue* camera = reader.find("camera");
  const TomlValue* render = reader.find("render");
  const TomlValue* background = reader.find("background");
  const TomlValue* material = reader.find("material");
  const auto mesh_tables = tables_of(reader.find("mesh"), "mesh");
  const auto sphere_tables = tables_of(reader.find("sphere"), "sphere");
  reader.finish();

  Scene& scene = loaded.scene;
  scene.name = file.stem().string();
  loaded.camera = read_camera(camera);
  scene.render = read_render(render);
  scene.environment = read_background(background, folder, library.files);
  SceneMaterials materials(material, folder, library);
  read_spheres(sphere_tables, materials, scene);
  const std::vector<MeshEntry> meshes = read_meshes(mesh_tables, materials);
  materials.check_all_used();
  for (const MeshEntry& entry : meshes) load_mesh(entry, folder, library, scene);
  if (meshes.empty() && scene.geometry.spheres.empty()) {
    library.warnings.push_back(file.string() + ": no mesh and no sphere: only the background can be seen");
  }
}

std::uint64_t content_hash(const std::string& text, const std::vector<std::string>& overrides,
                           const MaterialLibrary& library) {
  ContentHash hash;
  hash.add(text);
  for (const std::string& override_text : overrides) hash.add(override_text);
  for (const auto& file : library.files) hash.add_file(file);
  for (const auto& file : library.textures.files()) hash.add_file(file);
  return hash.value();
}

}  // namespace

LoadedScene load_scene(const std::filesystem::path& file, const LoadOptions& options) {
  const std::string text = read_file(file);
  TomlValue root = parse_toml(text, file.string());
  for (const std::string& assignment : options.overrides) apply_override(root, assignment);

  MaterialLibrary library;
  LoadedScene loaded;
  read_scene(root, file, library, loaded);
  loaded.hash = content_hash(text, options.overrides, library);
  loaded.scene.materials = std::move(library.materials);
  loaded.scene.textures = library.textures.take_images();
  loaded.warnings = std::move(library.warnings);
  loaded.notes = std::move(library.notes);
  if (!options.keep_unneeded) loaded.dropped_bytes = drop_unneeded(loaded.scene);
  return loaded;
}

}  // namespace raylab
