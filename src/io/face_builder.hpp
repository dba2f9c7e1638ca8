#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "corner_indices.hpp"
#include "raylab/geometry/geometry.hpp"

namespace raylab {

/// Unit normal of a triangle by its winding; up when it has no area.
vec3 face_normal(const Triangle& t);

/// How often something happened, and where it first did: a line, or a byte of a binary file.
struct Tally {
  std::size_t count = 0;
  std::size_t first = 0;

  void add(std::size_t place) {
    if (count++ == 0) first = place;
  }
};

/// Makes the triangles of a mesh from faces of any number of corners. The mesh's positions and texture coordinates
/// are its reader's to fill in.
class FaceBuilder {
 public:
  static constexpr std::uint32_t kNone = CornerIndices::kNone;  ///< a corner without the attribute

  struct Corner {
    std::uint32_t position, texcoord, normal;
  };

  explicit FaceBuilder(TriangleMesh& mesh) : mesh_(mesh) {}

  /// Adds a normal of any length. One of length zero stays as it is: faces that use it take their own instead.
  void add_normal(const vec3& n, std::size_t place);

  /// Adds the triangles of a face, concave or not; none when it has fewer than 3 distinct corners.
  void add_face(std::span<const Corner> corners, std::size_t place);

  /// Adds a triangle of three distinct corners whose normals are not of length zero.
  void add_triangle(const Corner& a, const Corner& b, const Corner& c) {
    mesh_.triangles.emplace_back(a.position, b.position, c.position);
    normal_indices_.add(uvec3(a.normal, b.normal, c.normal), mesh_.triangles);
    texcoord_indices_.add(uvec3(a.texcoord, b.texcoord, c.texcoord), mesh_.triangles);
  }

  bool has_zero_normals() const { return zero_normals_.count > 0; }

  /// Completes the mesh when all faces are there. It has normals or texture coordinates when some face has; the other
  /// faces then get their geometric normal, or (0, 0). Adds warnings of what was left out or replaced, and of a mesh
  /// without faces; `location` makes "file:line" or the like of a place.
  void finish(std::vector<std::string>& warnings, const std::string& file,
              const std::function<std::string(std::size_t)>& location);

 private:
  void finish_normals();
  void finish_texcoords();

  TriangleMesh& mesh_;
  CornerIndices normal_indices_, texcoord_indices_;
  Tally degenerate_, tangled_, zero_normals_;
  // Of the face at hand; kept to save allocations.
  std::vector<Corner> polygon_;
  std::vector<vec3> points_;
  std::vector<std::array<std::uint32_t, 3>> pieces_;
};

}  // namespace raylab
