#pragma once
#include <algorithm>
#include <bit>
#include <cstring>
#include <initializer_list>
#include <string>
#include <vector>

#include "raylab/io/obj_file.hpp"
#include "raylab/io/scene_file.hpp"
#include "temp_folder.hpp"

namespace raylab::test {

/// A folder to write scene files into and read them from.
class InputFolder : public TempFolder {
 public:
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    write_text(*this / name, text);
    return *this / name;
  }
  LoadedScene load(const std::string& toml, std::vector<std::string> overrides = {}) const {
    return load_scene(write("scene.toml", toml), {std::move(overrides), /*keep_unneeded=*/true});
  }
  ObjMesh obj(const std::string& text) const { return read_obj(write("mesh.obj", text)); }

  /// "FILE:PLACE" with the folder, as messages have it.
  std::string at(const std::string& file_and_place) const { return (*this / file_and_place).string(); }
};

/// Whether some line starts with `place` and holds all the parts.
inline bool any_line(const std::vector<std::string>& lines, const std::string& place,
                     std::initializer_list<const char*> parts) {
  return std::any_of(lines.begin(), lines.end(), [&](const std::string& line) {
    return line.starts_with(place + ": ") && std::all_of(parts.begin(), parts.end(), [&](const char* part) {
             return line.find(part) != std::string::npos;
           });
  });
}

inline std::string joined(const std::vector<std::string>& lines) {
  std::string all;
  for (const std::string& line : lines) all += line + "\n";
  return all;
}

/// The numbers as a binary file has them, each in the bytes of its type.
template <class... Number>
std::string bytes_of(std::endian order, Number... numbers) {
  std::string all;
  const auto add = [&](auto number) {
    std::string bytes(sizeof number, '\0');
    std::memcpy(bytes.data(), &number, sizeof number);
    if (order != std::endian::native) std::reverse(bytes.begin(), bytes.end());
    all += bytes;
  };
  (add(numbers), ...);
  return all;
}

/// All corners of a mesh, triangle by triangle.
inline std::vector<vec3> corners_of(const TriangleMesh& mesh) {
  std::vector<vec3> corners;
  for (const uvec3& t : mesh.triangles) {
    for (int c = 0; c < 3; ++c) corners.push_back(mesh.positions[t[c]]);
  }
  return corners;
}

}  // namespace raylab::test
