// Files that mean harm, or look like it, end in an error or a warning with its place, and in no time.
#include <unistd.h>

#include "catch.hpp"
#include "expect_error.hpp"
#include "io_files.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

/// The place of the error that loading the scene throws.
std::string place_of_error(const InputFolder& folder, const std::string& toml) {
  try {
    folder.load(toml);
  } catch (const Error& error) {
    CHECK(error.kind() == ErrorKind::input);
    return error.location();
  }
  return "no error";
}

}  // namespace

TEST_CASE("a TOML key of very many parts is refused at its place, and dots elsewhere are not counted", "[unit]") {
  const InputFolder folder;
  const std::string deep = "a" + repeated(".a", 20000);
  for (const std::string& toml : {deep + " = 1", "x = 1\n" + deep + " = 1", "[" + deep + "]",
                                  "x = { " + deep + " = 1 }", "a" + repeated(" . \"b.\\\"\"", 20000) + " = 1"}) {
    INFO(toml.substr(0, 20));
    const std::string line = toml[0] == 'x' && toml[4] == '1' ? "2:" : "1:";
    const std::string place = place_of_error(folder, toml);
    CHECK(place.starts_with(folder.at("scene.toml:" + line)));
    expect_error(ErrorKind::input, place, {"a key of more than 32 parts"}, [&] { folder.load(toml); });
  }
  folder.load("# " + deep + "\n[background]\ncolor = [0.5, 1.5, 2.5" + repeated(" ", 40) + "]\n");
  expect_error(ErrorKind::input, folder.at("scene.toml:2:1"), {"unknown key"},
               [&] { folder.load("\nx = \"\"\"" + deep + "\\\n  \"\"" + deep + "\"\"\"\"\""); });
}

TEST_CASE("TOML values nested in each other without end are refused at their place", "[unit]") {
  const InputFolder folder;
  for (const std::string& toml : {"x = " + repeated("[", 50000), "x = " + repeated("{ a = ", 50000),
                                  "x = " + repeated("{ a.a.a.a.a.a.a.a.a.a.a.a.a.a = ", 5000)}) {
    CHECK(place_of_error(folder, toml).starts_with(folder.at("scene.toml:1:")));
  }
}

TEST_CASE("TOML that is cut off, or holds what its parser does not expect, is refused at its place", "[unit]") {
  const InputFolder folder;
  for (const char* toml : {"[,",
                           "[[,",
                           "[a.,",
                           "[.",
                           "[",
                           "[[",
                           "a",
                           "a =",
                           "a = [",
                           "a = [1",
                           "a = [1,",
                           "a = [[",
                           "a = {",
                           "a = { b",
                           "a = { b =",
                           "a = { b = 1",
                           "a = { b = 1,",
                           "a = \"",
                           "a = \"\\",
                           "a = \"\"\"",
                           "a = \"\"\"\\",
                           "a = '''",
                           "a.",
                           "a = 1.",
                           "a = 0x",
                           "a = 1979-05-27T",
                           "\xef\xbb\x85"
                           "b ",
                           "\xef\xbb\x85"
                           "b = 1",
                           "\xc3\xa9 = 1",
                           "\xef\xbb",
                           "a = 1 \xc3\xa9",
                           "a = \"\"\"\\ \xef\xbb\x85\"\"\"",
                           "a = \"\"\"\\\n\xef\xbb\x85\"\"\"",
                           "a = \"\xff\"",
                           "# \xff\n",
                           "\xef\xbb\xbf\xef\xbb\xbf",
                           "a = 1e999",
                           "a = 99999999999999999999"}) {
    INFO(toml);
    CHECK(place_of_error(folder, toml).starts_with(folder.at("scene.toml:")));
  }
  expect_error(ErrorKind::input, folder.at("scene.toml:2:3"), {"bare key"},
               [&] { folder.load("# \xef\xbb\x85\na.\xef\xbb\x85"); });
  expect_error(ErrorKind::input, folder.at("scene.toml:1:1"), {"unknown key"}, [&] {
    folder.load("x = [\"\xc3\xa9\", '\xef\xbb\x85', \"\"\"\xef\xbb\x85\\n\xc3\xa9\\\\\xc3\xa9\\\n a \xc3\xa9\"\"\"]");
  });
  folder.load("\xef\xbb\xbf# \xef\xbb\x85\n[background] # \xc3\xa9\n");
}

TEST_CASE("what is wrong with TOML is said on one line", "[unit]") {
  const InputFolder folder;
  const std::string toml = "camera = { x = t\n:";
  expect_error(ErrorKind::input, place_of_error(folder, toml), {}, [&] { folder.load(toml); });
}

TEST_CASE("a material file of a name that no system takes, or that leads round in links, is missing", "[unit]") {
  const InputFolder folder;
  REQUIRE(symlink("b.mtl", (folder / "a.mtl").c_str()) == 0);
  REQUIRE(symlink("a.mtl", (folder / "b.mtl").c_str()) == 0);
  for (const std::string& name : {std::string(5000, 'x') + ".mtl", std::string("a.mtl")}) {
    const ObjMesh mesh = folder.obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nmtllib " + name + "\nusemtl m\nf 1 2 3\n");
    INFO(joined(mesh.warnings));
    CHECK(any_line(mesh.warnings, folder.at("mesh.obj:4"), {"material file", "is missing"}));
  }
  REQUIRE(symlink("loop.toml", (folder / "loop.toml").c_str()) == 0);
  expect_error(ErrorKind::input, folder.at("loop.toml"), {"cannot be read", "symbolic links"},
               [&] { load_scene(folder / "loop.toml"); });
  const std::string long_name(5000, 'x');
  expect_error(ErrorKind::input, folder.at(long_name), {"cannot be read", "too long"},
               [&] { load_scene(folder / long_name); });
}

TEST_CASE("names are compared by their beginnings, however long they are", "[unit]") {
  const InputFolder folder;
  const std::string name(1 << 20, 'x');
  expect_error(ErrorKind::input, folder.at("scene.toml:5:12"), {"the nearest known material is \"yxx"}, [&] {
    folder.load("[material]\ny" + name + ".type = \"metal\"\na.type = \"metal\"\n[[sphere]]\nmaterial = \"" + name +
                "\"\ncenter = [0, 0, 0]\nradius = 1\n");
  });
}

TEST_CASE("files of very many materials, material files and unknown statements are read in no time", "[unit]") {
  const InputFolder folder;
  constexpr int count = 60000;
  std::string mtl, obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (int i = 0; i < count; ++i) {
    const std::string number = std::to_string(i);
    mtl += "newmtl a_material_of_number_" + number + "\n";
    obj += "mtllib a.mtl\nunknown_statement_" + number + "\nusemtl a_material_of_number_" + number + "\nf 1 2 3\n";
  }
  folder.write("a.mtl", mtl);
  const ObjMesh mesh = folder.obj(obj);
  CHECK(mesh.materials.size() == count);
  CHECK(mesh.mesh_materials.per_triangle.size() == count);
  CHECK(mesh.warnings.size() == count);
  CHECK(mesh.files.size() == 2);
}
