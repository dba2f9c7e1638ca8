#pragma once
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "io/gltf_file.hpp"
#include "io_files.hpp"

namespace raylab::test {

using Json = nlohmann::json;

inline std::string base64(std::string_view bytes) {
  const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0);
    }
    for (std::size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : digits[bits >> (18 - 6 * k) & 63];
  }
  return text;
}

inline std::string little_endian(std::size_t value) {
  std::string bytes;
  for (int i = 0; i < 4; ++i) bytes += static_cast<char>(value >> 8 * i & 0xff);
  return bytes;
}

inline std::string chunk(const std::string& type, const std::string& bytes) {
  return little_endian(bytes.size()) + type + bytes;
}

/// A GLB file of these chunks.
inline std::string glb_of(const std::string& chunks) {
  return "glTF" + little_endian(2) + little_endian(12 + chunks.size()) + chunks;
}

/// A glTF file that is put together: its JSON, with one buffer.
struct GltfModel {
  Json root = {{"asset", {{"version", "2.0"}}}};
  std::string buffer;

  /// Index of a new bufferView.
  int view(const std::string& bytes, std::size_t stride = 0) {
    Json entry = {{"buffer", 0}, {"byteOffset", buffer.size()}, {"byteLength", bytes.size()}};
    if (stride != 0) entry["byteStride"] = stride;
    buffer += bytes + std::string((4 - bytes.size() % 4) % 4, '\0');
    return push("bufferViews", entry);
  }
  template <class T>
  static std::string bytes_of(const std::vector<T>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
  }
  /// Index of a new accessor, whose vectors of N components lie close together.
  template <class T>
  int accessor(const std::vector<T>& values, int n) {
    const char* names[] = {"", "SCALAR", "VEC2", "VEC3"};
    return push("accessors", {{"bufferView", view(bytes_of(values))},
                              {"componentType", component_type(T{})},
                              {"count", values.size() / static_cast<std::size_t>(n)},
                              {"type", names[n]}});
  }
  static int component_type(std::int8_t) { return 5120; }
  static int component_type(std::uint8_t) { return 5121; }
  static int component_type(std::int16_t) { return 5122; }
  static int component_type(std::uint16_t) { return 5123; }
  static int component_type(std::uint32_t) { return 5125; }
  static int component_type(float) { return 5126; }

  int push(const char* array, const Json& entry) {
    root[array].push_back(entry);
    return static_cast<int>(root[array].size() - 1);
  }
  /// Index of a new mesh of one primitive.
  int mesh(const Json& attributes, const Json& more = Json::object()) {
    Json primitive = {{"attributes", attributes}};
    primitive.update(more);
    return push("meshes", {{"primitives", Json::array({primitive})}});
  }

  /// The JSON with its buffer, as `uri` or in the text.
  std::string gltf(const std::string& uri = "") const {
    Json json = root;
    json["buffers"] = {{{"byteLength", buffer.size()},
                        {"uri", uri.empty() ? "data:application/octet-stream;base64," + base64(buffer) : uri}}};
    return json.dump();
  }
  std::string glb() const {
    Json json = root;
    json["buffers"] = {{{"byteLength", buffer.size()}}};
    std::string text = json.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    return glb_of(chunk("JSON", text) + chunk(std::string("BIN\0", 4), buffer));
  }
};

const std::vector<float> kCorners = {0, 0, 0, 1, 0, 0, 0, 1, 0};

/// One triangle in the plane z = 0, facing +z, its only mesh.
inline GltfModel one_triangle(const Json& more = Json::object()) {
  GltfModel model;
  model.mesh({{"POSITION", model.accessor(kCorners, 3)}}, more);
  return model;
}

/// What is read from a file.
struct GltfRead {
  MaterialLibrary library;
  TriangleMesh mesh;
  MeshMaterials materials;

  explicit GltfRead(const std::filesystem::path& file, const ObjOptions& options = {}) {
    MeshWithMaterials read = read_gltf_into(library, file, options);
    mesh = std::move(read.mesh);
    materials = std::move(read.materials);
  }
  GltfRead(const InputFolder& folder, const GltfModel& model) : GltfRead(folder.write("a.gltf", model.gltf())) {}

  const Material& material(std::uint32_t triangle = 0) const { return library.materials.at(materials.of(triangle)); }
};

}  // namespace raylab::test
