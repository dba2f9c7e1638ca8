// [[sphere]] and [[mesh]].
#include <cmath>

#include "file_bytes.hpp"
#include "obj_reader.hpp"
#include "scene_sections.hpp"
#include "toml_reader.hpp"

namespace raylab {
namespace {

/// Sine and cosine of an angle in degrees, exact at quarter turns, so that walls stay flat.
struct SineCosine {
  double sine, cosine;

  explicit SineCosine(double degrees) {
    const double quarters = degrees / 90.0;
    if (quarters == std::floor(quarters)) {
      const int quarter = static_cast<int>(std::fmod(quarters, 4.0) + 4.0) % 4;
      sine = quarter == 1 ? 1.0 : quarter == 3 ? -1.0 : 0.0;
      cosine = quarter == 0 ? 1.0 : quarter == 2 ? -1.0 : 0.0;
    } else {
      const double radians = degrees * (3.14159265358979323846 / 180.0);
      sine = std::sin(radians);
      cosine = std::cos(radians);
    }
  }

  dvec3 rotated(const dvec3& v) const { return {cosine * v.x + sine * v.z, v.y, cosine * v.z - sine * v.x}; }
};

void place_mesh(TriangleMesh& mesh, const MeshEntry& entry) {
  if (entry.scale == 1.0f && entry.rotate_y == 0.0f && entry.translate == vec3(0.0f)) return;
  const SineCosine turn(entry.rotate_y);
  for (vec3& p : mesh.positions) {
    // In double, and rounded once.
    p = vec3(turn.rotated(dvec3(p) * double{entry.scale}) + dvec3(entry.translate));
    if (!is_finite(p)) {
      entry.table->fail_here("mesh " + entry.name + ": a vertex is too far away once scaled and moved");
    }
  }
  if (entry.rotate_y == 0.0f) return;
  for (vec3& n : mesh.normals) n = vec3(glm::normalize(turn.rotated(dvec3(n))));
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
