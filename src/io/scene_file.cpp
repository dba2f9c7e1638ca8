#include "raylab/io/scene_file.hpp"

#include <utility>

#include "file_bytes.hpp"
#include "model_scene.hpp"
#include "overrides.hpp"
#include "raylab/core/error.hpp"
#include "raylab/core/text.hpp"
#include "raylab/scene/needs.hpp"
#include "scene_sections.hpp"
#include "toml_reader.hpp"

namespace raylab {
namespace {

/// Of the format of scene files. Files without one are of the first.
constexpr int kVersion = 1;

/// Refuses files of a later version: what their keys mean is not known here.
void check_version(TableReader& reader) {
  int version = kVersion;
  if (reader.count("version", version) && version > kVersion) {
    reader.table().find("version")->fail_here(
        format("version: found %d, and this program reads scene files of version %d", version, kVersion));
  }
}

/// Everything is checked before the first mesh is loaded, as that may take long.
void read_scene(TomlValue& root, const std::filesystem::path& file, const std::filesystem::path& folder,
                MaterialLibrary& library, MeshFiles& models, LoadedScene& loaded) {
  const dvec3 origin = move_to_origin(root);
  TableReader reader(root, "");
  check_version(reader);
  reader.find("origin");
  const TomlValue* camera = reader.find("camera");
  const TomlValue* render = reader.find("render");
  const TomlValue* background = reader.find("background");
  const TomlValue* material = reader.find("material");
  const auto mesh_tables = tables_of(reader.find("mesh"), "mesh");
  const auto sphere_tables = tables_of(reader.find("sphere"), "sphere");
  const auto view_tables = tables_of(reader.find("view"), "view");
  reader.finish();

  Scene& scene = loaded.scene;
  scene.name = file.stem().string();
  loaded.camera = read_camera(camera);
  loaded.views = read_views(view_tables, loaded.camera);
  scene.render = read_render(render);
  scene.environment = read_background(background, folder, library.files);
  SceneMaterials materials(material, folder, library);
  read_spheres(sphere_tables, materials, scene);
  const std::vector<MeshEntry> meshes = read_meshes(mesh_tables, folder, origin, materials, models);
  materials.check_all_used();
  for (const MeshEntry& entry : meshes) load_mesh(entry, models, scene);
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

/// What is no file, a pipe for one, can be read but once: it is a scene.
FileKind kind_of(const std::filesystem::path& file) { return is_file(file) ? model_kind(file, true) : FileKind::scene; }

/// The model's file as paths from the folder name it.
std::string name_from(const std::filesystem::path& folder, const std::filesystem::path& model) {
  return std::filesystem::proximate(model, folder.empty() ? "." : folder).generic_string();
}

/// Names of files need not be UTF-8, which TOML is: in the document the model has its own name, whatever the text has.
void name_model(TomlValue& root, const std::string& name, const std::filesystem::path& model, bool is_kept) {
  std::string& written = root.find("mesh")->items.front().find("file")->text;
  if (is_kept && written != name) {
    throw Error(ErrorKind::input, model.string(), "has a name that is not UTF-8, so no scene file can name it");
  }
  written = name;
}

}  // namespace

bool is_model_file(const std::filesystem::path& file) { return kind_of(file) != FileKind::scene; }

LoadedScene load_scene(const std::filesystem::path& file, const LoadOptions& options) {
  MaterialLibrary library;
  MeshFiles models(library);
  LoadedScene loaded;
  std::filesystem::path folder = file.parent_path();
  const FileKind kind = kind_of(file);
  loaded.made_for_model = kind != FileKind::scene;
  if (loaded.made_for_model) {
    if (!options.model.folder.empty()) folder = options.model.folder;
    const MeshWithMaterials& model = models.read(file, kind, {});
    loaded.text = model_scene_text(model, library, kind, name_from(folder, file), options.model);
  } else {
    const ModelOptions& model = options.model;
    if (model.up != '\0' || model.ground || !model.folder.empty()) {
      throw Error(ErrorKind::usage, file.string(), "is a scene: --up, --ground and --write-scene are for models");
    }
    loaded.text = read_file(file);
  }
  TomlValue root = parse_toml(loaded.text, file.string());
  if (loaded.made_for_model) name_model(root, name_from(folder, file), file, !options.model.folder.empty());
  for (const std::string& assignment : options.overrides) apply_override(root, assignment);

  read_scene(root, file, folder, library, models, loaded);
  loaded.hash = content_hash(loaded.text, options.overrides, library);
  loaded.files = {file};
  loaded.files.insert(loaded.files.end(), library.files.begin(), library.files.end());
  const auto& textures = library.textures.files();
  loaded.files.insert(loaded.files.end(), textures.begin(), textures.end());
  loaded.scene.materials = std::move(library.materials);
  loaded.scene.textures = library.textures.take_images();
  loaded.warnings = std::move(library.warnings);
  loaded.notes = std::move(library.notes);
  if (!options.keep_unneeded) loaded.dropped_bytes = drop_unneeded(loaded.scene);
  return loaded;
}

}  // namespace raylab
