#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "material_library.hpp"
#include "raylab/io/obj_file.hpp"
#include "raylab/scene/scene.hpp"

namespace raylab {

/// Follows the mtllib and usemtl statements of one OBJ file. Names are looked up when the file has been read, so
/// that mtllib may come after usemtl, and only those that faces use.
class ObjMaterials {
 public:
  ObjMaterials(const std::filesystem::path& file, const ObjOptions& options);

  /// Takes a statement in; false when it is neither mtllib nor usemtl.
  bool statement(std::string_view keyword, std::string_view rest, const std::string& location,
                 MaterialLibrary& library);

  /// The triangle added last has the material of the last usemtl. `triangle_count` includes it.
  void add_triangle(std::size_t triangle_count, int line);

  /// Materials of the triangles, as indices into the library.
  MeshMaterials finish(MaterialLibrary& library);

 private:
  struct Use {
    std::string name;  // empty before the first usemtl
    std::string location;
  };
  void open_libraries(std::string_view names, const std::string& location, MaterialLibrary& library);
  std::uint32_t index_of(const Use& use, MaterialLibrary& library) const;

  std::filesystem::path file_;
  ObjOptions options_;
  std::vector<std::size_t> mtl_files_;  // as the library numbers them, in the order of the file
  Use current_;
  bool changed_ = true;                          // usemtl since the last triangle
  std::uint16_t current_use_ = 0;                // index into uses_
  std::vector<Use> uses_;                        // distinct names in order of use by faces
  std::map<std::string, std::uint16_t> use_of_;  // by name
  std::vector<std::uint16_t> per_triangle_;      // index into uses_; empty while there is one
};

}  // namespace raylab
