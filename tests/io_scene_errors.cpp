// Every bad scene file is refused at its exact place, with the value found.
#include "catch.hpp"
#include "expect_error.hpp"
#include "io_files.hpp"
#include "raylab/image/image_file.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

const std::string kWhite = "material.white.type = \"lambertian\"\n";
const std::string kBall = "[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\nmaterial = \"white\"\n";

struct BadScene {
  std::string toml;
  const char* location;  // line:column, or empty for the file alone
  std::vector<const char*> parts;
};

void expect_all(const InputFolder& folder, const std::vector<BadScene>& scenes) {
  for (const BadScene& bad : scenes) {
    INFO(bad.toml);
    const std::string place = folder.at("scene.toml") + (*bad.location == '\0' ? "" : ":") + bad.location;
    expect_error(ErrorKind::input, place, {}, [&] { folder.load(bad.toml); });
    for (const char* part : bad.parts) {
      expect_error(ErrorKind::input, place, {part}, [&] { folder.load(bad.toml); });
    }
  }
}

}  // namespace

TEST_CASE("a missing scene file and a folder in its place are refused by name", "[unit]") {
  InputFolder folder;
  expect_error(ErrorKind::input, folder.at("absent.toml"), {"cannot be read", "No such file"},
               [&] { load_scene(folder / "absent.toml"); });
  expect_error(ErrorKind::input, folder.path().string(), {"cannot be read", "directory"},
               [&] { load_scene(folder.path()); });
}

TEST_CASE("a syntax error is placed where TOML breaks", "[unit]") {
  InputFolder folder;
  // The column is the parser's choice.
  const std::vector<std::pair<std::string, std::string>> broken = {{"[camera]\nvfov = = 3\n", "2:"},
                                                                   {"[render]\nwidth = 12px\n", "2:"},
                                                                   {"[render]\nwidth = 1\nwidth = 2\n", "3:"},
                                                                   {"[render]\nwidth = 1\u00e9\n", "2:"}};
  for (const auto& [toml, line] : broken) {
    INFO(toml);
    const std::string place = folder.at("scene.toml:" + line);
    try {
      folder.load(toml);
      FAIL("no error was thrown");
    } catch (const Error& error) {
      CHECK(error.kind() == ErrorKind::input);
      CHECK(error.location().substr(0, place.size()) == place);
      CHECK(error.location().size() > place.size());
    }
  }
}

TEST_CASE("views without a name of their own, or that look nowhere, are refused", "[unit]") {
  InputFolder folder;
  expect_all(folder, {{"[[view]]\nvfov = 3\n", "1:1", {"view.0", "\"name\""}},
                      {"[[view]]\nname = \"a b\"\n", "2:8", {"view.0.name", "letters, digits, - and _"}},
                      {"[[view]]\nname = \"a\"\n[[view]]\nname = \"a\"\n", "4:8", {"view.1.name", "no view before"}},
                      {"[[view]]\nname = \"a\"\nlook_at = [0, 0, 0]\n", "3:11", {"view.0", "the same point"}}});
}

TEST_CASE("a scene file of a later version is refused by it, whatever else it holds", "[unit]") {
  InputFolder folder;
  expect_all(folder, {{"unknown = 3\nversion = 2\n", "2:11", {"version: found 2", "scene files of version 1"}},
                      {"version = 0\n", "1:11", {"version: found 0", "at least 1"}},
                      {"version = \"1\"\n", "1:11", {"version: found \"1\"", "an integer"}}});
  CHECK(folder.load("version = 1\n[camera]\nvfov = 33\n").camera.vfov == 33.0f);
}

TEST_CASE("an unknown key is refused with the nearest known one", "[unit]") {
  InputFolder folder;
  expect_all(folder, {{"[camrea]\nvfov = 3\n", "1:2", {"unknown key \"camrea\"", "\"camera\""}},
                      {"[camera]\nvfvo = 3\n", "2:1", {"unknown key \"vfvo\" in camera", "\"vfov\""}},
                      {"[render]\n\n  spp = 3\n",
                       "3:3",
                       {"unknown key \"spp\" in render: known keys are \"width\"", "\"samples_per_pixel\""}},
                      {"[background]\ncolour = [0, 0, 0]\n", "2:1", {"\"colour\"", "\"color\""}},
                      {kWhite + "material.white.albdeo = 1\n" + kBall, "2:16", {"material.white", "\"albedo\""}},
                      {kWhite + kBall + "colour = 3\n", "6:1", {"\"colour\" in sphere.0"}},
                      {"[[mesh]]\nobj = \"a.obj\"\nscal = 2\n", "3:1", {"mesh.0", "\"scale\""}}});
}

TEST_CASE("a key that has no effect with the type of material is unknown", "[unit]") {
  InputFolder folder;
  expect_all(folder, {{kWhite + "material.white.fuzz = 0.5\n" + kBall,
                       "2:16",
                       {"unknown key \"fuzz\"", "which is lambertian", "a key of metal"}},
                      {"[material.white]\ntype = \"dielectric\"\nalbedo = [1, 1, 1]\n" + kBall, "3:1", {"albedo"}}});
}

TEST_CASE("a value of the wrong type is refused with what was found and what was expected", "[unit]") {
  InputFolder folder;
  expect_all(folder, {{"camera = 3\n", "1:10", {"camera", "found 3", "a table"}},
                      {"[camera]\nvfov = \"wide\"\n", "2:8", {"camera.vfov", "found \"wide\"", "number"}},
                      {"[camera]\nlook_at = 1\n", "2:11", {"found 1", "three numbers"}},
                      {"[camera]\nlook_at = [1, 2]\n", "2:11", {"found [1, 2]", "three numbers"}},
                      {"[camera]\nlook_at = [1, true, 3]\n", "2:15", {"found true", "number"}},
                      {"[render]\nwidth = 12.5\n", "2:9", {"found 12.5", "an integer"}},
                      {"[mesh]\nobj = \"a.obj\"\n", "1:1", {"found a table", "[[mesh]]"}},
                      {"sphere = [3]\n", "1:11", {"found 3", "[[sphere]]"}},
                      {"material = 1\n", "1:12", {"found 1", "[material.NAME]"}},
                      {"[material]\nwhite = 1\n", "2:9", {"material.white", "found 1", "a table"}},
                      {"[camera]\nvfov = 1979-05-27\n", "2:8", {"found 1979-05-27"}},
                      {"[[mesh]]\nobj = 7\n", "2:7", {"mesh.0.obj", "found 7", "text"}},
                      {kWhite + "material.white.albedo = 0.5\n" + kBall, "2:25", {"found 0.5", "[r, g, b]"}}});
}

TEST_CASE("numbers out of range are refused with the range", "[unit]") {
  InputFolder folder;
  expect_all(
      folder,
      {{"[camera]\nvfov = 0\n", "2:8", {"found 0", "(0, 180)"}},
       {"[camera]\nvfov = 180\n", "2:8", {"found 180", "(0, 180)"}},
       {"[camera]\nvfov = nan\n", "2:8", {"found nan"}},
       {"[camera]\ndefocus_angle = -1\n", "2:17", {"found -1", "[0, 180)"}},
       {"[camera]\nfocus_distance = 0.0\n", "2:18", {"found 0", "above 0"}},
       {"[camera]\nlook_at = [0, inf, 0]\n", "2:15", {"found inf", "finite"}},
       {"[camera]\nlook_at = [0, 1e39, 0]\n", "2:15", {"found 1e+39", "finite"}},
       {"[render]\nwidth = 0\n", "2:9", {"found 0", "at least 1"}},
       {"[render]\nwidth = -4\n", "2:9", {"found -4"}},
       {"[render]\nheight = 0\n", "2:10", {"found 0"}},
       {"[render]\nsamples_per_pixel = 0\n", "2:21", {"found 0"}},
       {"[render]\nmax_depth = 0\n", "2:13", {"found 0"}},
       {"[render]\nwidth = 3000000000\n", "2:9", {"found 3000000000"}},
       {"[render]\nwidth = 32768\nheight = 8193\n", "2:9", {"32768 x 8193", "268435456"}},
       {"[background]\ncolor = [0, -0.5, 0]\n", "2:13", {"found -0.5", "at least 0"}},
       {kWhite + "material.white.albedo = [0, 1.5, 0]\n" + kBall, "2:29", {"found 1.5", "[0, 1]"}},
       {"[material.white]\ntype = \"metal\"\nfuzz = 1.01\n" + kBall, "3:8", {"found 1.01", "[0, 1]"}},
       {"[material.white]\ntype = \"dielectric\"\nindex = 0\n" + kBall, "3:9", {"found 0", "above 0"}},
       {"[material.white]\ntype = \"diffuse_light\"\nradiance = [1, 2, -3]\n" + kBall, "3:19", {"found -3"}},
       {kWhite + "sphere = [{center = [0, 0, 0], radius = 0, material = \"white\"}]\n",
        "2:41",
        {"sphere.0.radius", "found 0", "above 0"}},
       // Smaller than the smallest float: it would become 0.
       {kWhite + "sphere = [{center = [0, 0, 0], radius = 1e-60, material = \"white\"}]\n", "2:41", {"found 1e-60"}},
       {"[[mesh]]\nobj = \"a.obj\"\nscale = 0\n", "3:9", {"mesh.0.scale", "found 0"}},
       {kWhite + "material.white.albedo = { checker = 0, even = [0, 0, 0], odd = [1, 1, 1] }\n" + kBall,
        "2:37",
        {"checker", "found 0"}}});
  // The largest picture is not refused.
  CHECK(folder.load("[render]\nwidth = 32768\nheight = 8192\n").scene.render.width == 32768);
}

TEST_CASE("a camera without a direction is refused at the key that takes it away", "[unit]") {
  InputFolder folder;
  expect_all(folder, {{"[camera]\nlook_from = [1, 2, 3]\nlook_at = [1, 2, 3]\n", "3:11", {"same point"}},
                      {"[camera]\nlook_from = [0, 0, -1]\n", "2:13", {"same point"}},
                      {"[camera]\nup = [0, 0, 0]\n", "2:6", {"length zero"}},
                      {"[camera]\nlook_at = [0, 5, 0]\n", "2:11", {"runs along up"}},
                      {"[camera]\nlook_at = [1, 2, 3]\nup = [-2, -4, -6]\n", "3:6", {"runs along up"}}});
}

TEST_CASE("keys that exclude each other or need each other are refused", "[unit]") {
  InputFolder folder;
  const std::string albedo = kWhite + "material.white.albedo = ";
  expect_all(folder,
             {{"[background]\ncolor = [0, 0, 0]\nimage = \"sky.exr\"\n", "3:9", {"only one of color"}},
              {"[background]\ncolor = [0, 0, 0]\nbottom = [0, 0, 0]\ntop = [0, 0, 0]\n", "3:10", {"only one of color"}},
              {"[background]\ntop = [0, 0, 0]\n", "2:7", {"bottom and top together"}},
              {albedo + "{ checker = 1, image = \"a.png\" }\n" + kBall, "2:25", {"only one of image, checker"}},
              {albedo + "{ checker = 1, even = [0, 0, 0] }\n" + kBall, "2:25", {"has no \"odd\""}},
              {albedo + "{ checker = 1, evn = [0, 0, 0], odd = [0, 0, 0] }\n" + kBall, "2:40", {"\"evn\"", "\"even\""}},
              {kWhite + "mesh = [{obj = \"a.obj\", material = \"white\", mtl = \"seed\"}]\n", "2:51", {"no effect"}},
              {"mesh = [{obj = \"a.obj\", mtl = \"pbr\"}]\n", "1:31", {"found \"pbr\"", "\"seed\""}}});
}

TEST_CASE("required keys that are missing are named at their table", "[unit]") {
  InputFolder folder;
  expect_all(folder, {{"[material.white]\nalbedo = [0, 0, 0]\n" + kBall, "1:1", {"material.white", "\"type\""}},
                      {kWhite + "[[sphere]]\nradius = 1\nmaterial = \"white\"\n", "2:1", {"sphere.0", "\"center\""}},
                      {kWhite + "[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\n", "2:1", {"sphere.0", "\"material\""}},
                      {"[[mesh]]\nscale = 2\n", "1:1", {"mesh.0", "\"file\""}}});
}

TEST_CASE("a material that is unknown, unused or of an unknown type is refused by name", "[unit]") {
  InputFolder folder;
  expect_all(folder, {{"[material.whyte]\ntype = \"lambertian\"\n" + kBall, "6:12", {"\"white\"", "\"whyte\""}},
                      {kBall, "4:12", {"\"white\"", "defines none"}},
                      {kWhite + "[material.spare]\ntype = \"metal\"\n" + kBall, "2:11", {"\"spare\"", "used by no"}},
                      {"[material.white]\ntype = \"lambertain\"\n" + kBall,
                       "2:8",
                       {"found \"lambertain\"", "diffuse_light", "nearest known type is \"lambertian\""}}});
}

TEST_CASE("files that the scene file names must exist and hold what they should", "[unit]") {
  InputFolder folder;
  Image bright(1, 1);
  bright.at(0, 0) = Rgb(2.0f);
  write_exr(folder / "bright.exr", bright);
  Image dark(1, 1);
  dark.at(0, 0) = Rgb(0.0f, -1.0f, 0.0f);
  write_exr(folder / "dark.exr", dark);
  const std::string albedo = kWhite + "material.white.albedo = ";
  expect_all(folder,
             {{"[[mesh]]\nobj = \"absent.obj\"\n", "2:7", {"found \"absent.obj\"", "an existing file"}},
              {albedo + "{ image = \"absent.png\" }\n" + kBall, "2:35", {"found \"absent.png\"", "an existing file"}},
              {albedo + "{ image = \"bright.exr\" }\n" + kBall, "2:35", {"(2, 2, 2)", "[0, 1]"}},
              {"[background]\nimage = \"absent.exr\"\n", "2:9", {"found \"absent.exr\"", "an existing file"}},
              {"[background]\nimage = \"sky.png\"\n", "2:9", {"found \"sky.png\"", "EXR"}}});
  expect_error(ErrorKind::input, folder.at("dark.exr"), {"pixel (0, 0)", "(0, -1, 0)"},
               [&] { folder.load("[background]\nimage = \"dark.exr\"\n"); });
}

TEST_CASE("a mesh that its transform takes out of the range of floats is refused", "[unit]") {
  InputFolder folder;
  folder.write("mesh.obj", "v 1e30 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  expect_all(folder, {{"\n[[mesh]]\nobj = \"mesh.obj\"\nscale = 1e10\n", "2:1", {"mesh.obj", "too far away"}}});
}

TEST_CASE("a scene is checked to its end before its meshes are loaded", "[unit]") {
  InputFolder folder;
  folder.write("bad.obj", "v nan 0 0\n");
  expect_all(folder, {{"[[mesh]]\nobj = \"bad.obj\"\n[[mesh]]\nobj = \"bad.obj\"\nscael = 1\n", "5:1", {"scael"}}});
}
