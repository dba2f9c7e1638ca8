// What an STL file says is what the mesh holds; every bad one is refused with its place and the value found.
#include <algorithm>
#include <array>
#include <cctype>
#include <limits>
#include <random>
#include <sstream>

#include "catch.hpp"
#include "expect_error.hpp"
#include "io/stl_file.hpp"
#include "io_files.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

struct ReadStl {
  MaterialLibrary library;
  TriangleMesh mesh;
};

ReadStl read_stl(const InputFolder& folder, const std::string& bytes, const ObjOptions& options = {}) {
  ReadStl read;
  read.mesh = read_stl_into(read.library, folder.write("mesh.stl", bytes), options).mesh;
  return read;
}

using Facet = std::array<vec3, 3>;

std::string binary_facet(const Facet& facet) {
  std::string bytes = bytes_of(std::endian::little, 0.0f, 0.0f, 1.0f);
  for (const vec3& p : facet) bytes += bytes_of(std::endian::little, p.x, p.y, p.z);
  return bytes + "ab";
}

std::string binary_stl(const std::vector<Facet>& facets, std::string header = "made by hand") {
  header.resize(80);
  header += bytes_of(std::endian::little, static_cast<std::uint32_t>(facets.size()));
  for (const Facet& facet : facets) header += binary_facet(facet);
  return header;
}

std::string text_stl(const std::vector<Facet>& facets) {
  std::ostringstream text;
  text.precision(9);
  text << "solid a name\n";
  for (const Facet& facet : facets) {
    text << "  facet normal nan 0 1\n    outer loop\n";
    for (const vec3& p : facet) text << "      vertex " << p.x << " " << p.y << "\t" << p.z << "\n";
    text << "    endloop\n  endfacet\n";
  }
  return text.str() + "endsolid a name\n";
}

const Facet kFirst = {vec3(0, 0, 0), vec3(1, 0, 0), vec3(0, 1, 0)};
const Facet kSecond = {vec3(0, 1, -0.0f), vec3(1, 0, 0), vec3(1, 1, 0)};
const std::vector<vec3> kPositions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
const std::vector<uvec3> kTriangles = {{0, 1, 2}, {2, 1, 3}};

struct BadStl {
  std::string bytes;
  std::string place;  ///< ":LINE" or ", byte N"
  const char* part;
};

void expect_all(const std::vector<BadStl>& files) {
  const InputFolder folder;
  for (const BadStl& bad : files) {
    INFO(bad.bytes);
    expect_error(ErrorKind::input, folder.at("mesh.stl" + bad.place), {bad.part}, [&] { read_stl(folder, bad.bytes); });
  }
}

}  // namespace

TEST_CASE("STL files, text and binary, are read, with one vertex where corners are in the same place", "[unit]") {
  const InputFolder folder;
  for (const std::string& bytes :
       {text_stl({kFirst, kSecond}), binary_stl({kFirst, kSecond}), binary_stl({kFirst, kSecond}, "solid after all"),
        binary_stl({kFirst, kSecond}, "solid" + std::string(75, ' '))}) {
    const ReadStl read = read_stl(folder, bytes);
    INFO(joined(read.library.warnings));
    CHECK(read.library.warnings.empty());
    CHECK(read.mesh.positions == kPositions);
    CHECK(read.mesh.triangles == kTriangles);
    CHECK(read.mesh.normals.empty());
    CHECK(read.mesh.texcoords.empty());
    CHECK(read.mesh.positions.capacity() >= read.mesh.positions.size() + 2);
    CHECK_FALSE(std::signbit(read.mesh.positions[2].z));
    CHECK(read.library.files == std::vector{folder / "mesh.stl"});
    CHECK(read.library.materials.size() == 1);
    CHECK(read_stl(folder, bytes, {.ignore_materials = true}).library.materials.empty());
  }
}

TEST_CASE("0 and -0 are one place, wherever the STL file has them first", "[unit]") {
  const InputFolder folder;
  const Facet negative = {vec3(-0.0f, -0.0f, -0.0f), vec3(1, -0.0f, 0), vec3(0, 1, -0.0f)};
  for (const std::string& bytes : {text_stl({negative, kFirst}), binary_stl({negative, kFirst})}) {
    const TriangleMesh mesh = read_stl(folder, bytes).mesh;
    CHECK(mesh.triangles == std::vector<uvec3>{{0, 1, 2}, {0, 1, 2}});
    for (const vec3& p : mesh.positions) CHECK_FALSE((std::signbit(p.x) || std::signbit(p.y) || std::signbit(p.z)));
  }
}

TEST_CASE("STL texts may hold several solids, in capital letters and lines of any end", "[unit]") {
  const InputFolder folder;
  std::string text = text_stl({kFirst}) + "solid\nendsolid\n\n" + text_stl({kSecond});
  CHECK(read_stl(folder, text).mesh.triangles == kTriangles);
  CHECK(read_stl(folder, "\xEF\xBB\xBF\n  " + text).mesh.triangles == kTriangles);
  std::replace(text.begin(), text.end(), '\n', '\r');
  CHECK(read_stl(folder, text).mesh.triangles == kTriangles);
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::toupper(c); });
  CHECK(read_stl(folder, text).mesh.triangles == kTriangles);
}

TEST_CASE("vertices of a large STL mesh are found again", "[unit]") {
  // A torus of quads, in random order: half as many vertices as facets.
  constexpr int n = 120;
  std::vector<Facet> facets;
  const auto point = [](int i, int j) { return vec3(i % n, j % n, (i % n) * (j % n)) * 0.25f; };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      facets.push_back({point(i, j), point(i + 1, j), point(i + 1, j + 1)});
      facets.push_back({point(i, j), point(i + 1, j + 1), point(i, j + 1)});
    }
  }
  std::shuffle(facets.begin(), facets.end(), std::mt19937(1));
  const InputFolder folder;
  for (const std::string& bytes : {text_stl(facets), binary_stl(facets)}) {
    const TriangleMesh mesh = read_stl(folder, bytes).mesh;
    CHECK(mesh.positions.size() == n * n);
    REQUIRE(mesh.triangles.size() == facets.size());
    const std::vector<vec3> corners = corners_of(mesh);
    for (std::size_t i = 0; i < facets.size(); ++i) {
      REQUIRE(std::equal(facets[i].begin(), facets[i].end(), corners.begin() + static_cast<std::ptrdiff_t>(3 * i)));
    }
  }
}

TEST_CASE("STL facets of fewer than three distinct corners are left out with a warning", "[unit]") {
  const InputFolder folder;
  const Facet line = {vec3(0, 0, 0), vec3(1, 0, 0), vec3(-0.0f, 0, 0)}, point = {};
  const ReadStl text = read_stl(folder, text_stl({kFirst, line, point, kSecond}));
  CHECK(text.mesh.triangles == kTriangles);
  CHECK(any_line(text.library.warnings, folder.at("mesh.stl:9"), {"fewer than 3", ": 2,"}));
  const ReadStl bytes = read_stl(folder, binary_stl({kFirst, line, point, kSecond}));
  CHECK(bytes.mesh.triangles == kTriangles);
  CHECK(any_line(bytes.library.warnings, folder.at("mesh.stl, byte 134"), {"fewer than 3", ": 2,"}));
}

TEST_CASE("an STL file without facets gives a warning and an empty mesh", "[unit]") {
  const InputFolder folder;
  for (const std::string& bytes : {text_stl({}), binary_stl({})}) {
    const ReadStl read = read_stl(folder, bytes);
    CHECK(read.mesh.triangles.empty());
    CHECK(any_line(read.library.warnings, folder.at("mesh.stl"), {"no faces"}));
    CHECK(read.library.materials.empty());
  }
}

TEST_CASE("what follows the facets of a binary STL file is left out with a warning", "[unit]") {
  const InputFolder folder;
  const ReadStl read = read_stl(folder, binary_stl({kFirst, kSecond}) + std::string(51, ' '));
  CHECK(read.mesh.triangles == kTriangles);
  CHECK(any_line(read.library.warnings, folder.at("mesh.stl, byte 184"), {"left out"}));
}

TEST_CASE("bad binary STL files are refused with their byte", "[unit]") {
  const std::string whole = binary_stl({kFirst, kSecond});
  std::string many = whole;
  many.replace(80, 4, "\xff\xff\xff\xff");
  Facet bad = kSecond;
  bad[2].y = std::numeric_limits<float>::quiet_NaN();
  Facet infinite = kFirst;
  infinite[0].x = -std::numeric_limits<float>::infinity();
  expect_all({{"", ", byte 0", "found 0 bytes, expected a header of 84 bytes"},
              {"hello\n", ", byte 0", "found 6 bytes"},
              {whole.substr(0, 83), ", byte 0", "found 83 bytes"},
              {whole.substr(0, 183), ", byte 80", "found 2 facets, expected at most the 1 "},
              {binary_stl({kFirst}, "solid").substr(0, 100), ", byte 80", "found 1 facets"},
              {many, ", byte 80", "found 4294967295 facets, expected at most the 2 "},
              {binary_stl({kFirst, bad}), ", byte 174", "found nan, expected a finite coordinate"},
              {binary_stl({infinite, bad}), ", byte 96", "found -inf"}});
}

TEST_CASE("bad STL texts are refused with their line", "[unit]") {
  const std::string start = "solid\nfacet normal 0 0 1\nouter loop\n";
  const std::string vertices = "vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n";
  expect_all({{"solid", ":1", "found the end of the file, expected facet or endsolid"},
              {"solid\n", ":2", "found the end of the file, expected facet or endsolid"},
              {"solid\nfacets", ":2", "found \"facets\""},
              {"solid\nfacet 0 0 1", ":2", "found \"0\", expected normal"},
              {"solid\nfacet normal 0 0 1\nloop", ":3", "found \"loop\", expected outer"},
              {start + "vertex 0 0 x\n", ":4", "found \"x\", expected a finite coordinate"},
              {start + "vertex 0 nan 0\n", ":4", "found \"nan\""},
              {start + "vertex 1e39 0 0\n", ":4", "found \"1e39\""},
              {start + "vertex 0 0\nvertex 0 0 0\n", ":5", "found \"vertex\", expected a finite coordinate"},
              {start + "vertex 0 0 0\nendloop\n", ":5", "found \"endloop\", expected vertex"},
              {start + vertices + "vertex 1 1 0\nendloop\n", ":7", "found \"vertex\", expected endloop"},
              {start + vertices + "endloop\nendsolid", ":8", "found \"endsolid\", expected endfacet"},
              {start + vertices + "endloop\nendfacet\n", ":9", "found the end of the file"},
              {"solid\nendsolid\nfacet", ":3", "found \"facet\", expected solid"}});
}

TEST_CASE("an STL file cut off anywhere ends in one line", "[unit]") {
  const InputFolder folder;
  const std::string bytes = binary_stl({kFirst, kSecond});
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    INFO(size);
    CHECK_THROWS_AS(read_stl(folder, bytes.substr(0, size)), Error);
  }
  const std::string text = text_stl({kFirst, kSecond});
  for (std::size_t size = 0; size < text.rfind("endsolid") + 8; ++size) {
    INFO(size);
    CHECK_THROWS_AS(read_stl(folder, text.substr(0, size)), Error);
  }
}
