// Every bad OBJ file is refused with file:line and the value found.
#include "catch.hpp"
#include "expect_error.hpp"
#include "io_files.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

struct BadObj {
  std::string text;
  int line;
  std::vector<const char*> parts;
};

void expect_all(const std::vector<BadObj>& files) {
  InputFolder folder;
  for (const BadObj& bad : files) {
    INFO(bad.text);
    for (const char* part : bad.parts) {
      expect_error(ErrorKind::input, folder.at("mesh.obj:" + std::to_string(bad.line)), {part},
                   [&] { folder.obj(bad.text); });
    }
  }
}

}  // namespace

TEST_CASE("a missing OBJ file is refused by name", "[unit]") {
  InputFolder folder;
  expect_error(ErrorKind::input, folder.at("absent.obj"), {"No such file"}, [&] { read_obj(folder / "absent.obj"); });
}

TEST_CASE("indices that are zero, out of range or no integers are refused", "[unit]") {
  expect_all({{kTriangle + "f 1 2 4\n", 4, {"found \"4\"", "vertex index from 1 to 3 or from -1 to -3"}},
              {kTriangle + "f 1 2 -4\n", 4, {"found \"-4\"", "vertex"}},
              {kTriangle + "f 1 2 0\n", 4, {"found \"0\""}},
              {kTriangle + "f 1 2 -0\n", 4, {"found \"-0\""}},
              {kTriangle + "f 0/1 2 3\n", 4, {"found \"0/1\""}},
              {kTriangle + "vn 0 0 1\nf 1//1 2//0 3//1\n", 5, {"found \"2//0\""}},
              {kTriangle + "vt 0 0\nf 1/0 2/1 3/1\n", 5, {"found \"1/0\""}},
              {kTriangle + "f 1 2 99999999999\n", 4, {"found \"99999999999\""}},
              {kTriangle + "f 1 2 4294967297\n", 4, {"found \"4294967297\""}},
              {kTriangle + "f 1 2 x\n", 4, {"found \"x\""}},
              {kTriangle + "f 1 2 3.0\n", 4, {"found \"3.0\""}},
              {kTriangle + "f 1 2 3/1/1/1\n", 4, {"found \"3/1/1/1\""}},
              {kTriangle + "f 1 2 /3\n", 4, {"found \"/3\""}},
              // A vertex that is defined only after the face.
              {"v 0 0 0\nv 1 0 0\nf 1 2 3\nv 0 1 0\n", 3, {"found \"3\"", "from 1 to 2"}},
              {"f 1 2 3\n", 1, {"found \"1\"", "none is defined before"}}});
}

TEST_CASE("corners whose normals or texture coordinates are not there have none, with a warning", "[unit]") {
  InputFolder folder;
  const std::string corners = "vt 0.5 0.5\nvn 1 0 0\nf 1/1/1 2/2/1 3/1/-2\nf 1/7/1 2/1/1 3/1/1\n";
  const ObjMesh read = folder.obj(kTriangle + corners);
  CHECK(any_line(read.warnings, folder.at("mesh.obj:6"), {"texture coordinates", "left out: 2, the first here"}));
  CHECK(any_line(read.warnings, folder.at("mesh.obj:6"), {"normals", "left out: 1, the first here"}));
  REQUIRE(read.mesh.triangles.size() == 2);
  CHECK(read.mesh.texcoords[read.mesh.texcoord_corners(0).y] == vec2(0.0f));
  CHECK(read.mesh.texcoords[read.mesh.texcoord_corners(0).x] == vec2(0.5f));
  CHECK(read.mesh.normals[read.mesh.normal_corners(0).z] == vec3(0, 0, 1));
  CHECK(read.mesh.normals[read.mesh.normal_corners(0).x] == vec3(1, 0, 0));
}

TEST_CASE("vertices, normals and texture coordinates that are not finite are refused", "[unit]") {
  expect_all({{"v nan 0 0\n", 1, {"found \"nan\"", "finite"}},
              {"v 0 0 0\nv 0 inf 0\n", 2, {"found \"inf\"", "finite"}},
              {"v 0 -Infinity 0\n", 1, {"found \"-Infinity\""}},
              {"v 1e999 0 0\n", 1, {"1e999", "finite"}},
              {"v 0 0 -1e39\n", 1, {"-1e39", "finite"}},
              {"v 0 0 1e99999999999\n", 1, {"1e99999999999", "finite"}},
              {"vn 0 0 1e39\n", 1, {"1e39", "finite normal"}},
              {"vn nan 0 0\n", 1, {"found \"nan\""}},
              {"vt 1e39 0\n", 1, {"1e39", "finite texture"}},
              {"vt 0 nan\n", 1, {"found \"nan\""}}});
}

TEST_CASE("what is no number, and too few numbers, are refused", "[unit]") {
  expect_all({{"v 0 0 abc\n", 1, {"found \"abc\""}},
              {"v 0 0 1.2.3\n", 1, {"found \"1.2.3\""}},
              {"v 0 0 1e\n", 1, {"found \"1e\""}},
              {"v 0 0 --1\n", 1, {"found \"--1\""}},
              {"v 0 0 0x10\n", 1, {"found \"0x10\""}},
              {"v 0 0 1,5\n", 1, {"found \"1,5\""}},
              {"v 0 0 .\n", 1, {"found \".\""}},
              {"v 0 0\n", 1, {"found \"v 0 0\"", "3 numbers"}},
              {"v 0 0 # 1\n", 1, {"3 numbers"}},
              {"vn 0 1\n", 1, {"found \"vn 0 1\"", "3 numbers"}},
              {"vt\n", 1, {"found \"vt\"", "1 number"}}});
}

TEST_CASE("lines are counted through blank, continued and differently ended lines", "[unit]") {
  expect_all({{"\n\n# comment\nv 0 0 x\n", 4, {"\"x\""}},
              {"v 0 \\\n0 \\\n0\nv 0 0 x\n", 4, {"\"x\""}},
              {"v 0 0 0\r\nv 0 0 0\r\nv 0 0 x\r\n", 3, {"\"x\""}},
              {"v 0 0 0\rv 0 0 0\rv 0 0 x\r", 3, {"\"x\""}},
              {"# \\\nv 0 0 x", 2, {"\"x\""}},
              {"usemtl a\ng b\nv 0 0 0\nf 7 7 7\n", 4, {"\"7\""}}});
}
