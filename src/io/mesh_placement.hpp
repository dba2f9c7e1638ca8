#pragma once
#include <optional>
#include <string>
#include <vector>

#include "raylab/geometry/geometry.hpp"
#include "toml_reader.hpp"

namespace raylab {

/// What a [[mesh]] table does to the mesh of its file.
class MeshPlacement {
 public:
  /// Reads up, scale, rotate_y and translate, or in their place transform, and smooth and flip_v. The last step makes
  /// positions relative to `origin`. Throws Error.
  static MeshPlacement read(TableReader& reader, const dvec3& origin);

  /// Steps in turn, in double, then rounds once. A mesh that is mirrored keeps its outside. Throws Error at `table`
  /// when a vertex ends too far away.
  void apply(TriangleMesh& mesh, const TomlValue& table, const std::string& name) const;

 private:
  /// p becomes linear p + offset.
  struct Step {
    glm::dmat3 linear = glm::dmat3(1.0);
    dvec3 offset = dvec3(0.0);
  };
  static Step read_step(const TomlValue& value, const std::string& path);
  void move(TriangleMesh& mesh, const TomlValue& table, const std::string& name) const;

  std::vector<Step> steps_;
  std::optional<float> smooth_;  // degrees
  bool flip_v_ = false;
};

}  // namespace raylab
