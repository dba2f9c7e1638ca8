// What a PLY file says is what the mesh holds; every bad one is refused with its place and the value found.
#include <limits>

#include "catch.hpp"
#include "expect_error.hpp"
#include "io/ply_file.hpp"
#include "io_files.hpp"
#include "raylab/image/image_file.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

constexpr std::endian kLittle = std::endian::little, kBig = std::endian::big;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

struct ReadPly {
  MaterialLibrary library;
  TriangleMesh mesh;
  MeshMaterials materials;
};

ReadPly read_ply(const InputFolder& folder, const std::string& bytes, const ObjOptions& options = {}) {
  ReadPly read;
  MeshWithMaterials mesh = read_ply_into(read.library, folder.write("mesh.ply", bytes), options);
  read.mesh = std::move(mesh.mesh);
  read.materials = std::move(mesh.materials);
  return read;
}

/// A mesh whose file gives no warning.
TriangleMesh mesh_of(const std::string& bytes) {
  const InputFolder folder;
  ReadPly read = read_ply(folder, bytes);
  INFO(joined(read.library.warnings));
  CHECK(read.library.warnings.empty());
  return std::move(read.mesh);
}

std::string header(const std::string& format, const std::string& lines) {
  return "ply\nformat " + format + " 1.0\n" + lines + "end_header\n";
}

std::string binary(std::endian order) { return order == kLittle ? "binary_little_endian" : "binary_big_endian"; }

const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";
const std::string kIndices = "property list uchar int vertex_indices\n";
const std::string kThree = "element vertex 3\n" + kXyz;
const std::string kFour = "element vertex 4\n" + kXyz;
const std::string kOneFace = "element face 1\n" + kIndices;
const std::string kCorners = "0 0 0\n1 0 0\n0 1 0\n";
const std::string kSquare = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
const std::vector<vec3> kPositions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

std::string corners(std::endian order) { return bytes_of(order, 0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, 1.0f, 0.0f); }

void check_triangle(const TriangleMesh& mesh) {
  CHECK(mesh.positions == kPositions);
  CHECK(mesh.triangles == std::vector<uvec3>{{0, 1, 2}});
  CHECK(mesh.normals.empty());
  CHECK(mesh.texcoords.empty());
  CHECK(mesh.positions.capacity() >= mesh.positions.size() + 2);
}

struct BadPly {
  std::string bytes;
  std::string place;  ///< ":LINE" or ", byte N"
  std::vector<const char*> parts;
};

void expect_all(const std::vector<BadPly>& files) {
  const InputFolder folder;
  for (const BadPly& bad : files) {
    INFO(bad.bytes);
    for (const char* part : bad.parts) {
      expect_error(ErrorKind::input, folder.at("mesh.ply" + bad.place), {part}, [&] { read_ply(folder, bad.bytes); });
    }
  }
}

}  // namespace

TEST_CASE("PLY files of all three formats are read", "[unit]") {
  check_triangle(mesh_of(header("ascii", kThree + kOneFace) + kCorners + "3 0 1 2\n"));
  for (const std::endian order : {kLittle, kBig}) {
    check_triangle(mesh_of(header(binary(order), kThree + kOneFace) + corners(order) + bytes_of(order, '\3', 0, 1, 2)));
  }
}

TEST_CASE("a PLY file is one of the files read, and has the default material unless that is ignored", "[unit]") {
  const InputFolder folder;
  const std::string triangle = header("ascii", kThree + kOneFace) + kCorners + "3 0 1 2\n";
  const ReadPly read = read_ply(folder, triangle);
  CHECK(read.library.files == std::vector{folder / "mesh.ply"});
  REQUIRE(read.library.materials.size() == 1);
  CHECK(read.library.materials[0].name == "default");
  CHECK(read.materials.per_triangle.empty());
  CHECK(read_ply(folder, triangle, {.ignore_materials = true}).library.materials.empty());
}

TEST_CASE("PLY numbers of every type are read, under both their names", "[unit]") {
  for (const std::endian order : {kLittle, kBig}) {
    const auto triangle = [&](const std::string& real, const std::string& count, const std::string& index,
                              const std::string& bytes) {
      INFO(real << " " << count << " " << index);
      check_triangle(mesh_of(header(binary(order), "element vertex 3\nproperty " + real + " x\nproperty " + real +
                                                       " y\nproperty " + real + " z\nelement face 1\nproperty list " +
                                                       count + " " + index + " vertex_index\n") +
                             bytes));
    };
    const auto bytes = [&](auto zero, auto three, auto null) {
      const auto real = [&](int x) { return static_cast<decltype(zero)>(x); };
      const auto index = [&](int x) { return static_cast<decltype(null)>(x); };
      return bytes_of(order, zero, zero, zero, real(1), zero, zero, zero, real(1), zero, three, null, index(1),
                      index(2));
    };
    using std::int16_t, std::int32_t, std::int8_t, std::uint16_t, std::uint32_t, std::uint8_t;
    for (const bool sized : {false, true}) {
      const auto name = [&](const char* plain, const char* with_size) { return sized ? with_size : plain; };
      triangle(name("double", "float64"), name("char", "int8"), name("uint", "uint32"),
               bytes(0.0, int8_t{3}, uint32_t{0}));
      triangle(name("float", "float32"), name("ushort", "uint16"), name("uchar", "uint8"),
               bytes(0.0f, uint16_t{3}, uint8_t{0}));
      triangle(name("short", "int16"), name("int", "int32"), name("short", "int16"),
               bytes(int16_t{0}, int32_t{3}, int16_t{0}));
      triangle(name("uchar", "uint8"), name("uint", "uint32"), name("ushort", "uint16"),
               bytes(uint8_t{0}, uint32_t{3}, uint16_t{0}));
      triangle(name("int", "int32"), name("short", "int16"), name("char", "int8"),
               bytes(int32_t{0}, int16_t{3}, int8_t{0}));
      triangle(name("char", "int8"), name("uchar", "uint8"), name("int", "int32"),
               bytes(int8_t{0}, uint8_t{3}, int32_t{0}));
      triangle(name("float", "float32"), name("float", "float32"), name("double", "float64"), bytes(0.0f, 3.0f, 0.0));
    }
  }
}

TEST_CASE("PLY elements come in any order, and what is not understood is passed over", "[unit]") {
  const std::string lines = "obj_info made by hand\nelement camera 1\nproperty float view\n" + kOneFace +
                            "property uchar flags\nelement empty 4000000000\nelement edge 2\n"
                            "property list uchar short ends\nproperty int length\nelement vertex 3\n"
                            "property list ushort double weights\nproperty float z\nproperty double y\n"
                            "property uchar quality\nproperty float x\n";
  check_triangle(mesh_of(header("ascii", lines) + "7.5\n3 0 1 2 255\n2 0 1 -7\n0 9\n0 0 0 5 0\n2 1.5 2.5 0 0 6 1\n"
                                                  "1 9 0 1 7 0\n"));
  using std::uint16_t, std::int16_t;
  for (const std::endian order : {kLittle, kBig}) {
    check_triangle(mesh_of(header(binary(order), lines) +
                           bytes_of(order, 7.5f, '\3', 0, 1, 2, '\xff', '\2', int16_t{0}, int16_t{1}, -7, '\0', 9) +
                           bytes_of(order, uint16_t{0}, 0.0f, 0.0, '\5', 0.0f) +
                           bytes_of(order, uint16_t{2}, 1.5, 2.5, 0.0f, 0.0, '\6', 1.0f) +
                           bytes_of(order, uint16_t{1}, 9.0, 0.0f, 1.0, '\7', 0.0f)));
  }
}

TEST_CASE("PLY faces of three corners are read alike with properties around their indices", "[unit]") {
  const std::string lines =
      kFour + "element face 4\nproperty double before\n" + kIndices + "property uchar after\nproperty short more\n";
  for (const std::endian order : {kLittle, kBig}) {
    std::string bytes = header(binary(order), lines) + corners(order) + bytes_of(order, 1.0f, 1.0f, 0.0f);
    const auto face = [&](auto... indices) {
      bytes += bytes_of(order, 9.0, static_cast<char>(sizeof...(indices)), indices..., '\1', short{2});
    };
    face(0, 1, 2);
    face(0, 1, 3, 2);
    face(2, 1, 3);
    face(3, 2, 0);
    CHECK(mesh_of(bytes).triangles == std::vector<uvec3>{{0, 1, 2}, {0, 1, 3}, {0, 3, 2}, {2, 1, 3}, {3, 2, 0}});
  }
}

TEST_CASE("PLY lines end in any of three ways, and a binary file begins right behind the header", "[unit]") {
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    const auto lines = [&](std::string text) {
      for (std::size_t at = 0; (at = text.find('\n', at)) != text.npos; at += end.size()) text.replace(at, 1, end);
      return text;
    };
    check_triangle(mesh_of("\xEF\xBB\xBF" + lines(header("ascii", kThree + kOneFace) + "\n" + kCorners + "\n3 0 1 2")));
    // The first bytes look like a line end.
    const std::string bytes = bytes_of(kLittle, short{0x0d0a}, '\n', 0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f);
    const TriangleMesh mesh = mesh_of(
        lines(header(binary(kLittle), "element mark 1\nproperty short a\nproperty uchar b\n" + kThree + kOneFace)) +
        bytes + bytes_of(kLittle, 0.0f, 1.0f, 0.0f, '\3', 0, 1, 2));
    check_triangle(mesh);
  }
}

TEST_CASE("PLY polygons are split as those of OBJ files, concave ones too", "[unit]") {
  const std::string lines = "element vertex 4\n" + kXyz + kOneFace;
  CHECK(mesh_of(header("ascii", lines) + kSquare + "4 0 1 2 3\n").triangles ==
        std::vector<uvec3>{{0, 1, 2}, {0, 2, 3}});
  const TriangleMesh dart = mesh_of(header("ascii", lines) + "0 0 0\n4 4 0\n0 1 0\n-4 4 0\n4 0 1 2 3\n");
  REQUIRE(dart.triangles.size() == 2);
  for (std::uint32_t i = 0; i < 2; ++i) {
    const Triangle t = triangle_corners(dart, i);
    CHECK(glm::cross(t.p1 - t.p0, t.p2 - t.p0).z > 0.0f);
  }
}

TEST_CASE("PLY faces of fewer than three distinct corners are left out with a warning", "[unit]") {
  const InputFolder folder;
  const std::string faces = "element face 4\n" + kIndices;
  const ReadPly text = read_ply(folder, header("ascii", kThree + faces) + kCorners + "3 0 1 2\n2 0 1\n3 0 1 1\n0\n");
  CHECK(text.mesh.triangles.size() == 1);
  CHECK(any_line(text.library.warnings, folder.at("mesh.ply:14"), {"fewer than 3", ": 3,"}));
  const std::string head = header(binary(kLittle), kThree + faces);
  const ReadPly bytes = read_ply(folder, head + corners(kLittle) + bytes_of(kLittle, '\3', 0, 1, 2, '\2', 0, 1) +
                                             bytes_of(kLittle, '\3', 0, 1, 1, '\0'));
  CHECK(bytes.mesh.triangles.size() == 1);
  const std::string place = "mesh.ply, byte " + std::to_string(head.size() + 36 + 13);
  CHECK(any_line(bytes.library.warnings, folder.at(place), {"fewer than 3", ": 3,"}));
}

TEST_CASE("PLY triangle strips turn every second triangle, and end at -1", "[unit]") {
  const std::string lines = kFour + "element tristrips 2\nproperty list int int vertex_indices\n";
  CHECK(mesh_of(header("ascii", lines) + kSquare + "4 0 1 2 3\n9 3 2 1 -1 0 1 1 2 3\n").triangles ==
        std::vector<uvec3>{{0, 1, 2}, {2, 1, 3}, {3, 2, 1}, {1, 2, 3}});
}

TEST_CASE("PLY normals are made unit length, and those of length zero replaced by the face's with a warning",
          "[unit]") {
  const std::string lines =
      kThree + "property float nx\nproperty float ny\nproperty float nz\nelement face 2\n" + kIndices;
  const InputFolder folder;
  const ReadPly text =
      read_ply(folder, header("ascii", lines) + "0 0 0 0 3e30 4e30\n1 0 0 0 0 0\n0 1 0 0 0 -0\n3 0 1 2\n3 0 2 1\n");
  const ReadPly bytes = read_ply(folder, header(binary(kBig), lines) +
                                             bytes_of(kBig, 0.0f, 0.0f, 0.0f, 0.0f, 3e30f, 4e30f, 1.0f, 0.0f, 0.0f) +
                                             bytes_of(kBig, 0.0f, 0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, -0.0f) +
                                             bytes_of(kBig, '\3', 0, 1, 2, '\3', 0, 2, 1));
  for (const TriangleMesh& mesh : {text.mesh, bytes.mesh}) {
    const auto normal = [&](std::uint32_t face, int corner) {
      return mesh.normals.at(mesh.normal_corners(face)[corner]);
    };
    CHECK(glm::length(normal(0, 0) - vec3(0.0f, 0.6f, 0.8f)) < 1e-6f);
    CHECK(normal(0, 1) == vec3(0.0f, 0.0f, 1.0f));
    CHECK(normal(0, 2) == vec3(0.0f, 0.0f, 1.0f));
    CHECK(normal(1, 2) == vec3(0.0f, 0.0f, -1.0f));
  }
  CHECK(any_line(text.library.warnings, folder.at("mesh.ply:14"), {"length zero", ": 2,"}));
}

TEST_CASE("PLY normals and texture coordinates of vertices share the positions' indices", "[unit]") {
  const std::string normals = "property float nx\nproperty float ny\nproperty float nz\n";
  using Names = std::pair<const char*, const char*>;
  for (const auto& [u, v] : {Names("s", "t"), Names("u", "v"), Names("texture_u", "texture_v")}) {
    const std::string lines = kThree + normals + "property float " + u + "\nproperty float " + v + "\n" + kOneFace;
    const TriangleMesh mesh =
        mesh_of(header("ascii", lines) + "0 0 0 1 0 0 0.5 1\n1 0 0 0 2 0 0 0.25\n0 1 0 0 0 3 1 1\n3 0 1 2\n");
    CHECK(mesh.normals == std::vector<vec3>{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
    CHECK(mesh.texcoords == std::vector<vec2>{{0.5f, 1.0f}, {0.0f, 0.25f}, {1.0f, 1.0f}});
    CHECK(mesh.normal_indices.empty());
    CHECK(mesh.texcoord_indices.empty());
    const auto vertex = [](auto... numbers) { return bytes_of(kLittle, static_cast<float>(numbers)...); };
    const TriangleMesh same =
        mesh_of(header(binary(kLittle), lines) + vertex(0, 0, 0, 1, 0, 0, 0.5, 1) + vertex(1, 0, 0, 0, 2, 0, 0, 0.25) +
                vertex(0, 1, 0, 0, 0, 3, 1, 1) + bytes_of(kLittle, '\3', 0, 1, 2));
    CHECK(same.normals == mesh.normals);
    CHECK(same.texcoords == mesh.texcoords);
    CHECK(same.triangles == mesh.triangles);
  }
}

TEST_CASE("PLY texture coordinates of faces' corners count before those of vertices", "[unit]") {
  const std::string lines = kFour + "property float s\nproperty float t\nelement face 3\n" + kIndices +
                            "property list uchar float texcoord\n";
  const TriangleMesh mesh = mesh_of(header("ascii", lines) +
                                    "0 0 0 9 9\n1 0 0 9 9\n1 1 0 9 9\n0 1 0 9 9\n3 0 1 2 6 0 0 1 0 1 0.5\n"
                                    "4 0 1 2 3 8 0 1 2 3 4 5 6 7\n3 0 1 2 0\n");
  const auto texcoord = [&](std::uint32_t face, int corner) {
    return mesh.texcoords.at(mesh.texcoord_corners(face)[corner]);
  };
  CHECK(texcoord(0, 2) == vec2(1.0f, 0.5f));
  CHECK(texcoord(2, 0) == vec2(0.0f, 1.0f));
  CHECK(texcoord(2, 2) == vec2(6.0f, 7.0f));
  CHECK(texcoord(3, 1) == vec2(0.0f));
}

TEST_CASE("PLY colours are left out with one warning", "[unit]") {
  const InputFolder folder;
  const ReadPly read =
      read_ply(folder, header("ascii", kThree + "property uchar red\nproperty uchar green\n" + kOneFace) +
                           "0 0 0 1 2\n1 0 0 1 2\n0 1 0 1 2\n3 0 1 2\n");
  CHECK(read.mesh.triangles.size() == 1);
  CHECK(read.library.warnings.size() == 1);
  CHECK(any_line(read.library.warnings, folder.at("mesh.ply:7"), {"vertex colours are left out"}));
}

TEST_CASE("a PLY file of points gives a warning and an empty mesh", "[unit]") {
  const InputFolder folder;
  for (const std::string& bytes :
       {header("ascii", kThree) + kCorners, header("ascii", kThree + "element face 0\n" + kIndices) + kCorners,
        header("ascii", ""), header(binary(kBig), kThree) + corners(kBig),
        header("ascii", kThree + "element face 1\nproperty int material\n") + kCorners + "1\n"}) {
    const ReadPly read = read_ply(folder, bytes);
    CHECK(read.mesh.triangles.empty());
    CHECK(read.library.warnings.size() == 1);
    CHECK(any_line(read.library.warnings, folder.at("mesh.ply"), {"no faces"}));
    CHECK(read.library.materials.empty());
  }
}

TEST_CASE("a PLY file's picture is the albedo, and a warning where it cannot be", "[unit]") {
  const InputFolder folder;
  const auto file = [](const std::string& comments, bool texcoords) {
    const std::string uv = texcoords ? "property float s\nproperty float t\n" : "";
    const std::string tail = texcoords ? " 0 0\n" : "\n";
    return header("ascii", comments + kThree + uv + kOneFace) + "0 0 0" + tail + "1 0 0" + tail + "0 1 0" + tail +
           "3 0 1 2\n";
  };
  const std::string comment = "comment TextureFile a map.png\n";
  const ReadPly missing = read_ply(folder, file(comment, true));
  CHECK(any_line(missing.library.warnings, folder.at("mesh.ply:3"), {"\"a map.png\" is missing"}));
  CHECK(missing.library.materials.at(0).name == "default");

  write_png(folder / "a map.png", Image(2, 2));
  const ReadPly read = read_ply(folder, file(comment + "comment TextureFile b.png\ncomment TextureFile c.png\n", true));
  CHECK(any_line(read.library.warnings, folder.at("mesh.ply:4"), {"\"b.png\" is left out"}));
  CHECK(read.library.warnings.size() == 1);
  REQUIRE(read.library.materials.size() == 1);
  CHECK(read.library.materials[0].kind == Material::Kind::lambertian);
  CHECK(read.library.materials[0].color.kind == Texture::Kind::image);
  CHECK(read.library.textures.files() == std::vector{folder / "a map.png"});

  const ReadPly bare = read_ply(folder, file(comment, false));
  CHECK(any_line(bare.library.warnings, folder.at("mesh.ply:3"), {"no texture coordinates"}));
  CHECK(bare.library.materials.at(0).name == "default");

  Image bright(1, 1);
  bright.pixels[0] = Rgb(2.0f);
  write_exr(folder / "a.exr", bright);
  expect_error(ErrorKind::input, folder.at("mesh.ply:3"), {"found (2, 2, 2)"},
               [&] { read_ply(folder, file("comment TextureFile a.exr\n", true)); });
  const ReadPly ignored = read_ply(folder, file("comment TextureFile a.exr\n", true), {.ignore_materials = true});
  CHECK(ignored.library.materials.empty());
  CHECK(ignored.library.warnings.empty());
}

TEST_CASE("what follows the last PLY element, and what no header line is, are left out with a warning", "[unit]") {
  const InputFolder folder;
  const ReadPly text =
      read_ply(folder, header("ascii", "made by hand\n" + kThree + kOneFace) + kCorners + "3 0 1 2\n\n7\n");
  CHECK(text.library.warnings.size() == 2);
  CHECK(any_line(text.library.warnings, folder.at("mesh.ply:3"), {"\"made\" is not understood"}));
  CHECK(any_line(text.library.warnings, folder.at("mesh.ply:16"), {"left out"}));
  const std::string bytes = header(binary(kBig), kThree + kOneFace) + corners(kBig) + bytes_of(kBig, '\3', 0, 1, 2);
  const ReadPly more = read_ply(folder, bytes + "\n");
  CHECK(any_line(more.library.warnings, folder.at("mesh.ply, byte " + std::to_string(bytes.size())), {"left out"}));
}

TEST_CASE("bad PLY headers are refused with their line", "[unit]") {
  const auto lines = [](const std::string& text) { return header("ascii", text); };
  expect_all({{"", ":1", {"found the end of the file, expected ply"}},
              {"\nply\n", ":1", {"expected ply"}},
              {"plys\n", ":1", {"found \"plys\""}},
              {"ply x\n", ":1", {"found \"x\", expected the end of the line"}},
              {"ply\n", ":2", {"found the end of the file, expected end_header"}},
              {"ply\nend_header\n", ":2", {"expected a format"}},
              {"ply\nformat binary 1.0\n", ":2", {"found \"binary\"", "binary_little_endian"}},
              {"ply\nformat ascii 2.0\n", ":2", {"found \"2.0\""}},
              {"ply\nformat\n", ":2", {"found the end of the line"}},
              {lines("element\n"), ":3", {"the name of an element"}},
              {lines("element vertex\n"), ":3", {"found the end of the line", "\"vertex\""}},
              {lines("element vertex -1\n"), ":3", {"found \"-1\""}},
              {lines("element vertex 1.5\n"), ":3", {"found \"1.5\""}},
              {lines("element vertex 99999999999999999999\n"), ":3", {"found \"99999999999999999999\""}},
              {lines("element vertex 1 1\n"), ":3", {"found \"1\", expected the end of the line"}},
              {lines("element a 0\nelement a 0\n"), ":4", {"found \"a\""}},
              {lines("property int a\n"), ":3", {"an element before it"}},
              {lines("element a 0\nproperty long a\n"), ":4", {"found \"long\", expected a type"}},
              {lines("element a 0\nproperty list uchar long a\n"), ":4", {"found \"long\", expected a type"}},
              {lines("element a 0\nproperty list uchar\n"), ":4", {"found the end of the line, expected a type"}},
              {lines("element a 0\nproperty int\n"), ":4", {"the name of a property"}},
              {lines("element a 0\nproperty int a\nproperty int a\n"), ":5", {"found \"a\""}},
              {lines("comment TextureFile\n"), ":3", {"the name of a picture"}}});
}

TEST_CASE("PLY elements that are not what they should be are refused with their line", "[unit]") {
  const auto lines = [](const std::string& text) { return header("ascii", text) + std::string(100, '\n'); };
  expect_all(
      {{lines("element vertex 3\nproperty float x\nproperty float y\n"), ":3", {"x, y and z"}},
       {lines("element vertex 3\n"), ":3", {"x, y and z"}},
       {lines("element vertex 3\nproperty float x\nproperty list uchar float y\nproperty float z\n"),
        ":5",
        {"found a list, expected a number for \"y\""}},
       {lines(kThree + "property float nx\nproperty float ny\nproperty list uchar float nz\n"), ":9", {"\"nz\""}},
       {lines("element face 1\nproperty int vertex_indices\n"), ":4", {"found a number, expected a list"}},
       {lines(kOneFace + "property float texcoord\n"), ":5", {"found a number, expected a list for \"texcoord\""}},
       {header(binary(kBig), "element vertex 4294967295\nproperty uchar x\nproperty uchar y\nproperty uchar z\n"),
        ", byte 121",
        {"found 0 bytes"}}});
}

TEST_CASE("bad numbers of a PLY text are refused with their line", "[unit]") {
  const std::string start = header("ascii", kThree + kOneFace);
  expect_all(
      {{start + "0 0 x\n" + kCorners, ":10", {"found \"x\", expected a number for \"z\""}},
       {start + "0 0 1,5\n" + kCorners, ":10", {"found \"1,5\""}},
       {start + "0 nan 0\n" + kCorners, ":10", {"found \"nan\", expected a finite number for \"y\""}},
       {start + "0 0 -inf\n" + kCorners, ":10", {"found \"-inf\""}},
       {start + "0 0 1e39\n" + kCorners, ":10", {"found \"1e39\""}},
       {start + "0 0 1e999\n" + kCorners, ":10", {"found \"1e999\""}},
       {start + "0 0\n" + kCorners, ":10", {"found the end of the line, expected a number for \"z\""}},
       {start + "0 0 0 0\n" + kCorners, ":10", {"found \"0\", expected the end of the line"}},
       {start + kCorners + "3 0 1 3\n", ":13", {"found \"3\", expected a vertex index from 0 to 2"}},
       {start + kCorners + "3 0 1 -1\n", ":13", {"found \"-1\""}},
       {start + kCorners + "3 0 1 1.5\n", ":13", {"found \"1.5\""}},
       {start + kCorners + "3 0 1 nan\n", ":13", {"found \"nan\""}},
       {start + kCorners + "3 0 1 4294967296\n", ":13", {"found \"4294967296\""}},
       {start + kCorners + "-3 0 1 2\n", ":13", {"found \"-3\"", "\"vertex_indices\""}},
       {start + kCorners + "1.5 0 1 2\n", ":13", {"found \"1.5\""}},
       {start + kCorners + "4 0 1 2\n", ":13", {"found \"4\"", "up to the 3"}},
       {start + kCorners + "4 0 1 2    \n", ":13", {"found the end of the line"}},
       {start + kCorners + "99999999999 0 1 2\n", ":13", {"found \"99999999999\""}},
       {start + kCorners + "3 0 1 2 2\n", ":13", {"expected the end of the line"}},
       {start + kCorners + "\n \n\n", ":16", {"found the end of the file, expected another \"face\""}},
       {start + kCorners, ":13", {"found the end of the file, expected another \"face\""}},
       {header("ascii", "element vertex 4000000000\n" + kXyz) + kCorners,
        ":7",
        {"found 19 bytes, expected 4000000000 of element"}},
       {header("ascii", kOneFace) + "3 0 1 2\n", ":6", {"found \"0\"", "there are no vertices"}},
       {header("ascii", kOneFace + kThree) + "3 0 1 7\n" + kCorners, ":10", {"found \"7\""}},
       {header("ascii", kThree + kOneFace + "property list uchar float texcoord\n") + kCorners + "3 0 1 2 4 0 0 0 0\n",
        ":14",
        {"found 4 texture coordinates, expected 6"}},
       {header("ascii", kThree + kOneFace + "property list uchar float texcoord\n") + kCorners +
            "3 0 1 2 6 0 0 0 0 0 nan\n",
        ":14",
        {"found \"nan\""}}});
}

TEST_CASE("bad numbers of a binary PLY file are refused with their byte", "[unit]") {
  for (const std::endian order : {kLittle, kBig}) {
    const std::string start = header(binary(order), kThree + kOneFace);
    const std::string whole = start + corners(order);
    const auto at = [](std::size_t byte) { return ", byte " + std::to_string(byte); };
    const auto face = [&](auto... numbers) { return whole + bytes_of(order, numbers...); };
    const std::string doubles =
        header(binary(order), "element vertex 1\nproperty double x\nproperty double y\nproperty double z\n");
    const std::string ints = header(binary(order), kThree + "element face 1\nproperty list int uint vertex_indices\n");
    expect_all(
        {{start + bytes_of(order, 0.0f, kNan) + std::string(100, '\0'),
          at(start.size() + 4),
          {"found nan, expected a finite number for \"y\""}},
         {doubles + bytes_of(order, 0.0, 0.0, 1e39), at(doubles.size() + 16), {"found 1e+39", "\"z\""}},
         {start + corners(order).substr(1), at(start.size()), {"found 35 bytes, expected 3 of element \"vertex\""}},
         {whole, at(whole.size()), {"found 0 bytes, expected 1 of element \"face\""}},
         {face('\3', 0, 1, 3), at(whole.size() + 9), {"found 3, expected a vertex index from 0 to 2"}},
         {face('\3', 0, -1, 2), at(whole.size() + 5), {"found -1"}},
         {face('\3', 0, 1), at(whole.size()), {"found 3", "up to the 2"}},
         {face('\xff', 0, 1, 2), at(whole.size()), {"found 255"}},
         {ints + corners(order) + bytes_of(order, -1, 0, 1, 2), at(ints.size() + 36), {"found -1"}},
         {ints + corners(order) + bytes_of(order, 3, 0, 1, 0xffffffffu),
          at(ints.size() + 36 + 12),
          {"found 4294967295"}},
         {ints + corners(order) + bytes_of(order, 0x7fffffff, 0), at(ints.size() + 36), {"found 2147483647"}}});
    const std::string after = header(binary(order), kThree + kOneFace + "property double quality\n");
    expect_all({{after + corners(order) + bytes_of(order, '\2', 0, 1, 0.0f),
                 at(after.size() + 36 + 9),
                 {"found the end of the file, expected a number for \"quality\""}}});
  }
}

TEST_CASE("a PLY file cut off anywhere, or with more than it can hold, ends in one line", "[unit]") {
  const InputFolder folder;
  for (const std::string& whole :
       {header("ascii", kThree + kOneFace) + kCorners + "3 0 1 2",
        header(binary(kBig), kThree + kOneFace) + corners(kBig) + bytes_of(kBig, '\3', 0, 1, 2)}) {
    for (std::size_t size = 0; size < whole.size(); ++size) {
      INFO(size);
      folder.write("mesh.ply", whole.substr(0, size));
      MaterialLibrary library;
      CHECK_THROWS_AS(read_ply_into(library, folder / "mesh.ply", {}), Error);
    }
  }
  for (const std::string count : {"4000000000", "18446744073709551615"}) {
    for (const std::string& format : {std::string("ascii"), binary(kBig)}) {
      for (const std::string& element :
           {"element vertex " + count + "\n" + kXyz, kThree + "element face " + count + "\n" + kIndices,
            "element other " + count + "\nproperty int a\n",
            "element other " + count + "\nproperty list int int a\n"}) {
        INFO(format << element);
        folder.write("mesh.ply", header(format, element) + std::string(50, '0'));
        MaterialLibrary library;
        CHECK_THROWS_AS(read_ply_into(library, folder / "mesh.ply", {}), Error);
      }
    }
  }
}
