#include "mesh_files.hpp"

#include "foreign_model.hpp"
#include "gltf_file.hpp"
#include "ply_file.hpp"
#include "raylab/core/error.hpp"
#include "stl_file.hpp"

namespace raylab {
namespace {

MeshWithMaterials read_mesh(FileKind kind, MaterialLibrary& library, const std::filesystem::path& file,
                            const ObjOptions& options) {
  switch (kind) {
    case FileKind::obj:
      return read_obj_into(library, file, options);
    case FileKind::ply:
      return read_ply_into(library, file, options);
    case FileKind::stl:
      return read_stl_into(library, file, options);
    case FileKind::gltf:
      return read_gltf_into(library, file, options);
    case FileKind::foreign:
      return read_foreign_into(library, file, options);
    case FileKind::scene:
    case FileKind::other:
      break;
  }
  throw Error(ErrorKind::input, file.string(), "is no model");
}

}  // namespace

MeshFiles::Entry& MeshFiles::entry(const std::filesystem::path& file, const ObjOptions& options) {
  return entries_[{std::filesystem::weakly_canonical(file), options}];
}

void MeshFiles::expect(const std::filesystem::path& file, FileKind kind, const ObjOptions& options) {
  Entry& known = entry(file, options);
  known.kind = kind;
  ++known.expected;
}

const MeshWithMaterials& MeshFiles::read(const std::filesystem::path& file, FileKind kind, const ObjOptions& options) {
  Entry& known = entry(file, options);
  if (!known.mesh) known.mesh = read_mesh(kind, library_, file, options);
  return *known.mesh;
}

MeshWithMaterials MeshFiles::take(const std::filesystem::path& file, const ObjOptions& options) {
  Entry& known = entry(file, options);
  read(file, known.kind, options);
  if (--known.expected > 0) return *known.mesh;
  MeshWithMaterials mesh = std::move(*known.mesh);
  known.mesh.reset();
  return mesh;
}

}  // namespace raylab
