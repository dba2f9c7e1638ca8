// glTF files that are damaged, or mean harm, end in one line with their place, before memory is asked for.
#include <functional>
#include <limits>

#include "catch.hpp"
#include "expect_error.hpp"
#include "gltf_files.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

void expect_refused(const InputFolder& folder, const std::string& bytes, std::initializer_list<const char*> parts) {
  const auto file = folder.write("a.gltf", bytes);
  expect_error(ErrorKind::input, file.string(), parts, [&] { GltfRead{file}; });
}

std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

/// A triangle with everything that can be wrong, before it is made so.
GltfModel whole() {
  GltfModel model;
  const int positions = model.accessor(kCorners, 3);
  const int normals = model.accessor(std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1}, 3);
  const int texcoords = model.accessor(std::vector<float>{0, 0, 1, 0, 0, 1}, 2);
  const int indices = model.accessor(std::vector<std::uint16_t>{0, 1, 2}, 1);
  const int sparse_indices = model.view(GltfModel::bytes_of(std::vector<std::uint16_t>{0, 2}));
  model.root["accessors"][0]["sparse"] = {{"count", 2},
                                          {"indices", {{"bufferView", sparse_indices}, {"componentType", 5123}}},
                                          {"values", {{"bufferView", 0}}}};
  model.mesh({{"POSITION", positions}, {"NORMAL", normals}, {"TEXCOORD_0", texcoords}},
             {{"indices", indices}, {"material", 0}});
  model.push("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  model.push("textures", {{"source", 0}});
  model.push("images", {{"uri", "none.png"}});
  model.push("nodes", {{"mesh", 0}});
  model.push("nodes", Json::object());
  model.push("scenes", {{"nodes", {0, 1}}});
  model.root["scene"] = 0;
  return model;
}

}  // namespace

TEST_CASE("a .glb file that is cut off or of another version is refused", "[unit]") {
  const InputFolder folder;
  const std::string glb = one_triangle().glb();
  expect_refused(folder, "glTF", {"ends in its header"});
  expect_refused(folder, glb.substr(0, glb.size() - 1), {"found", "bytes, expected", "truncated"});
  expect_refused(folder, "glTF" + little_endian(1) + glb.substr(8), {"GLB version 1, expected 2"});
  expect_refused(folder, glb_of(""), {"without a JSON chunk"});
  expect_refused(folder, glb_of(little_endian(0xfffffff0) + "JSON{}"), {"a chunk of 4294967280 bytes"});
  expect_refused(folder, glb_of(chunk("JSON", "{}  ")), {"not readable as glTF"});
  expect_refused(folder, "", {"not readable as glTF"});
  for (std::size_t size = 0; size < glb.size(); size += 7) {
    expect_refused(folder, glb.substr(0, size), {});
    if (size >= 12) expect_refused(folder, glb_of(glb.substr(12, size - 12)), {});
  }
}

TEST_CASE("JSON that is none, too deep or too much is refused", "[unit]") {
  const InputFolder folder;
  const std::string start = R"({"asset": {"version": "2.0"}, )";
  expect_refused(folder, "{\"asset\":\n ?", {"line 2"});
  expect_refused(folder, "[1, 2, 3]", {"not readable as glTF"});
  expect_refused(folder, start + "\"extras\": " + repeated("[", 100000), {"nested more than 64 deep"});
  expect_refused(folder, start + "\"images\": " + repeated("{\"a\":", 100), {"nested more than 64 deep"});
  expect_refused(folder, start + "\"extras\": [0" + repeated(",0", 1 << 23) + "]}", {"more than 8388608 values"});
  expect_refused(folder, start + R"("buffers": [], "buffers": []})", {"two members of the name \"buffers\""});
  expect_refused(folder, start + R"("buffers": {}})", {"\"buffers\" is no JSON array of objects"});
  expect_refused(folder, start + R"("images": [1]})", {"\"images\" is no JSON array of objects"});
  expect_refused(folder, start + R"("buffers": [1e999]})", {"\"buffers\" is no JSON array"});
  expect_refused(folder, start + R"("extras": 1e999})", {"not readable as glTF"});
  expect_refused(folder, start + R"("extras": "\)", {"not readable as glTF"});
  expect_refused(folder, start + R"("b\u0075ffers": [{"byteLength": 1, "uri": "a.gltf"}]})", {"not readable as glTF"});
  expect_refused(folder, R"({"asset": {"version": "1.0"}})", {"glTF version \"1.0\", expected 2.0"});
  expect_refused(folder, R"({"scenes": []})", {"\"asset\""});
}

TEST_CASE("a quote after a backslash ends no text, and one after two does", "[unit]") {
  const InputFolder folder;
  GltfModel model = one_triangle();
  model.root["extras"] = {"\\", "\"[[[", "\\\"", "]]]}\\\\"};
  CHECK(GltfRead(folder, model).mesh.triangles.size() == 1);
}

TEST_CASE("data URIs may have their slashes escaped, and no name passes for one", "[unit]") {
  const InputFolder folder;
  std::string text = one_triangle().gltf();
  for (auto at = text.find('/'); at != std::string::npos; at = text.find('/', at + 2)) text.insert(at, "\\");
  CHECK(GltfRead(folder.write("a.gltf", text)).mesh.triangles.size() == 1);
  for (const char* name : {"\1",
                           "\1"
                           "1",
                           "\1"
                           "99999999999999999999",
                           "\1-1"}) {
    expect_refused(folder, one_triangle().gltf(name), {"buffer 0: its file", "is missing"});
  }
}

TEST_CASE("an extension that a file needs and that is not understood is named", "[unit]") {
  const InputFolder folder;
  for (const char* name : {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_texture_basisu"}) {
    GltfModel model = whole();
    model.root["accessors"][3].erase("bufferView");  // which the extension would fill
    model.root["extensionsRequired"] = {"KHR_mesh_quantization", name};
    expect_refused(folder, model.gltf(), {"it needs the extension", name});
  }
}

TEST_CASE("buffers that are missing, short or no base64 are refused", "[unit]") {
  const InputFolder folder;
  folder.write("short.bin", "abc");
  std::filesystem::create_directory(folder / "folder.bin");
  const auto refused = [&](const Json& buffer, std::initializer_list<const char*> parts) {
    Json root = one_triangle().root;
    root["buffers"] = Json::array({buffer});
    expect_refused(folder, root.dump(), parts);
  };
  refused({{"uri", "short.bin"}}, {"buffer 0: it has no byteLength"});
  refused({{"uri", "short.bin"}, {"byteLength", -1}}, {"buffer 0: it has no byteLength"});
  refused({{"uri", "short.bin"}, {"byteLength", 36}}, {"buffer 0: found 3 bytes, expected 36"});
  refused({{"uri", "none.bin"}, {"byteLength", 36}}, {"buffer 0: its file \"none.bin\" is missing"});
  refused({{"uri", "folder.bin"}, {"byteLength", 36}}, {"is missing"});
  refused({{"uri", "/dev/zero"}, {"byteLength", 36}}, {"is missing"});
  refused({{"uri", "a%0Ab\n"}, {"byteLength", 36}}, {"is missing"});
  refused({{"uri", 3}, {"byteLength", 36}}, {"its uri is no text"});
  refused({{"byteLength", 36}}, {"buffer 0: it has no uri"});
  refused({{"uri", "data:;base64"}, {"byteLength", 36}}, {"without a comma"});
  refused({{"uri", "data:;base64,A"}, {"byteLength", 0}}, {"is no base64"});
  refused({{"uri", "data:;base64,AA*="}, {"byteLength", 0}}, {"is no base64"});
  refused({{"uri", "data:;base64,AAA="}, {"byteLength", 3}}, {"found 2 bytes, expected 3"});
  refused({{"uri", "data:,%41%4%"}, {"byteLength", 5}}, {"found 4 bytes, expected 5"});
}

TEST_CASE("indices, sizes and counts that lead astray are refused with what they are of", "[unit]") {
  const InputFolder folder;
  CHECK(GltfRead(folder, whole()).mesh.triangles.size() == 1);
  const std::uint64_t huge = std::numeric_limits<std::uint64_t>::max();
  const auto refused = [&](const char* pointer, const Json& value, std::initializer_list<const char*> parts) {
    GltfModel model = whole();
    model.root[Json::json_pointer(pointer)] = value;
    INFO(pointer << " = " << value.dump().substr(0, 50));
    expect_refused(folder, model.gltf(), parts);
  };
  refused("/scene", 1, {"there is no scene 1"});
  refused("/scene", -2, {"there is no scene -2"});
  refused("/scenes/0/nodes", {2}, {"there is no node 2"});
  refused("/scenes/0/nodes", {-1}, {"there is no node -1"});
  refused("/scenes/0/nodes", {0, 0}, {"node 0 is reached twice"});
  refused("/nodes/0/children", {1}, {"node 1 is reached twice"});
  refused("/nodes/0/children", {0}, {"node 0 is reached twice"});
  refused("/nodes/0/mesh", 1, {"there is no mesh 1"});
  refused("/nodes/0/mesh", -2, {"there is no mesh -2"});
  refused("/nodes/0/matrix", {1, 2}, {"node 0: found a matrix of 2 numbers, expected 16"});
  refused("/nodes/0/rotation", {1, 2, 3}, {"node 0: found a rotation of 3 numbers, expected 4"});
  refused("/nodes/0/scale", {1, 2, 3, 4}, {"node 0: found a scale of 4 numbers, expected 3"});
  refused("/nodes/0/translation", {1}, {"node 0: found a translation of 1 numbers, expected 3"});
  refused("/nodes/0/scale", {1e300, 1, 1}, {"accessor 0: position 1 is not finite"});
  refused("/meshes/0/primitives/0/mode", 7, {"mesh 0, primitive 0: there is no mode 7"});
  refused("/meshes/0/primitives/0/mode", -1, {"there is no mode -1"});
  refused("/meshes/0/primitives/0/material", 1, {"there is no material 1"});
  refused("/meshes/0/primitives/0/material", -2, {"there is no material -2"});
  refused("/meshes/0/primitives/0/indices", 9, {"not readable as glTF"});
  refused("/meshes/0/primitives/0/indices", 0,
          {"mesh 0, primitive 0: indices (accessor 0): found VEC3, expected SCALAR"});
  refused("/meshes/0/primitives/0/attributes/POSITION", 9, {"mesh 0, primitive 0: POSITION: there is no accessor 9"});
  refused("/meshes/0/primitives/0/attributes/POSITION", 2, {"POSITION (accessor 2): found VEC2, expected VEC3"});
  refused("/meshes/0/primitives/0/attributes/NORMAL", -2, {"NORMAL: there is no accessor -2"});
  refused("/materials/0/pbrMetallicRoughness/baseColorTexture/index", 1, {"there is no texture 1"});
  refused("/textures/0/source", 1, {"there is no image 1"});
  refused("/images/0", {{"bufferView", 99}}, {"there is no bufferView 99"});
  refused("/images/0", {{"bufferView", huge}}, {"there is no bufferView"});
  refused("/images/0", {{"name", "a"}}, {"image 0: it has neither uri nor bufferView"});
  refused("/accessors/0/bufferView", 99, {"there is no bufferView 99"});
  refused("/accessors/0/byteOffset", 4, {"POSITION (accessor 0): it goes beyond the end of bufferView 0"});
  refused("/accessors/0/byteOffset", huge, {"goes beyond the end of bufferView 0"});
  refused("/accessors/1/count", 4, {"NORMAL (accessor 1): it goes beyond the end of bufferView 1"});
  refused("/accessors/1/count", 2, {"NORMAL: found 2 elements, expected 3"});
  refused("/accessors/1/count", huge, {"more than 4294967295 elements"});
  refused("/accessors/1/count", 4294967295u, {"goes beyond the end"});
  refused("/accessors/1/componentType", 5125, {"component type 5125 is not supported"});
  refused("/accessors/1/componentType", 5130, {"component type 5130 is not supported"});
  refused("/accessors/3/componentType", 5126, {"component type 5126 is not supported"});
  refused("/accessors/3/componentType", 5120, {"component type 5120 is not supported"});
  refused("/accessors/0/type", "MAT4", {"found a matrix, expected VEC3"});
  refused("/accessors/0/sparse/count", 4, {"more sparse elements than elements"});
  refused("/accessors/0/sparse/count", -1, {"more sparse elements than elements"});
  refused("/accessors/0/sparse/count", 3, {"its sparse indices: it goes beyond the end of bufferView 4"});
  refused("/accessors/0/sparse/indices/bufferView", 9, {"there is no bufferView 9"});
  refused("/accessors/0/sparse/indices/byteOffset", 2, {"its sparse indices: it goes beyond"});
  refused("/accessors/0/sparse/indices/componentType", 5126, {"its sparse indices are no unsigned integers"});
  refused("/accessors/0/sparse/indices", {{"bufferView", 0}, {"byteOffset", 12}, {"componentType", 5123}},
          {"accessor 0: sparse index 16256, expected below 3"});
  refused("/accessors/0/sparse/values/byteOffset", 16, {"its sparse values: it goes beyond"});
  refused("/bufferViews/0/buffer", 1, {"bufferView 0: there is no buffer 1"});
  refused("/bufferViews/0/buffer", -1, {"bufferView 0: there is no buffer -1"});
  refused("/bufferViews/0/byteOffset", huge, {"bufferView 0: it goes beyond the end of buffer 0"});
  refused("/bufferViews/0/byteLength", huge, {"bufferView 0: it goes beyond the end of buffer 0"});
  refused("/bufferViews/0/byteStride", 8, {"elements that overlap each other"});
  refused("/bufferViews/0/byteStride", 16, {"it goes beyond the end of bufferView 0"});
  refused("/bufferViews/0/byteStride", huge, {"not readable as glTF"});
}

TEST_CASE("indices of vertices that are sparse or not there, and positions that are not finite, are refused",
          "[unit]") {
  const InputFolder folder;
  GltfModel beyond = one_triangle();
  beyond.root["meshes"][0]["primitives"][0]["indices"] = beyond.accessor(std::vector<std::uint8_t>{0, 3, 1}, 1);
  expect_refused(folder, beyond.gltf(), {"accessor 1: found index 3, expected below 3 as there are positions"});
  GltfModel model = whole();
  model.root["accessors"][3]["sparse"] = model.root["accessors"][0]["sparse"];
  expect_refused(folder, model.gltf(), {"sparse indices of vertices are not supported"});
  for (const float bad : {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
    GltfModel infinite;
    infinite.mesh({{"POSITION", infinite.accessor(std::vector<float>{0, 0, 0, 1, bad, 0, 0, 1, 0}, 3)}});
    expect_refused(folder, infinite.gltf(), {"accessor 0: position 1 is not finite"});
  }
}

TEST_CASE("nodes that are all children of others are refused", "[unit]") {
  const InputFolder folder;
  GltfModel model = one_triangle();
  model.root["nodes"] = {{{"children", {1}}}, {{"children", {0}}}};
  expect_refused(folder, model.gltf(), {"every node is a child"});
}

TEST_CASE("a small file may not ask for a large mesh", "[unit]") {
  const InputFolder folder;
  GltfModel zeros = one_triangle();
  zeros.root["accessors"][0].erase("bufferView");
  zeros.root["accessors"][0]["count"] = 4000000000u;
  expect_refused(folder, zeros.gltf(), {"4000000000 vertices", "exceed this file's budget of 64 MiB"});

  GltfModel forest;
  const int positions = forest.accessor(std::vector<float>(3 * 3000), 3);
  forest.mesh({{"POSITION", positions}});
  for (int i = 0; i < 3000; ++i) forest.push("nodes", {{"mesh", 0}});
  expect_refused(folder, forest.gltf(), {"exceed this file's budget"});

  GltfModel laughs = one_triangle();
  const Json empty = {{"attributes", Json::object()}};
  for (int i = 0; i < 3000; ++i) laughs.root["meshes"][0]["primitives"].push_back(empty);
  for (int i = 0; i < 10000; ++i) laughs.push("nodes", {{"mesh", 0}});
  expect_refused(folder, laughs.gltf(), {"exceed this file's budget"});
}

TEST_CASE("buffers that name one file read it once", "[unit]") {
  const InputFolder folder;
  folder.write("a.bin", std::string(1 << 20, '\0'));
  Json root = GltfModel().root;
  for (int i = 0; i < 5000; ++i) root["buffers"].push_back({{"uri", i % 2 ? "a.bin" : "./a.bin"}, {"byteLength", 9}});
  const GltfRead read(folder.write("a.gltf", root.dump()));
  CHECK(read.library.files.size() == 2);
}
