#pragma once
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "io/ply_file.hpp"
#include "io_files.hpp"

namespace raylab::test {

inline constexpr std::endian kLittle = std::endian::little, kBig = std::endian::big;
inline constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

struct ReadPly {
  MaterialLibrary library;
  TriangleMesh mesh;
  MeshMaterials materials;
};

inline ReadPly read_ply(const InputFolder& folder, const std::string& bytes, const ObjOptions& options = {}) {
  ReadPly read;
  MeshWithMaterials mesh = read_ply_into(read.library, folder.write("mesh.ply", bytes), options);
  read.mesh = std::move(mesh.mesh);
  read.materials = std::move(mesh.materials);
  return read;
}

/// A mesh whose file gives no warning.
inline TriangleMesh mesh_of(const std::string& bytes) {
  const InputFolder folder;
  ReadPly read = read_ply(folder, bytes);
  INFO(joined(read.library.warnings));
  CHECK(read.library.warnings.empty());
  return std::move(read.mesh);
}

inline std::string header(const std::string& format, const std::string& lines) {
  return "ply\nformat " + format + " 1.0\n" + lines + "end_header\n";
}

inline std::string binary(std::endian order) { return order == kLittle ? "binary_little_endian" : "binary_big_endian"; }

inline const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";
inline const std::string kIndices = "property list uchar int vertex_indices\n";
inline const std::string kThree = "element vertex 3\n" + kXyz;
inline const std::string kFour = "element vertex 4\n" + kXyz;
inline const std::string kOneFace = "element face 1\n" + kIndices;
inline const std::string kCorners = "0 0 0\n1 0 0\n0 1 0\n";
inline const std::string kSquare = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
inline const std::vector<vec3> kPositions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

inline std::string corners(std::endian order) {
  return bytes_of(order, 0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, 1.0f, 0.0f);
}

inline void check_triangle(const TriangleMesh& mesh) {
  CHECK(mesh.positions == kPositions);
  CHECK(mesh.triangles == std::vector<uvec3>{{0, 1, 2}});
  CHECK(mesh.normals.empty());
  CHECK(mesh.texcoords.empty());
  CHECK(mesh.positions.capacity() >= mesh.positions.size() + 2);
}

}  // namespace raylab::test
