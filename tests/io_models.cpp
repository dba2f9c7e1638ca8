// Models without a scene file, and what a [[mesh]] does to the model that it names.
#include <algorithm>
#include <cmath>

#include "catch.hpp"
#include "expect_error.hpp"
#include "io_files.hpp"
#include "raylab/accel/accelerator.hpp"
#include "raylab/image/image_file.hpp"
#include "raylab/scene/needs.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

std::string box_text(const vec3& lower, const vec3& upper) {
  std::string text;
  for (int i = 0; i < 8; ++i) {
    text += "v";
    for (int axis = 0; axis < 3; ++axis) text += " " + std::to_string((i >> axis & 1) != 0 ? upper[axis] : lower[axis]);
    text += "\n";
  }
  return text + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
}

/// A scene with one mesh of the triangle, whose table has the lines.
LoadedScene triangle_with(const InputFolder& folder, const std::string& lines) {
  folder.write("triangle.obj", kTriangle);
  return folder.load("[[mesh]]\nfile = \"triangle.obj\"\n" + lines);
}

void check_corners(const LoadedScene& loaded, const std::vector<vec3>& expected) {
  const std::vector<vec3> corners = corners_of(loaded.scene.geometry.meshes.at(0));
  REQUIRE(corners.size() == expected.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    INFO("corner " << i << " at " << corners[i].x << " " << corners[i].y << " " << corners[i].z);
    CHECK(glm::length(corners[i] - expected[i]) < 1e-6f);
  }
}

}  // namespace

TEST_CASE("a model of any place and size is in view, whole and large", "[unit]") {
  InputFolder folder;
  const std::vector<std::array<vec3, 2>> boxes = {{vec3(-1), vec3(1)},
                                                  {vec3(1000, 2000, -3000), vec3(1001, 2100, -2990)},
                                                  {vec3(-1e-4f, 0, 0), vec3(1e-4f, 1e-6f, 2e-4f)},
                                                  {vec3(0, 0, 0), vec3(1e6f, 10, 1e6f)}};
  for (const auto& [lower, upper] : boxes) {
    INFO("from " << lower.x << " " << lower.y << " " << lower.z);
    const LoadedScene loaded = load_scene(folder.write("box.obj", box_text(lower, upper)));
    CHECK(loaded.made_for_model);
    const RenderSettings& size = loaded.scene.render;
    const Camera camera(loaded.camera, size.width, size.height);
    const auto accelerator = make_accelerator("list", loaded.scene.geometry, {});
    int seen = 0, at_edge = 0;
    for (int y = 0; y < size.height; y += 16) {
      for (int x = 0; x < size.width; x += 16) {
        const auto hit = accelerator->intersect(camera.ray(static_cast<float>(x), static_cast<float>(y), vec2(0.0f)));
        const bool on_model = hit && !loaded.scene.geometry.is_sphere(hit->geometry);
        seen += on_model ? 1 : 0;
        at_edge += on_model && (x == 0 || y == 0) ? 1 : 0;
      }
    }
    CHECK(seen > 20);
    CHECK(at_edge == 0);
  }
}

TEST_CASE("a model without a light gets a sky and a key light that is out of view, and another none", "[unit]") {
  InputFolder folder;
  const LoadedScene dark = load_scene(folder.write("dark.obj", kTriangle));
  CHECK_FALSE(dark.scene.environment.is_black());
  REQUIRE(dark.scene.geometry.spheres.size() == 1);
  const Sphere& key = dark.scene.geometry.spheres[0];
  const vec3 view = glm::normalize(dark.camera.look_at - dark.camera.look_from);
  const vec3 to_key = key.center - dark.camera.look_from;
  const float sine = key.radius / glm::length(to_key);
  const float angle = std::acos(glm::dot(view, glm::normalize(to_key))) - std::asin(sine);
  CHECK(angle > 0.5f);  // radians; half of the picture's diagonal is 0.42
  folder.write("lamp.mtl", "newmtl lamp\nKe 5 5 5\n");
  const LoadedScene lit = load_scene(folder.write("lit.obj", "mtllib lamp.mtl\nusemtl lamp\n" + kTriangle));
  CHECK(lit.scene.environment.is_black());
  CHECK(lit.scene.geometry.spheres.empty());
  // A screen does not light the model that it is part of.
  folder.write("lamp.mtl", "newmtl lamp\nKe 0.2 0.2 0.2\n");
  const LoadedScene dim = load_scene(folder / "lit.obj");
  CHECK_FALSE(dim.scene.environment.is_black());
  CHECK(dim.text.find("little light of its own") != std::string::npos);
}

TEST_CASE("the scene made for a model reads back as the same scene from any folder", "[unit]") {
  InputFolder folder;
  const auto model = folder.write("a \"model\" \\.obj", kTriangle);
  const LoadedScene made = load_scene(model);
  const LoadedScene again = load_scene(folder.write("again.toml", made.text));
  CHECK(again.scene.geometry.meshes[0].positions == made.scene.geometry.meshes[0].positions);
  CHECK(again.camera.look_from == made.camera.look_from);
  CHECK_FALSE(again.made_for_model);

  std::filesystem::create_directory(folder / "sub");
  LoadOptions options;
  options.model.folder = folder / "sub";
  const LoadedScene beside = load_scene(model, options);
  CHECK(load_scene(folder.write("sub/scene.toml", beside.text)).scene.geometry.triangle_count() == 1);
}

TEST_CASE("a model of any name is shown, and kept in a scene file where TOML can hold the name", "[unit]") {
  InputFolder folder;
  for (const char* name : {"line\nend.obj", "tab\t.obj", "delete\x7f.obj", "na\xc3\xafve.obj", "odd\xff.obj"}) {
    INFO(name);
    const LoadedScene loaded = load_scene(folder.write(name, kTriangle));
    CHECK(loaded.scene.geometry.triangle_count() == 1);
    if (name == std::string("odd\xff.obj")) continue;
    CHECK(load_scene(folder.write("again.toml", loaded.text)).scene.geometry.triangle_count() == 1);
  }
  LoadOptions kept;
  kept.model.folder = folder.path();
  expect_error(ErrorKind::input, folder.at("odd\xff.obj"), {"not UTF-8"},
               [&] { load_scene(folder / "odd\xff.obj", kept); });
}

TEST_CASE("a model is framed in the shape of the picture", "[unit]") {
  InputFolder folder;
  const auto model = folder.write("long.obj", box_text(vec3(0), vec3(10, 1, 1)));
  const auto distance = [&](int width, int height) {
    LoadOptions options;
    options.model.width = width;
    options.model.height = height;
    const LoadedScene loaded = load_scene(model, options);
    CHECK(loaded.scene.render.width == width);
    CHECK(loaded.scene.render.height == height);
    return glm::length(loaded.camera.look_from - loaded.camera.look_at);
  };
  CHECK(distance(100, 100) > 1.2f * distance(200, 100));
}

TEST_CASE("a model is turned by --up, and --ground puts a ground under it: neither is for scenes", "[unit]") {
  InputFolder folder;
  LoadOptions options;
  options.model.up = 'z';
  options.model.ground = true;
  const LoadedScene loaded = load_scene(folder.write("box.obj", box_text(vec3(0), vec3(1, 1, 3))), options);
  float lowest = 9, highest = -9;
  for (const vec3& p : loaded.scene.geometry.meshes[0].positions) {
    lowest = std::min(lowest, p.y);
    highest = std::max(highest, p.y);
  }
  CHECK(highest - lowest == 3.0f);
  REQUIRE(loaded.scene.geometry.spheres.size() == 2);
  const Sphere& ground = loaded.scene.geometry.spheres[1];
  CHECK(std::abs(ground.center.y + ground.radius - lowest) < 1e-3f);
  expect_error(ErrorKind::usage, folder.at("scene.toml"), {"--ground"},
               [&] { load_scene(folder.write("scene.toml", ""), options); });
}

TEST_CASE("a model without faces still gives a scene", "[unit]") {
  InputFolder folder;
  const LoadedScene loaded = load_scene(folder.write("empty.obj", "v 1 2 3\n"));
  CHECK(any_line(loaded.warnings, folder.at("empty.obj"), {"no faces"}));
}

TEST_CASE("a file of another kind is refused with its kind, under its own name and under a wrong one", "[unit]") {
  InputFolder folder;
  const std::string png = "\x89PNG\r\n\x1a\n";
  struct Case {
    const char* name;
    std::string text;
    const char* found;
    const char* expected;
  };
  const Case cases[] = {
      {"picture.png", png, "a PNG picture", "a scene (TOML) or a model"},
      {"picture.obj", png, "a PNG picture", "a model"},
      {"really.obj", "ply\nformat ascii 1.0\n", "a PLY model", "an OBJ model, as its name says"},
      {"really.ply", kTriangle, "an OBJ model", "a PLY model, as its name says"},
      {"really.toml", kTriangle, "an OBJ model", "a scene (TOML), as its name says"},
      {"really.fbx", "ply\nformat ascii 1.0\n", "a PLY model", "a model of another format, as its name says"},
      {"model.blend", "BLENDER-v300", "a Blender file", "a model"},
      {"model.xml", "<?xml version=\"1.0\"?>", "an XML file", "a model"},
      {"model.bin", std::string("ab\0c", 4), "binary data", "a model"},
      {"archive.obj", "PK\x03\x04", "a zip archive", "a model"},
  };
  for (const Case& c : cases) {
    INFO(c.name);
    expect_error(ErrorKind::input, folder.at(c.name), {c.found, c.expected},
                 [&] { load_scene(folder.write(c.name, c.text)); });
    if (std::string(c.name) == "really.toml") continue;
    expect_error(ErrorKind::input, folder.at(c.name), {c.found},
                 [&] { folder.load("[[mesh]]\nfile = \"" + std::string(c.name) + "\"\n"); });
  }
  expect_error(ErrorKind::input, folder.at("notes.txt"), {"text that is no model's"},
               [&] { folder.write("notes.txt", "hello\n"), folder.load("[[mesh]]\nfile = \"notes.txt\"\n"); });
}

TEST_CASE("obj names OBJ files alone, and file any", "[unit]") {
  InputFolder folder;
  folder.write("a.obj", kTriangle);
  CHECK(folder.load("[[mesh]]\nobj = \"a.obj\"\n").scene.geometry.triangle_count() == 1);
  CHECK(folder.load("[[mesh]]\nfile = \"a.obj\"\n").scene.geometry.triangle_count() == 1);
  expect_error(ErrorKind::input, folder.at("scene.toml:2:7"), {"only one of file, obj"},
               [&] { folder.load("[[mesh]]\nobj = \"a.obj\"\nfile = \"a.obj\"\n"); });
}

TEST_CASE("a model that many meshes name is read once", "[unit]") {
  InputFolder folder;
  folder.write("a.obj", "mystery 1\n" + kTriangle);
  std::filesystem::create_symlink("a.obj", folder / "b.obj");
  const LoadedScene loaded = folder.load(
      "[[mesh]]\nfile = \"a.obj\"\n[[mesh]]\nfile = \"b.obj\"\ntranslate = [1, 0, 0]\n[[mesh]]\nfile = \"./a.obj\"\n");
  CHECK(loaded.scene.geometry.triangle_count() == 3);
  CHECK(loaded.warnings.size() == 1);  // what is not understood is told each time that a file is read
  CHECK(loaded.scene.geometry.meshes[1].positions[0] == vec3(1, 0, 0));
  CHECK(loaded.scene.geometry.meshes[2].positions[0] == vec3(0, 0, 0));
}

TEST_CASE("up turns the axis that it names upwards", "[unit]") {
  InputFolder folder;
  check_corners(triangle_with(folder, "up = \"y\"\n"), {vec3(0), vec3(1, 0, 0), vec3(0, 1, 0)});
  check_corners(triangle_with(folder, "up = \"z\"\n"), {vec3(0), vec3(1, 0, 0), vec3(0, 0, -1)});
  check_corners(triangle_with(folder, "up = \"x\"\n"), {vec3(0), vec3(0, 1, 0), vec3(-1, 0, 0)});
}

TEST_CASE("the steps of a transform are taken in their order", "[unit]") {
  InputFolder folder;
  check_corners(triangle_with(folder, "transform = [{ translate = [1, 0, 0] }, { scale = 2 }]\n"),
                {vec3(2, 0, 0), vec3(4, 0, 0), vec3(2, 2, 0)});
  check_corners(triangle_with(folder, "transform = [{ scale = 2 }, { translate = [1, 0, 0] }]\n"),
                {vec3(1, 0, 0), vec3(3, 0, 0), vec3(1, 2, 0)});
  check_corners(triangle_with(folder, "transform = [{ rotate_x = 90 }]\n"), {vec3(0), vec3(1, 0, 0), vec3(0, 0, 1)});
  check_corners(triangle_with(folder, "transform = [{ rotate_y = 90 }]\n"), {vec3(0), vec3(0, 0, -1), vec3(0, 1, 0)});
  check_corners(triangle_with(folder, "transform = [{ rotate_z = 90 }]\n"), {vec3(0), vec3(0, 1, 0), vec3(-1, 0, 0)});
  check_corners(triangle_with(folder, "transform = [{ rotate = { axis = [2, 2, 2], degrees = 120 } }]\n"),
                {vec3(0), vec3(0, 1, 0), vec3(0, 0, 1)});
  check_corners(triangle_with(folder, "scale = [1, 2, 3]\nrotate_y = 180\ntranslate = [0, 0, 1]\nup = \"z\"\n"),
                {vec3(0, 0, 1), vec3(-1, 0, 1), vec3(0, 0, 4)});
}

TEST_CASE("a mirrored mesh keeps its outside and its normals", "[unit]") {
  InputFolder folder;
  folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0.6 0 0.8\nvn 0 0 1\nf 1//1 2//2 3//2\n");
  const LoadedScene loaded = folder.load("[[mesh]]\nfile = \"a.obj\"\nscale = [-2, 1, 1]\n");
  const TriangleMesh& mesh = loaded.scene.geometry.meshes[0];
  const Triangle t = triangle_corners(mesh, 0);
  CHECK(glm::cross(t.p1 - t.p0, t.p2 - t.p0).z > 0.0f);
  const vec3 n = mesh.normals[mesh.normal_corners(0).x];
  CHECK(glm::length(n - glm::normalize(vec3(-0.3f, 0.0f, 0.8f))) < 1e-6f);
  CHECK(mesh.positions[mesh.triangles[0].y] == vec3(0, 1, 0));
}

TEST_CASE("smooth makes normals, and flip_v turns texture coordinates over", "[unit]") {
  InputFolder folder;
  folder.write("roof.obj", "v 0 0 0\nv 0 0 1\nv 1 0.2 0\nv -1 0.2 0\nvt 0.25 0.75\nf 1/1 2/1 3/1\nf 2/1 1/1 4/1\n");
  const LoadedScene smooth = folder.load("[[mesh]]\nfile = \"roof.obj\"\nsmooth = 30\nflip_v = true\n");
  CHECK(smooth.scene.geometry.meshes[0].normals.size() > 0);
  CHECK(smooth.scene.geometry.meshes[0].texcoords[0] == vec2(0.25f, 0.25f));
  const LoadedScene flat = folder.load("[[mesh]]\nfile = \"roof.obj\"\nsmooth = 10\n");
  CHECK(flat.scene.geometry.meshes[0].normals.empty());
  CHECK(flat.scene.geometry.meshes[0].texcoords[0] == vec2(0.25f, 0.75f));
}

TEST_CASE("what a mesh cannot do is refused at its place", "[unit]") {
  InputFolder folder;
  struct Case {
    const char* line;
    const char* place;
    const char* message;
  };
  const Case cases[] = {
      {"up = \"w\"", "3:6", "\"x\", \"y\" or \"z\""},
      {"scale = [1, 0, 1]", "3:13", "not 0"},
      {"smooth = 181", "3:10", "0 to 180"},
      {"flip_v = 1", "3:10", "true or false"},
      {"transform = 3", "3:13", "steps in order"},
      {"transform = [{ scale = 2, rotate_x = 1 }]", "3:14", "one of scale"},
      {"transform = [{}]", "3:14", "one of scale"},
      {"transform = [{ turn = 2 }]", "3:16", "known keys are \"scale\""},
      {"transform = [{ rotate = { axis = [0, 0, 0], degrees = 3 } }]", "3:34", "not [0, 0, 0]"},
      {"transform = [{ rotate = { axis = [0, 0, 1] } }]", "3:25", "degrees"},
      {"scale = 2\ntransform = []", "4:13", "steps of it"},
      {"transform = [{ scale = 1e30 }, { scale = 1e30 }]", "1:1", "too far away"},
  };
  for (const Case& c : cases) {
    INFO(c.line);
    expect_error(ErrorKind::input, folder.at("scene.toml:" + std::string(c.place)), {c.message},
                 [&] { triangle_with(folder, std::string(c.line) + "\n"); });
  }
}
