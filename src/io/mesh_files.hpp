#pragma once
#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <utility>

#include "file_kind.hpp"
#include "obj_reader.hpp"

namespace raylab {

/// The models of a scene, each file read once however many meshes are made of it.
class MeshFiles {
 public:
  explicit MeshFiles(MaterialLibrary& library) : library_(library) {}

  /// One more take() of the file will come.
  void expect(const std::filesystem::path& file, FileKind kind, const ObjOptions& options);

  /// The mesh as the file, of that kind, has it. Throws Error.
  const MeshWithMaterials& read(const std::filesystem::path& file, FileKind kind, const ObjOptions& options);

  /// The same of an expected file, to keep: the last that is expected is moved and not copied.
  MeshWithMaterials take(const std::filesystem::path& file, const ObjOptions& options);

 private:
  struct Entry {
    FileKind kind = FileKind::other;
    std::size_t expected = 0;
    std::optional<MeshWithMaterials> mesh;
  };
  Entry& entry(const std::filesystem::path& file, const ObjOptions& options);

  MaterialLibrary& library_;
  std::map<std::pair<std::filesystem::path, ObjOptions>, Entry> entries_;  // by canonical path
};

}  // namespace raylab
