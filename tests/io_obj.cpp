// What an OBJ file says is what the mesh holds.
#include <random>
#include <sstream>

#include "catch.hpp"
#include "io_files.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

/// Area that the triangles cover, counted by their winding seen from +z.
double signed_area(const TriangleMesh& mesh) {
  double area = 0.0;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle t = triangle_corners(mesh, i);
    area += 0.5 * glm::cross(dvec3(t.p1) - dvec3(t.p0), dvec3(t.p2) - dvec3(t.p0)).z;
  }
  return area;
}

/// Loads one polygon and checks that it became n - 2 triangles of its winding that cover its area once.
void check_polygon(const std::vector<vec2>& corners, double area) {
  std::ostringstream obj;
  obj.precision(9);
  for (const vec2& c : corners) obj << "v " << c.x << " " << c.y << " 0\n";
  obj << "f";
  for (std::size_t i = 1; i <= corners.size(); ++i) obj << " " << i;
  InputFolder folder;
  const ObjMesh read = folder.obj(obj.str() + "\n");
  INFO(obj.str());
  CHECK(read.warnings.empty());
  CHECK(read.mesh.triangles.size() == corners.size() - 2);
  CHECK(signed_area(read.mesh) == Approx(area));
  for (std::uint32_t i = 0; i < read.mesh.triangles.size(); ++i) {
    const Triangle t = triangle_corners(read.mesh, i);
    CHECK(glm::cross(t.p1 - t.p0, t.p2 - t.p0).z >= 0.0f);
  }
}

}  // namespace

TEST_CASE("corners are read in all four forms", "[unit]") {
  InputFolder folder;
  const std::string data = kSquare + "vt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\nvn 0 0 2\nvn 0 0 3\nvn 0 1 0\n";
  const ObjMesh v = folder.obj(data + "f 1 2 3\n");
  CHECK(v.mesh.triangles.at(0) == uvec3(0, 1, 2));
  CHECK(v.mesh.normals.empty());
  CHECK(v.mesh.texcoords.empty());
  const ObjMesh vt = folder.obj(data + "f 1/3 2/2 4/1\n");
  CHECK(vt.mesh.texcoord_indices.at(0) == uvec3(2, 1, 0));
  CHECK(vt.mesh.normals.empty());
  const ObjMesh vn = folder.obj(data + "f 1//4 2//3 3//2\n");
  CHECK(vn.mesh.normal_indices.at(0) == uvec3(3, 2, 1));
  CHECK(vn.mesh.normals.at(2) == vec3(0.0f, 0.0f, 1.0f));
  CHECK(vn.mesh.texcoords.empty());
  const ObjMesh all = folder.obj(data + "f 4/1/2 3/2/3 2/3/4\n");
  CHECK(all.mesh.triangles.at(0) == uvec3(3, 2, 1));
  CHECK(all.mesh.texcoord_indices.at(0) == uvec3(0, 1, 2));
  CHECK(all.mesh.normal_indices.at(0) == uvec3(1, 2, 3));
  CHECK(all.mesh.texcoords.at(2) == vec2(1.0f, 1.0f));
}

TEST_CASE("a slash behind the last index of a corner does not borrow the next corner's", "[unit]") {
  InputFolder folder;
  const TriangleMesh mesh = folder.obj(kSquare + "vt 0 0\nvt 1 0\nf 1/ 2// 3/2/\n").mesh;
  CHECK(mesh.triangles.at(0) == uvec3(0, 1, 2));
  CHECK(mesh.normals.empty());
  CHECK(mesh.texcoords.at(mesh.texcoord_corners(0).x) == vec2(0.0f));
  CHECK(mesh.texcoords.at(mesh.texcoord_corners(0).z) == vec2(1.0f, 0.0f));
}

TEST_CASE("index arrays that repeat the positions' are not stored", "[unit]") {
  InputFolder folder;
  const std::string data = kSquare + "vn 0 0 1\nvn 0 0 1\nvn 0 0 1\nvn 0 0 1\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
  const ObjMesh same = folder.obj(data + "f 1/1/1 2/2/2 3/3/3\nf 1/1/1 3/3/3 4/4/4\n");
  CHECK(same.mesh.normals.size() == 4);
  CHECK(same.mesh.normal_indices.empty());
  CHECK(same.mesh.texcoord_indices.empty());
  // One corner that differs, in the last face, brings both faces' indices.
  const ObjMesh other = folder.obj(data + "f 1/1/1 2/2/2 3/3/3\nf 1/1/1 3/3/3 4/4/2\n");
  CHECK(other.mesh.normal_indices == std::vector<uvec3>{{0, 1, 2}, {0, 2, 1}});
  CHECK(other.mesh.texcoord_indices.empty());
}

TEST_CASE("negative indices count back from where the face stands", "[unit]") {
  InputFolder folder;
  const ObjMesh read =
      folder.obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 0 0 5\nv 1 0 5\nv 0 1 5\nf -3 -2 -1\nf 1 -1 2\n");
  CHECK(read.mesh.triangles == std::vector<uvec3>{{0, 1, 2}, {3, 4, 5}, {0, 5, 1}});
}

TEST_CASE("faces without normals get their own when others have some", "[unit]") {
  InputFolder folder;
  const std::string data = "v 0 0 0\nv 1 0 0\nv 0 0 -1\nvn 1 0 0\n";
  for (const char* faces : {"f 1//1 2//1 3//1\nf 1 2 3\n", "f 1 2 3\nf 1//1 2//1 3//1\n"}) {
    INFO(faces);
    const TriangleMesh mesh = folder.obj(data + faces).mesh;
    const std::uint32_t given = faces[3] == '/' ? 0 : 1;
    REQUIRE(mesh.normal_indices.size() == 2);
    for (int corner = 0; corner < 3; ++corner) {
      CHECK(mesh.normals.at(mesh.normal_corners(given)[corner]) == vec3(1.0f, 0.0f, 0.0f));
      CHECK(mesh.normals.at(mesh.normal_corners(1 - given)[corner]) == vec3(0.0f, 1.0f, 0.0f));
    }
  }
}

TEST_CASE("faces without texture coordinates get (0, 0) when others have some", "[unit]") {
  InputFolder folder;
  const TriangleMesh mesh = folder.obj(kSquare + "vt 0.5 0.25\nf 1/1 2/1 3/1\nf 1 3 4\n").mesh;
  CHECK(mesh.texcoords.at(mesh.texcoord_corners(0).y) == vec2(0.5f, 0.25f));
  CHECK(mesh.texcoords.at(mesh.texcoord_corners(1).y) == vec2(0.0f));
}

TEST_CASE("normals are made unit length, and those of length zero replaced by the face's with a warning", "[unit]") {
  InputFolder folder;
  const ObjMesh read = folder.obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 3e30 4e30\nvn 0 0 0\nvn 0 0 -0\nf 1//1 2//2 3//3\n");
  const auto normal = [&](int corner) { return read.mesh.normals.at(read.mesh.normal_corners(0)[corner]); };
  CHECK(glm::length(normal(0) - vec3(0.0f, 0.6f, 0.8f)) < 1e-6f);
  CHECK(normal(1) == vec3(0.0f, 0.0f, 1.0f));
  CHECK(normal(2) == vec3(0.0f, 0.0f, 1.0f));
  CHECK(any_line(read.warnings, folder.at("mesh.obj:5"), {"length zero", ": 2,"}));
}

TEST_CASE("faces of fewer than three distinct corners are left out with a warning", "[unit]") {
  InputFolder folder;
  const ObjMesh read = folder.obj(kSquare + "f 1 2 3\nf 1 2\nf 3\nf 1 1 2\nf 1 2 1\nf 1 2 2 3\nf\n");
  CHECK(read.mesh.triangles == std::vector<uvec3>{{0, 1, 2}, {0, 1, 2}});
  CHECK(any_line(read.warnings, folder.at("mesh.obj:6"), {"fewer than 3", ": 4,"}));
}

TEST_CASE("a file without faces gives a warning and an empty mesh", "[unit]") {
  InputFolder folder;
  const ObjMesh read = folder.obj("");
  CHECK(read.mesh.triangles.empty());
  CHECK(any_line(read.warnings, folder.at("mesh.obj"), {"no faces"}));
}

TEST_CASE("polygons of every shape are covered once by triangles of their winding", "[unit]") {
  check_polygon({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, 1.0);
  // A dart: the fan around its first corner would leave it.
  check_polygon({{0, 0}, {4, 4}, {0, 1}, {-4, 4}}, 4.0);
  check_polygon({{4, 4}, {0, 1}, {-4, 4}, {0, 0}}, 4.0);
  // An L, a comb, and a square with a corner in the middle of each side.
  check_polygon({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, 3.0);
  check_polygon({{0, 0}, {5, 0}, {5, 3}, {4, 3}, {4, 1}, {3, 1}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}}, 11.0);
  check_polygon({{0, 0}, {1, 0}, {2, 0}, {2, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}}, 4.0);
  // A square with a square hole, joined by a bridge that is passed twice.
  check_polygon({{0, 0}, {3, 0}, {3, 3}, {0, 3}, {0, 0}, {1, 1}, {1, 2}, {2, 2}, {2, 1}, {1, 1}}, 8.0);
}

TEST_CASE("star polygons of random radii are covered once", "[unit]") {
  std::mt19937 random(5);
  for (int trial = 0; trial < 50; ++trial) {
    const int count = 4 + trial % 30;
    std::vector<vec2> corners;
    for (int i = 0; i < count; ++i) {
      const float angle = 2.0f * kPi * static_cast<float>(i) / static_cast<float>(count);
      // Coordinates of few digits, so that the text holds them exactly.
      const float radius = 1.0f + static_cast<float>(random() % 64);
      corners.emplace_back(std::round(16.0f * radius * std::cos(angle)), std::round(16.0f * radius * std::sin(angle)));
    }
    double area = 0.0;
    for (int i = 0; i < count; ++i) {
      const vec2 a = corners[static_cast<std::size_t>(i)], b = corners[static_cast<std::size_t>((i + 1) % count)];
      area += 0.5 * (double{a.x} * b.y - double{a.y} * b.x);
    }
    check_polygon(corners, area);
  }
}

TEST_CASE("polygons of very many corners are covered once, and in no time: spirals, combs and stars", "[unit]") {
  constexpr int count = 30000;
  std::vector<vec2> spiral, comb, star;
  for (int i = 0; i < count / 2; ++i) {
    // Out along one side of a band, and back along the other.
    const auto on_spiral = [&](int at, float inset) {
      const float angle = 2.0f * kPi * static_cast<float>(at) / 100.0f;
      const float radius = 1000.0f * static_cast<float>(at) / 100.0f + 2000.0f - inset;
      return vec2(std::round(radius * std::cos(angle)), std::round(radius * std::sin(angle)));
    };
    spiral.push_back(on_spiral(i, 0.0f));
    spiral.insert(spiral.begin(), on_spiral(i, 500.0f));
    comb.emplace_back(2 * i, i % 2 == 0 ? 1000 : 1);
  }
  comb.emplace_back(count - 2, 0);
  comb.emplace_back(0, 0);
  std::reverse(comb.begin(), comb.end());
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * 3.14159265358979 * i / count;
    star.emplace_back(std::round(4e6 * (i % 2 + 1) * std::cos(angle)), std::round(4e6 * (i % 2 + 1) * std::sin(angle)));
  }
  for (const std::vector<vec2>& corners : {spiral, comb, star}) {
    double area = 0.0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const vec2 a = corners[i], b = corners[(i + 1) % corners.size()];
      area += 0.5 * (double{a.x} * b.y - double{a.y} * b.x);
    }
    check_polygon(corners, area);
  }
}

TEST_CASE("a concave polygon keeps its winding in every plane", "[unit]") {
  InputFolder folder;
  const char* planes[][4] = {{"0 0 0", "0 4 4", "0 0 1", "0 -4 4"},   // x = 0, seen from +x
                             {"0 0 0", "4 0 4", "0 0 1", "-4 0 4"},   // y = 0, seen from -y
                             {"0 0 0", "4 4 4", "0 1 1", "-4 4 4"}};  // slanted
  for (const auto& plane : planes) {
    std::string obj;
    for (const char* corner : plane) obj += std::string("v ") + corner + "\n";
    const TriangleMesh mesh = folder.obj(obj + "f 1 2 3 4\n").mesh;
    REQUIRE(mesh.triangles.size() == 2);
    const auto normal = [&](std::uint32_t i) {
      const Triangle t = triangle_corners(mesh, i);
      return glm::cross(t.p1 - t.p0, t.p2 - t.p0);
    };
    CHECK(glm::dot(normal(0), normal(1)) > 0.0f);
  }
}

TEST_CASE("each polygon of several becomes its own triangles alone", "[unit]") {
  InputFolder folder;
  const TriangleMesh mesh = folder.obj(kSquare + "f 1 2 3 4\nf 4 1 2 3\nf 1 2 3\nf 2 3 4 1\n").mesh;
  CHECK(mesh.triangles ==
        std::vector<uvec3>{{0, 1, 2}, {0, 2, 3}, {3, 0, 1}, {3, 1, 2}, {0, 1, 2}, {1, 2, 3}, {1, 3, 0}});
}

TEST_CASE("a polygon that crosses itself becomes a fan with a warning", "[unit]") {
  InputFolder folder;
  const ObjMesh read = folder.obj(kSquare + "f 1 3 2 4\nf 1 2 3\n");
  CHECK(read.mesh.triangles.size() == 3);
  CHECK(any_line(read.warnings, folder.at("mesh.obj:5"), {"cross themselves", ": 1,"}));
}

TEST_CASE("attributes follow the corners of a polygon into its triangles", "[unit]") {
  InputFolder folder;
  const TriangleMesh mesh = folder
                                .obj(
                                    "v 0 0 0\nv 4 4 0\nv 0 1 0\nv -4 4 0\nvt 0 0\nvt 4 4\nvt 0 1\nvt -4 4\nvt 9 9\n"
                                    "f 1/1 2/2 3/3 4/4\nf 1/5 2/5 3/5\n")
                                .mesh;
  for (std::uint32_t t = 0; t < 2; ++t) {
    for (int c = 0; c < 3; ++c) {
      const vec3 p = mesh.positions[mesh.triangles[t][c]];
      CHECK(mesh.texcoords[mesh.texcoord_corners(t)[c]] == vec2(p.x, p.y));
    }
  }
}

TEST_CASE("line ends, tabs, indents, comments and continued lines do not matter", "[unit]") {
  InputFolder folder;
  const std::string plain = "v 0 0 0\nv 1.5 0 0\nv 0 1 0\nf 1 2 3\n";
  const TriangleMesh expected = folder.obj(plain).mesh;
  const auto with = [&](const std::string& line_end) {
    std::string text;
    for (const char c : plain) text += c == '\n' ? line_end : std::string(1, c);
    return text;
  };
  for (const std::string& text :
       {with("\r\n"), with("\r"), with("  \n"), with(" # a comment\n"), with("\n\n# f 9 9 9\n\t\n"),
        "\xEF\xBB\xBF" + plain, plain.substr(0, plain.size() - 1),
        std::string("\tv\t0\t0\t0\n  v +1.5 0. .0\nv 0e0 1E+0 -0\n f\t1  2\t3 \n"),
        std::string("v 0 0 \\\n0\nv 1.5 \\\r\n 0 0\nv 0 1 0\nf 1 \\\n2 \\\n3\n"),
        std::string("# ends in a backslash \\\nv 0 0 0\nv 1.5 0 0 1\nv 0 1 0 0.5 0.5 0.5\nf 1 2 3")}) {
    INFO(text);
    const ObjMesh read = folder.obj(text);
    CHECK(read.mesh.triangles == expected.triangles);
    CHECK(corners_of(read.mesh) == corners_of(expected));
    CHECK(read.warnings.empty());
  }
}

TEST_CASE("statements that are not understood give one warning a kind", "[unit]") {
  InputFolder folder;
  const ObjMesh read = folder.obj("o name\ng group one\ns 1\n" + kSquare + "l 1 2\nl 2 3\ncurv 0 1 2\nf 1 2 3\n");
  REQUIRE(read.warnings.size() == 2);
  CHECK(any_line(read.warnings, folder.at("mesh.obj:8"), {"\"l\""}));
  CHECK(any_line(read.warnings, folder.at("mesh.obj:10"), {"\"curv\""}));
}

TEST_CASE("positions have room for the bytes that Embree reads behind them", "[unit]") {
  InputFolder folder;
  const TriangleMesh mesh = folder.obj(kSquare + "f 1 2 3\n").mesh;
  CHECK(mesh.positions.capacity() >= mesh.positions.size() + 2);
}

TEST_CASE("random meshes written with absolute and with relative indices load equal", "[unit]") {
  std::mt19937 random(7);
  InputFolder folder;
  for (int trial = 0; trial < 20; ++trial) {
    const int vertices = 3 + static_cast<int>(random() % 40);
    const int texcoords = 1 + static_cast<int>(random() % 10);
    const int normals = 1 + static_cast<int>(random() % 10);
    std::ostringstream absolute, relative;
    std::vector<vec3> positions;
    std::vector<uvec3> triangles;
    const auto number = [&] { return static_cast<float>(static_cast<int>(random() % 20001) - 10000) / 64.0f; };
    for (std::ostringstream* out : {&absolute, &relative}) out->precision(9);
    const auto both = [&](const auto&... parts) {
      ((absolute << parts), ...);
      ((relative << parts), ...);
    };
    for (int i = 0; i < vertices; ++i) {
      positions.emplace_back(number(), number(), number());
      both("v ", positions.back().x, " ", positions.back().y, " ", positions.back().z, "\n");
    }
    for (int i = 0; i < texcoords; ++i) both("vt ", number(), " ", number(), "\n");
    for (int i = 0; i < normals; ++i) both("vn ", 1.0f + number() * number(), " 1 ", number(), "\n");
    for (int f = 0; f < 60; ++f) {
      uvec3 triangle;
      both("f");
      const bool has_texcoord = random() % 2 == 0, has_normal = random() % 2 == 0;
      const auto first = static_cast<unsigned>(random() % static_cast<unsigned>(vertices));
      for (unsigned c = 0; c < 3; ++c) {
        triangle[static_cast<int>(c)] = (first + c) % static_cast<unsigned>(vertices);
        const auto v = static_cast<int>(triangle[static_cast<int>(c)]);
        const auto t = static_cast<int>(random() % static_cast<unsigned>(texcoords));
        const auto n = static_cast<int>(random() % static_cast<unsigned>(normals));
        absolute << " " << v + 1 << "/" << (has_texcoord ? std::to_string(t + 1) : "");
        relative << " " << v - vertices << "/" << (has_texcoord ? std::to_string(t - texcoords) : "");
        if (has_normal) {
          absolute << "/" << n + 1;
          relative << "/" << n - normals;
        }
      }
      both("\n");
      triangles.push_back(triangle);
    }
    const TriangleMesh a = folder.obj(absolute.str()).mesh;
    const TriangleMesh r = folder.obj(relative.str()).mesh;
    CHECK(a.positions == positions);
    CHECK(a.triangles == triangles);
    CHECK(r.positions == a.positions);
    CHECK(r.triangles == a.triangles);
    CHECK(r.normals == a.normals);
    CHECK(r.normal_indices == a.normal_indices);
    CHECK(r.texcoords == a.texcoords);
    CHECK(r.texcoord_indices == a.texcoord_indices);
    for (const vec3& n : a.normals) CHECK(glm::length(n) == Approx(1.0));
    for (const uvec3& n : a.normal_indices) CHECK(glm::max(n.x, glm::max(n.y, n.z)) < a.normals.size());
  }
}
