// What raylab-render says of scenes: errors of bad ones, and warnings of pictures that will not be what was wanted.
#include <algorithm>

#include "raylab/image/image_file.hpp"
#include "small_scene.hpp"

using namespace raylab;
using namespace raylab::test;
namespace fs = std::filesystem;

TEST_CASE("a picture that will not be what was wanted is rendered, with a warning of what to do", "[cli]") {
  SmallScene small;
  const auto warning = [&](std::vector<std::string> arguments = {}) {
    arguments.insert(arguments.begin(), {small.scene, "-o", small.output});
    const ProgramResult result = raylab_render(arguments);
    CHECK(result.exit_code == 0);
    CHECK(std::count(result.err.begin(), result.err.end(), '\n') <= 1);
    return result.err;
  };
  const auto holds = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
  CHECK(warning().empty());
  CHECK(warning({"--quiet", "--set", "background.color=[0, 0, 0]"}).empty());
  CHECK(holds(warning({"--set", "background.color=[0, 0, 0]"}), "warning: the scene has no light"));
  CHECK(holds(warning({"--set", "camera.look_at=[0, 0, 9]"}),
              "warning: the camera sees nothing of the scene, which lies from [-1, -1, -1] to [1, 1, 1]: "
              "camera.look_at = [0, 0, 0] looks there"));
  small.change("[[sphere]]", "[[mesh]]\nfile = \"m.obj\"\n[[sphere]]");
  write_text(small / "m.obj", "v 50 0 0\nv 51 0 0\nv 50 1 0\nf 1 2 3\n");
  CHECK(holds(warning(), "warning: the camera sees no mesh; meshes lie from [50, 0, 0]"));
  // A lamp inside a closed ball lights nothing that is seen.
  small.change("[[sphere]]",
               "[material.lamp]\ntype = \"diffuse_light\"\n[[sphere]]\ncenter = [0, 0, 0]\n"
               "radius = 0.5\nmaterial = \"lamp\"\n[[sphere]]");
  CHECK(holds(warning({"--set", "background.color=[0, 0, 0]"}), "warning: the picture is black: no light reaches"));
}

TEST_CASE("layers that no file takes are told of", "[cli]") {
  const SmallScene small;
  const ProgramResult result =
      raylab_render({small.scene, "-o", (small / "a.png").string(), "--layers", "normal", "--spp", "1"});
  CHECK(result.exit_code == 0);
  CHECK(result.err.find("warning: --layers: nothing is written of them") != std::string::npos);
  CHECK(result.out.find("not estimated: that takes two samples per pixel") != std::string::npos);
}

TEST_CASE("a bad scene exits with 3, with place and value", "[cli]") {
  SmallScene small;
  const std::string file = small.scene;
  SECTION("a missing scene file") {
    fs::remove(small.scene);
    small.expect_failure(3, {file});
  }
  SECTION("a syntax error") {
    small.change("vfov = 40", "vfov = = 40");
    small.expect_failure(3, {file + ":4:"});
  }
  SECTION("a wrong type") {
    small.change("vfov = 40", "vfov = \"wide\"");
    small.expect_failure(3, {file + ":4:", "wide"});
  }
  SECTION("an unknown key") {
    small.change("vfov = 40", "vfow = 40");
    small.expect_failure(3, {file + ":4:", "vfow", "vfov"});
  }
  SECTION("a picture without pixels") {
    small.change("width = 16", "width = 0");
    small.expect_failure(3, {file + ":6:", "0"});
  }
  SECTION("a camera that looks along up") {
    small.change("look_at = [0, 0, 0]", "look_at = [0, 9, 5]");
    small.expect_failure(3, {file, "up"});
  }
  SECTION("a camera that looks nowhere") {
    small.change("look_at = [0, 0, 0]", "look_at = [0, 0, 5]");
    small.expect_failure(3, {file, "look_at"});
  }
  SECTION("a missing mesh") {
    small.change("[[sphere]]", "[[mesh]]\nobj = \"nowhere.obj\"\n[[sphere]]");
    small.expect_failure(3, {file + ":16:", "nowhere.obj"});
  }
  SECTION("an index out of range") {
    write_text(small / "bad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n");
    small.change("[[sphere]]", "[[mesh]]\nobj = \"bad.obj\"\nmaterial = \"grey\"\n[[sphere]]");
    small.expect_failure(3, {(small / "bad.obj").string() + ":4", "4"});
  }
  SECTION("a vertex that is no number") {
    write_text(small / "bad.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n");
    small.change("[[sphere]]", "[[mesh]]\nobj = \"bad.obj\"\nmaterial = \"grey\"\n[[sphere]]");
    small.expect_failure(3, {(small / "bad.obj").string() + ":2", "nan"});
  }
}

TEST_CASE("a missing texture is a warning by name and shows in magenta", "[cli]") {
  const SmallScene small;
  write_text(small / "wall.mtl", "newmtl wall\nillum 2\nKd 1 1 1\nmap_Kd missing.png\n");
  write_text(small / "wall.obj",
             "mtllib wall.mtl\nv -9 -9 0\nv 9 -9 0\nv 9 9 0\nv -9 9 0\nvt 0 0\nusemtl wall\nf 1/1 2/1 3/1 4/1\n");
  write_text(small.scene,
             "[camera]\nlook_from = [0, 0, 5]\nlook_at = [0, 0, 0]\n[background]\ncolor = [1, 1, 1]\n"
             "[[mesh]]\nobj = \"wall.obj\"\n");
  const ProgramResult result =
      raylab_render({small.scene, "-o", small.output, "--width", "4", "--height", "4", "--spp", "16"});
  INFO(result.err);
  REQUIRE(result.exit_code == 0);
  CHECK(result.err.find("wall.mtl:4") != std::string::npos);
  CHECK(result.err.find("missing.png") != std::string::npos);
  const Rgb pixel = read_exr(small.output).at(2, 2);
  CHECK(pixel.r > 0.5f);
  CHECK(pixel.g == 0.0f);
  CHECK(pixel.b == pixel.r);
}

TEST_CASE("an empty scene renders its background, with a warning", "[cli]") {
  const SmallScene small;
  write_text(small.scene,
             "[camera]\nlook_from = [0, 0, 5]\nlook_at = [0, 0, 0]\n[background]\ncolor = [0.25, 0.5, 1]\n");
  const ProgramResult result = raylab_render({small.scene, "-o", small.output, "--width", "2", "--height", "2"});
  CHECK(result.exit_code == 0);
  CHECK(result.err.find("warning") != std::string::npos);
  CHECK(read_exr(small.output).at(1, 1) == Rgb(0.25f, 0.5f, 1.0f));
}
