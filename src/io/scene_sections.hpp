#pragma once
// The tables of a scene file, each read and checked by one function. A null table means that the file lacks it.
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "material_library.hpp"
#include "mesh_files.hpp"
#include "mesh_placement.hpp"
#include "raylab/io/scene_file.hpp"
#include "raylab/scene/camera.hpp"
#include "raylab/scene/scene.hpp"
#include "toml_value.hpp"

namespace raylab {

/// Moves the camera, the views and the spheres of a scene file by the negative of its `origin`, in double, and returns
/// that: [0, 0, 0] without the key. What is no position yet is left for its reader to refuse.
dvec3 move_to_origin(TomlValue& root);

/// [camera]: every key optional. Refuses look_from = look_at and a view along up.
CameraSettings read_camera(const TomlValue* table);

/// [[view]]: a name, which no other view has, and the keys of [camera]; those that are left out are the camera's.
std::vector<NamedView> read_views(std::span<const TomlValue> tables, const CameraSettings& camera);

/// [render]: every key optional. Refuses pictures of more than 2^28 pixels.
RenderSettings read_render(const TomlValue* table);

/// [background]: color, bottom with top, or image; black without the table. The picture read is added to `files`.
Environment read_background(const TomlValue* table, const std::filesystem::path& folder,
                            std::vector<std::filesystem::path>& files);

/// The [material.NAME] tables, which meshes and spheres name.
class SceneMaterials {
 public:
  SceneMaterials(const TomlValue* table, const std::filesystem::path& folder, MaterialLibrary& library);

  /// Index in the library of the material that a `material` key names. Throws Error, naming the nearest name.
  std::uint32_t use(const TomlValue& name, const std::string& path);

  /// Throws Error at the first material that no one used.
  void check_all_used() const;

 private:
  struct Entry {
    const TomlValue* table;
    std::uint32_t index;
    bool used;
  };
  std::vector<Entry> entries_;  // in the order of the file
  std::map<std::string, std::size_t> by_name_;
};

/// [[sphere]]: center, radius and material, all required. Appends to the scene.
void read_spheres(std::span<const TomlValue> tables, SceneMaterials& materials, Scene& scene);

/// A [[mesh]] as the scene file gives it.
struct MeshEntry {
  const TomlValue* table;
  std::string name;                       ///< the model's file as written
  std::filesystem::path file;             ///< where it is
  ObjOptions options;                     ///< how it is read
  std::optional<std::uint32_t> material;  ///< absent: materials from the model
  MeshPlacement placement;
};
/// Every entry's file is known to be there and to be a model, and is expected of `files`. Meshes end relative to
/// `origin`.
std::vector<MeshEntry> read_meshes(std::span<const TomlValue> tables, const std::filesystem::path& folder,
                                   const dvec3& origin, SceneMaterials& materials, MeshFiles& files);

/// Reads the model of an entry, moves it into place and appends it to the scene.
void load_mesh(const MeshEntry& entry, MeshFiles& files, Scene& scene);

}  // namespace raylab
