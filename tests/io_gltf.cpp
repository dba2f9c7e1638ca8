// Meshes of glTF files: containers, nodes, primitives and accessors.
#include <cmath>
#include <limits>

#include "catch.hpp"
#include "gltf_files.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

const std::vector<vec3> kTriangle = {vec3(0, 0, 0), vec3(1, 0, 0), vec3(0, 1, 0)};

std::vector<vec3> corners(const InputFolder& folder, const GltfModel& model) {
  return corners_of(GltfRead(folder, model).mesh);
}

bool near_to(const vec3& a, const vec3& b) { return glm::length(a - b) < 1e-6f; }

bool warns(const GltfRead& read, const InputFolder& folder, const char* part) {
  return any_line(read.library.warnings, folder.at("a.gltf"), {part});
}

}  // namespace

TEST_CASE("a triangle of a .gltf file, with its buffer in the text or beside it, and of a .glb file", "[unit]") {
  const InputFolder folder;
  const GltfModel model = one_triangle();
  folder.write("b c.bin", model.buffer);
  const auto beside = folder.write("beside.gltf", model.gltf("b%20c.bin"));
  for (const auto& file :
       {folder.write("a.gltf", model.gltf()), folder.write("bom.gltf", "\xef\xbb\xbf" + model.gltf()),
        folder.write("a.glb", model.glb()), folder.write("any.name", model.glb()), beside}) {
    INFO(file);
    const GltfRead read(file);
    CHECK(corners_of(read.mesh) == kTriangle);
    CHECK(read.mesh.normals.empty());
    CHECK(read.mesh.texcoords.empty());
    CHECK(read.mesh.positions.capacity() >= read.mesh.positions.size() + 2);
    CHECK(read.library.warnings.empty());
    CHECK(read.library.files.front() == file);
    CHECK(read.library.files.size() == (file == beside ? 2 : 1));
  }
}

TEST_CASE("chunks of a .glb file that are not known are left out", "[unit]") {
  const InputFolder folder;
  const GltfModel model = one_triangle();
  const std::string glb = model.glb();
  const auto file = folder.write("a.glb", glb_of(chunk("WHAT", "abcd") + glb.substr(12) + chunk("ELSE", "")));
  CHECK(corners_of(GltfRead(file).mesh) == kTriangle);
}

TEST_CASE("nodes place meshes by translation, rotation and scale, or a matrix, one within the other", "[unit]") {
  const InputFolder folder;
  GltfModel model = one_triangle();
  const double half = std::sqrt(0.5);
  model.push("nodes", {{"translation", {0, 0, 5}}, {"children", {1}}});
  model.push("nodes", {{"mesh", 0},
                       {"translation", {10, 0, 0}},
                       {"rotation", {0, 0, half, half}},  // a quarter turn from x to y
                       {"scale", {2, 3, 4}}});
  model.push("nodes", {{"mesh", 0}, {"matrix", {0, 2, 0, 0, -3, 0, 0, 0, 0, 0, 4, 0, 10, 0, 0, 1}}});
  const auto points = corners(folder, model);
  REQUIRE(points.size() == 6);
  const vec3 expected[] = {vec3(10, 0, 0), vec3(10, 2, 0), vec3(7, 0, 0)};
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(near_to(points[i], expected[i] + vec3(0, 0, 5)));
    CHECK(near_to(points[i + 3], expected[i]));
  }
}

TEST_CASE("placing is done in double precision", "[unit]") {
  const InputFolder folder;
  GltfModel model = one_triangle();
  model.push("nodes", {{"children", {1}}, {"translation", {1e12, 0, 0}}});
  model.push("nodes", {{"mesh", 0}, {"translation", {-1e12, 0, 0}}});
  CHECK(corners(folder, model) == kTriangle);
}

TEST_CASE("a mirrored mesh faces the same way, and its normals stand on it", "[unit]") {
  const InputFolder folder;
  GltfModel model;
  const int positions = model.accessor(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, -1}, 3);
  const int normals = model.accessor(std::vector<float>{0, 1, 1, 0, 2, 2, 0, 1, 1}, 3);
  model.mesh({{"POSITION", positions}, {"NORMAL", normals}});
  for (const auto& scale : {vec3(1, 1, 1), vec3(1, 1, 4), vec3(-1, 1, 1), vec3(-1, -2, -3), vec3(2, -1, 1)}) {
    model.root["nodes"] = {{{"mesh", 0}, {"scale", {scale.x, scale.y, scale.z}}}};
    const GltfRead read(folder, model);
    const Triangle t = triangle_corners(read.mesh, 0);
    const vec3 face = glm::normalize(glm::cross(t.p1 - t.p0, t.p2 - t.p0));
    for (const vec3& normal : read.mesh.normals) CHECK(near_to(normal, face));
    const float faces_outwards = face.z * scale.z;
    CHECK(faces_outwards > 0.0f);
  }
}

TEST_CASE("a mesh that is scaled to a plane keeps its normals across the plane, and no other", "[unit]") {
  const InputFolder folder;
  GltfModel model;
  const int normals = model.accessor(std::vector<float>{0, 0, 1, 1, 0, 1, 1, 0, 0}, 3);
  model.mesh({{"POSITION", model.accessor(kCorners, 3)}, {"NORMAL", normals}});
  model.root["nodes"] = {{{"mesh", 0}, {"scale", {1, 1, 0}}}};
  const GltfRead read(folder, model);
  for (int c = 0; c < 3; ++c) CHECK(read.mesh.normals[read.mesh.normal_corners(0)[c]] == vec3(0, 0, 1));
  CHECK(warns(read, folder, "normals of length zero or not finite, replaced by those of the faces: 1"));
}

TEST_CASE("the default scene is read, or all roots where none is, or all meshes where there are no nodes", "[unit]") {
  const InputFolder folder;
  GltfModel model = one_triangle();
  model.mesh({{"POSITION", 0}});
  const auto count = [&] { return GltfRead(folder, model).mesh.triangles.size(); };
  CHECK(count() == 2);
  model.root["nodes"] = {{{"mesh", 0}, {"children", {3}}}, {{"mesh", 0}}, {{"mesh", 1}}, {{"mesh", 1}}, Json::object()};
  CHECK(count() == 4);
  model.root["scenes"] = {{{"nodes", {0}}}, {{"nodes", {2}}}};
  CHECK(count() == 4);
  model.root["scene"] = 0;
  const GltfRead first(folder, model);
  CHECK(first.mesh.triangles.size() == 2);
  CHECK(warns(first, folder, "scenes other than the default one"));
  model.root["scene"] = 1;
  CHECK(count() == 1);
}

TEST_CASE("a chain of very many nodes is followed to its end", "[unit]") {
  const InputFolder folder;
  GltfModel model = one_triangle();
  constexpr int count = 30000;
  for (int i = 0; i < count; ++i) model.push("nodes", {{"children", {i + 1}}, {"translation", {1, 0, 0}}});
  model.push("nodes", {{"mesh", 0}});
  CHECK(corners(folder, model)[0] == vec3(count, 0, 0));
}

TEST_CASE("triangles, strips and fans, with and without indices; points and lines are left out", "[unit]") {
  const InputFolder folder;
  const std::vector<float> five = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 2, 2, 0};
  const auto triangles = [&](int mode, const std::vector<std::uint16_t>& indices, const char* warning) {
    GltfModel model;
    Json more = {{"mode", mode}};
    const int positions = model.accessor(five, 3);
    if (!indices.empty()) more["indices"] = model.accessor(indices, 1);
    model.mesh({{"POSITION", positions}}, more);
    const GltfRead read(folder, model);
    CHECK(joined(read.library.warnings).find(warning) != std::string::npos);
    CHECK(read.library.warnings.size() == (*warning == '\0' ? 0 : mode < 4 ? 2 : 1));
    return read.mesh.triangles;
  };
  using List = std::vector<uvec3>;
  CHECK(triangles(4, {}, "corners after the last whole triangle") == List{uvec3(0, 1, 2)});
  CHECK(triangles(4, {4, 3, 2, 0, 1, 2}, "") == List{uvec3(4, 3, 2), uvec3(0, 1, 2)});
  CHECK(triangles(5, {}, "") == List{uvec3(0, 1, 2), uvec3(1, 3, 2), uvec3(2, 3, 4)});
  CHECK(triangles(5, {0, 1, 2, 2, 3, 3, 4, 0}, "") == List{uvec3(0, 1, 2), uvec3(3, 0, 4)});
  CHECK(triangles(6, {}, "") == List{uvec3(1, 2, 0), uvec3(2, 3, 0), uvec3(3, 4, 0)});
  CHECK(triangles(6, {4, 3, 2, 1}, "") == List{uvec3(3, 2, 4), uvec3(2, 1, 4)});
  CHECK(triangles(4, {0, 1, 1, 0, 1, 2}, "fewer than 3 distinct corners, left out: 1") == List{uvec3(0, 1, 2)});
  for (int mode = 0; mode < 4; ++mode) CHECK(triangles(mode, {}, "points and lines are left out").empty());
}

TEST_CASE("indices of one, two and four bytes", "[unit]") {
  const InputFolder folder;
  const auto read = [&](const auto& indices) {
    GltfModel model;
    const int positions = model.accessor(kCorners, 3);
    const int index = model.accessor(indices, 1);
    model.mesh({{"POSITION", positions}}, {{"indices", index}});
    return GltfRead(folder, model).mesh.triangles;
  };
  const std::vector<uvec3> expected = {uvec3(2, 0, 1)};
  CHECK(read(std::vector<std::uint8_t>{2, 0, 1}) == expected);
  CHECK(read(std::vector<std::uint16_t>{2, 0, 1}) == expected);
  CHECK(read(std::vector<std::uint32_t>{2, 0, 1}) == expected);
}

TEST_CASE("integers as positions are taken as they are, or as parts of one where they are normalized", "[unit]") {
  const InputFolder folder;
  const auto third = [&](const auto& values, bool normalized) {
    GltfModel model;
    model.mesh({{"POSITION", model.accessor(values, 3)}});
    model.root["accessors"][0]["normalized"] = normalized;
    model.root["extensionsRequired"] = {"KHR_mesh_quantization"};
    return corners(folder, model).at(2);
  };
  const std::vector<std::int8_t> bytes = {0, 0, 0, 1, 0, 0, 127, -127, -128};
  CHECK(third(bytes, false) == vec3(127, -127, -128));
  CHECK(third(bytes, true) == vec3(1, -1, -1));
  const std::vector<std::uint8_t> unsigned_bytes = {0, 0, 0, 1, 0, 0, 255, 51, 0};
  CHECK(third(unsigned_bytes, false) == vec3(255, 51, 0));
  CHECK(third(unsigned_bytes, true) == vec3(1, 0.2f, 0));
  const std::vector<std::int16_t> shorts = {0, 0, 0, 1, 0, 0, 32767, -32767, -32768};
  CHECK(third(shorts, false) == vec3(32767, -32767, -32768));
  CHECK(third(shorts, true) == vec3(1, -1, -1));
  const std::vector<std::uint16_t> unsigned_shorts = {0, 0, 0, 1, 0, 0, 65535, 13107, 0};
  CHECK(third(unsigned_shorts, false) == vec3(65535, 13107, 0));
  CHECK(third(unsigned_shorts, true) == vec3(1, 0.2f, 0));
}

TEST_CASE("accessors begin and step as they and their bufferViews say, wherever that is", "[unit]") {
  const InputFolder folder;
  GltfModel model;
  std::string bytes = "0123456";  // so that floats lie at odd places
  for (int corner = 0; corner < 3; ++corner) {
    bytes += "--" +
             GltfModel::bytes_of(std::vector<float>(kCorners.begin() + 3 * corner, kCorners.begin() + 3 * corner + 3)) +
             "--";
  }
  model.view(bytes, 16);
  model.push("accessors",
             {{"bufferView", 0}, {"byteOffset", 9}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}});
  model.mesh({{"POSITION", 0}});
  CHECK(corners(folder, model) == kTriangle);
}

TEST_CASE("sparse accessors change some elements of a bufferView, or of zeros", "[unit]") {
  const InputFolder folder;
  GltfModel model = one_triangle();
  const int indices = model.view(GltfModel::bytes_of(std::vector<std::uint16_t>{0, 2}));
  const int values = model.view(GltfModel::bytes_of(std::vector<float>{7, 8, 9, 4, 5, 6}));
  Json& accessor = model.root["accessors"][0];
  accessor["sparse"] = {{"count", 2},
                        {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
                        {"values", {{"bufferView", values}}}};
  CHECK(corners(folder, model) == std::vector<vec3>{vec3(7, 8, 9), vec3(1, 0, 0), vec3(4, 5, 6)});
  accessor.erase("bufferView");
  CHECK(corners(folder, model) == std::vector<vec3>{vec3(7, 8, 9), vec3(0, 0, 0), vec3(4, 5, 6)});
  accessor.erase("sparse");
  CHECK(corners(folder, model) == std::vector<vec3>(3, vec3(0)));
  accessor["sparse"] = {{"count", 1},
                        {"indices", {{"bufferView", indices}, {"componentType", 5121}, {"byteOffset", 2}}},
                        {"values", {{"bufferView", values}, {"byteOffset", 12}}}};
  CHECK(corners(folder, model) == std::vector<vec3>{vec3(0), vec3(0), vec3(4, 5, 6)});
}

TEST_CASE("normals are of unit length; corners without one get that of the face where others have some", "[unit]") {
  const InputFolder folder;
  GltfModel model;
  const int positions = model.accessor(kCorners, 3);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const int normals = model.accessor(std::vector<float>{0, 0, 5, 3, 0, 4, 0, 1e-30f, 0}, 3);
  const int bad = model.accessor(std::vector<float>{0, 0, 0, nan, 0, 0, 0, 2, 0}, 3);
  model.mesh({{"POSITION", positions}, {"NORMAL", normals}});
  const GltfRead whole(folder, model);
  CHECK(whole.mesh.normals == std::vector<vec3>{vec3(0, 0, 1), vec3(0.6f, 0, 0.8f), vec3(0, 1, 0)});
  CHECK(whole.mesh.normal_indices.empty());

  model.mesh({{"POSITION", positions}});
  model.mesh({{"POSITION", positions}, {"NORMAL", bad}});
  const GltfRead mixed(folder, model);
  REQUIRE(mixed.mesh.triangles.size() == 3);
  const auto normal = [&](std::uint32_t triangle, int corner) {
    return mixed.mesh.normals.at(mixed.mesh.normal_corners(triangle)[corner]);
  };
  CHECK(normal(0, 1) == vec3(0.6f, 0, 0.8f));
  for (int c = 0; c < 3; ++c) CHECK(normal(1, c) == vec3(0, 0, 1));
  CHECK(normal(2, 0) == vec3(0, 0, 1));
  CHECK(normal(2, 1) == vec3(0, 0, 1));
  CHECK(normal(2, 2) == vec3(0, 1, 0));
  CHECK(warns(mixed, folder, "replaced by those of the faces: 2"));
}

TEST_CASE("v of texture coordinates runs up, and corners without them have (0, 0)", "[unit]") {
  const InputFolder folder;
  GltfModel model;
  const int positions = model.accessor(kCorners, 3);
  const int texcoords = model.accessor(std::vector<float>{0, 0, 0.25f, 1, 2, -0.5f}, 2);
  const int bytes = model.accessor(std::vector<std::uint8_t>{0, 0, 51, 255, 255, 0}, 2);
  model.root["accessors"][2]["normalized"] = true;
  model.mesh({{"POSITION", positions}, {"TEXCOORD_0", texcoords}});
  model.mesh({{"POSITION", positions}});
  model.mesh({{"POSITION", positions}, {"TEXCOORD_0", bytes}});
  const GltfRead read(folder, model);
  CHECK(read.mesh.texcoord_indices.empty());
  CHECK(read.mesh.texcoords == std::vector<vec2>{vec2(0, 1), vec2(0.25f, 0), vec2(2, 1.5f), vec2(0), vec2(0), vec2(0),
                                                 vec2(0, 1), vec2(0.2f, 0), vec2(1, 1)});
}

TEST_CASE("primitives of one mesh that share their vertices share them in the mesh that is read", "[unit]") {
  const InputFolder folder;
  GltfModel model;
  const int positions = model.accessor(kCorners, 3);
  const int normals = model.accessor(std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1}, 3);
  const Json plain = {{"attributes", {{"POSITION", positions}}}};
  const Json smooth = {{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}};
  model.push("meshes", {{"primitives", {plain, smooth, plain, smooth}}});
  model.root["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"translation", {0, 0, 1}}}};
  const GltfRead read(folder, model);
  CHECK(read.mesh.positions.size() == 12);
  REQUIRE(read.mesh.triangles.size() == 8);
  CHECK(read.mesh.triangles[2] == read.mesh.triangles[0]);
  CHECK(read.mesh.triangles[3] == read.mesh.triangles[1]);
  CHECK(read.mesh.triangles[4] == uvec3(6, 7, 8));
}

TEST_CASE("what of a file is not shown is said once", "[unit]") {
  const InputFolder folder;
  GltfModel model;
  const int positions = model.accessor(kCorners, 3);
  const Json target = {{"POSITION", positions}};
  for (int i = 0; i < 2; ++i) {
    model.mesh({{"POSITION", positions}, {"COLOR_0", positions}}, {{"targets", Json::array({target})}});
    model.mesh({{"NORMAL", positions}});
  }
  model.root["nodes"] = {{{"mesh", 0}, {"matrix", {1, 0, 0, 0.5, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}},
                         {{"mesh", 1}},
                         {{"mesh", 2}},
                         {{"mesh", 3}}};
  for (const char* name : {"animations", "cameras"}) model.root[name] = Json::array({Json::object()});
  model.root["skins"] = Json::array();
  model.root["extensionsUsed"] = {"KHR_lights_punctual", "KHR_materials_ior"};
  const GltfRead read(folder, model);
  INFO(joined(read.library.warnings));
  for (const char* part :
       {"its animations are left out", "its cameras are left out", "\"KHR_lights_punctual\" is left out",
        "morph targets", "colours of vertices", "primitives without positions", "matrices that are not affine"}) {
    CHECK(warns(read, folder, part));
  }
  CHECK(read.library.warnings.size() == 7);
}

TEST_CASE("a file of no triangles is an empty mesh with a warning", "[unit]") {
  const InputFolder folder;
  const GltfRead read(folder, GltfModel());
  CHECK(read.mesh.triangles.empty());
  CHECK(warns(read, folder, "no triangles"));
}
