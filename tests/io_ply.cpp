// What a PLY file says is what the mesh holds.
#include "expect_error.hpp"
#include "ply_files.hpp"
#include "raylab/image/image_file.hpp"

using namespace raylab;
using namespace raylab::test;

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
