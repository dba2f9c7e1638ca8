// What a scene file says is what the scene holds.
#include "catch.hpp"
#include "io/file_bytes.hpp"
#include "io_files.hpp"
#include "raylab/core/text.hpp"
#include "raylab/image/image_file.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const std::string kWhite = "[material.white]\ntype = \"lambertian\"\nalbedo = [0.7, 0.8, 0.9]\n";
const std::string kBall = "[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\nmaterial = \"white\"\n";

}  // namespace

TEST_CASE("every key of the camera and render tables is read", "[unit]") {
  InputFolder folder;
  const LoadedScene loaded = folder.load(R"(
[camera]
look_from = [1, 2.5, -3]
look_at = [0, 1, 0]
up = [0, 0, 1]
vfov = 40
defocus_angle = 0.5
focus_distance = 7
[render]
width = 320
height = 200
samples_per_pixel = 9
max_depth = 11
)");
  const Scene& scene = loaded.scene;
  CHECK(scene.name == "scene");
  CHECK(loaded.camera.look_from == vec3(1.0f, 2.5f, -3.0f));
  CHECK(loaded.camera.look_at == vec3(0.0f, 1.0f, 0.0f));
  CHECK(loaded.camera.up == vec3(0.0f, 0.0f, 1.0f));
  CHECK(loaded.camera.vfov == 40.0f);
  CHECK(loaded.camera.defocus_angle == 0.5f);
  CHECK(loaded.camera.focus_distance == 7.0f);
  CHECK(scene.render.width == 320);
  CHECK(scene.render.height == 200);
  CHECK(scene.render.samples_per_pixel == 9);
  CHECK(scene.render.max_depth == 11);
}

TEST_CASE("a camera given in part keeps the defaults for the rest", "[unit]") {
  InputFolder folder;
  const CameraSettings camera = folder.load("[camera]\nvfov = 33\n").camera;
  const CameraSettings defaults;
  CHECK(camera.vfov == 33.0f);
  CHECK(camera.look_at == defaults.look_at);
  CHECK(camera.focus_distance == defaults.focus_distance);
}

TEST_CASE("a text of several lines goes on with any letter after a line that ends in a backslash", "[unit]") {
  InputFolder folder;
  folder.write("\u00e9.obj", kTriangle);
  const LoadedScene loaded =
      folder.load(kWhite + "[[mesh]]\nmaterial = \"white\"\nobj = \"\"\"\\\n  \u00e9.obj\"\"\"\n");
  CHECK(loaded.scene.geometry.primitive_count() == 1);
}

TEST_CASE("an empty scene is valid and warns that only the background can be seen", "[unit]") {
  InputFolder folder;
  const LoadedScene loaded = folder.load("");
  CHECK(loaded.scene.geometry.primitive_count() == 0);
  CHECK(any_line(loaded.warnings, folder.at("scene.toml"), {"no mesh and no sphere"}));
  CHECK(folder.load(kWhite + kBall).warnings.empty());
}

TEST_CASE("each material type reaches the scene with a note of how it was understood", "[unit]") {
  InputFolder folder;
  const LoadedScene loaded = folder.load(kWhite + kBall + R"([material.steel]
type = "metal"
albedo = [0.5, 0.6, 0.7]
fuzz = 0.25
[material.glass]
type = "dielectric"
index = 1.33
[material.lamp]
type = "diffuse_light"
radiance = [4, 5, 6]
[[sphere]]
center = [1, 2, 3]
radius = 0.5
material = "steel"
[[sphere]]
center = [4, 5, 6]
radius = 2
material = "glass"
[[sphere]]
center = [7, 8, 9]
radius = 3
material = "lamp"
)");
  const Scene& scene = loaded.scene;
  REQUIRE(scene.geometry.spheres.size() == 4);
  CHECK(scene.geometry.spheres[1].center == vec3(1.0f, 2.0f, 3.0f));
  CHECK(scene.geometry.spheres[1].radius == 0.5f);
  const auto material = [&](std::size_t i) { return scene.materials.at(scene.sphere_materials.at(i)); };
  CHECK(material(0).kind == Material::Kind::lambertian);
  CHECK(material(0).color.a == Rgb(0.7f, 0.8f, 0.9f));
  CHECK(material(1).kind == Material::Kind::metal);
  CHECK(material(1).color.a == Rgb(0.5f, 0.6f, 0.7f));
  CHECK(material(1).fuzz == 0.25f);
  CHECK(material(2).kind == Material::Kind::dielectric);
  CHECK(material(2).index == 1.33f);
  CHECK(material(3).kind == Material::Kind::diffuse_light);
  CHECK(material(3).color.a == Rgb(4.0f, 5.0f, 6.0f));
  INFO(joined(loaded.notes));
  CHECK(any_line(loaded.notes, folder.at("scene.toml:1:1"), {"\"white\": lambertian, albedo (0.7, 0.8, 0.9)"}));
  CHECK(any_line(loaded.notes, folder.at("scene.toml:8:1"), {"\"steel\": metal, albedo (0.5, 0.6, 0.7), fuzz 0.25"}));
  CHECK(any_line(loaded.notes, folder.at("scene.toml:12:1"), {"\"glass\": dielectric, index 1.33"}));
  CHECK(any_line(loaded.notes, folder.at("scene.toml:15:1"), {"\"lamp\": diffuse_light, radiance (4, 5, 6)"}));
}

TEST_CASE("metal has no fuzz and a dielectric the index 1.5 unless the scene says so", "[unit]") {
  InputFolder folder;
  const Scene scene = folder
                          .load(R"(
material.m.type = "metal"
material.d.type = "dielectric"
sphere = [{center = [0, 0, 0], radius = 1, material = "m"}, {center = [3, 0, 0], radius = 1, material = "d"}]
)")
                          .scene;
  CHECK(scene.materials.at(scene.sphere_materials[0]).fuzz == 0.0f);
  CHECK(scene.materials.at(scene.sphere_materials[1]).index == 1.5f);
}

TEST_CASE("a checker keeps its size and both colours", "[unit]") {
  InputFolder folder;
  const Scene scene = folder
                          .load(R"(
[material.white]
type = "lambertian"
albedo = { checker = 50, even = [1, 0.5, 0], odd = [0, 0, 1] }
)" + kBall)
                          .scene;
  const Texture& texture = scene.materials.at(scene.sphere_materials[0]).color;
  CHECK(texture.kind == Texture::Kind::checker);
  CHECK(texture.size == 50.0f);
  CHECK(texture.a == Rgb(1.0f, 0.5f, 0.0f));
  CHECK(texture.b == Rgb(0.0f, 0.0f, 1.0f));
}

TEST_CASE("an image texture is decoded from sRGB once, with its mean, however many materials use it", "[unit]") {
  InputFolder folder;
  Image picture(2, 1);
  const float grey = srgb_to_linear(128.0f / 255.0f);
  picture.at(0, 0) = Rgb(grey, 0.0f, 1.0f);
  picture.at(1, 0) = Rgb(0.0f, 0.0f, 1.0f);
  write_png(folder / "map.png", picture);
  folder.write("mesh.obj", "mtllib mesh.mtl\nusemtl textured\nvt 0 0\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1 2/1 3/1\n");
  folder.write("mesh.mtl", "newmtl textured\nmap_Kd ./map.png\n");
  const LoadedScene loaded = folder.load(R"([material.white]
type = "lambertian"
albedo = { image = "map.png" }
[material.lamp]
type = "diffuse_light"
radiance = { image = "map.png" }
[[sphere]]
center = [5, 0, 0]
radius = 1
material = "lamp"
[[mesh]]
obj = "mesh.obj"
)" + kBall);
  const Scene& scene = loaded.scene;
  REQUIRE(scene.textures.size() == 1);
  for (const Material& material : scene.materials) {
    CHECK(material.color.kind == Texture::Kind::image);
    CHECK(material.color.image == 0);
  }
  const TextureImage& texture = scene.textures[0];
  CHECK(texture.name == "map.png");
  CHECK(texture.width == 2);
  CHECK(texture.height == 1);
  CHECK(texture.texels.at(0).r == Approx(grey).margin(1e-6));
  CHECK(texture.texels.at(1) == Rgb(0.0f, 0.0f, 1.0f));
  CHECK(texture.mean.r == Approx(grey / 2).margin(1e-6));
  CHECK(texture.mean.b == 1.0f);
  CHECK(any_line(loaded.notes, folder.at("scene.toml:1:1"), {"albedo \"map.png\" (2 x 1)"}));
}

TEST_CASE("the background is one colour, a gradient or an EXR picture", "[unit]") {
  InputFolder folder;
  const Environment none = folder.load("").scene.environment;
  CHECK(none.is_black());
  const Environment color = folder.load("[background]\ncolor = [1, 2, 3]\n").scene.environment;
  CHECK(color.kind == Environment::Kind::constant);
  CHECK(color.bottom == Rgb(1.0f, 2.0f, 3.0f));
  const Environment gradient = folder.load("[background]\nbottom = [1, 1, 1]\ntop = [0.5, 0.7, 1]\n").scene.environment;
  CHECK(gradient.kind == Environment::Kind::gradient);
  CHECK(gradient.bottom == Rgb(1.0f));
  CHECK(gradient.top == Rgb(0.5f, 0.7f, 1.0f));
  Image sky(2, 1);
  sky.at(0, 0) = Rgb(4.0f, 2.0f, 1.0f);
  write_exr(folder / "sky.exr", sky);
  const Environment picture = folder.load("[background]\nimage = \"sky.exr\"\n").scene.environment;
  CHECK(picture.kind == Environment::Kind::image);
  REQUIRE(picture.picture.texels.size() == 2);
  CHECK(picture.picture.texels[0] == Rgb(4.0f, 2.0f, 1.0f));
  CHECK(picture.picture.mean == Rgb(2.0f, 1.0f, 0.5f));
}

TEST_CASE("a mesh is scaled, then turned, then moved, and its normals turn with it", "[unit]") {
  InputFolder folder;
  folder.write("mesh.obj", "v 1 0 0\nv 0 1 0\nv 0 0 2\nvn 1 0 0\nvn 0 1 0\nvn 0 0 1\nf 1//1 2//2 3//3\n");
  const Scene scene = folder
                          .load(kWhite + R"(
[[mesh]]
obj = "mesh.obj"
material = "white"
scale = 2
rotate_y = 90
translate = [10, 20, 30]
)")
                          .scene;
  const TriangleMesh& mesh = scene.geometry.meshes.at(0);
  // A quarter turn takes +z to +x and +x to -z, exactly.
  CHECK(mesh.positions.at(0) == vec3(10.0f, 20.0f, 28.0f));
  CHECK(mesh.positions.at(1) == vec3(10.0f, 22.0f, 30.0f));
  CHECK(mesh.positions.at(2) == vec3(14.0f, 20.0f, 30.0f));
  CHECK(mesh.normals.at(0) == vec3(0.0f, 0.0f, -1.0f));
  CHECK(mesh.normals.at(1) == vec3(0.0f, 1.0f, 0.0f));
  CHECK(mesh.normals.at(2) == vec3(1.0f, 0.0f, 0.0f));
}

TEST_CASE("a scene far away is near with its origin there, to the bit", "[unit]") {
  // Coordinates of which a float at 1e7 keeps nothing.
  const auto scene_at = [](const std::string& origin, int x, int y, int z) {
    const auto at = [&](double dx, double dy, double dz) {
      return format("[%.17g, %.17g, %.17g]", x + dx, y + dy, z + dz);
    };
    return origin + kWhite + "[camera]\nlook_from = " + at(0.25, 1.5, -0.125) + "\nlook_at = " + at(0.0, 0.0, 1.0) +
           "\n[[view]]\nname = \"aside\"\nlook_from = " + at(3.0, 0.0625, 0.0) +
           "\n[[sphere]]\ncenter = " + at(0.5, 0.25, 0.125) +
           "\nradius = 0.25\nmaterial = \"white\"\n[[mesh]]\nobj = \"mesh.obj\"\n" +
           "material = \"white\"\nrotate_y = 90\ntranslate = " + at(0.375, 0.0, 0.0) +
           "\n[[mesh]]\nobj = \"mesh.obj\"\nmaterial = \"white\"\ntransform = [{ translate = " + at(0.0, 0.5, 0.0) +
           " }]\n";
  };
  InputFolder folder;
  folder.write("mesh.obj", kTriangle);
  const LoadedScene near = folder.load(scene_at("", 0, 0, 0));
  const LoadedScene far =
      folder.load(scene_at("origin = [10000000, -20000000.0, 3e7]\n", 10000000, -20000000, 30000000));
  CHECK(far.camera.look_from == near.camera.look_from);
  CHECK(far.camera.look_at == near.camera.look_at);
  CHECK(far.views.at(0).camera.look_from == near.views.at(0).camera.look_from);
  CHECK(far.views.at(0).camera.look_at == near.views.at(0).camera.look_at);
  CHECK(far.scene.geometry.spheres.at(0).center == near.scene.geometry.spheres.at(0).center);
  REQUIRE(far.scene.geometry.meshes.size() == 2);
  for (std::size_t m = 0; m < 2; ++m) {
    CHECK(far.scene.geometry.meshes[m].positions == near.scene.geometry.meshes[m].positions);
  }
}

TEST_CASE("normals turn by the steps of a transform in their order", "[unit]") {
  InputFolder folder;
  folder.write("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 1 0\nf 1//1 2//1 3//1\n");
  const std::string mesh = "[[mesh]]\nobj = \"mesh.obj\"\nmaterial = \"white\"\n";
  const auto normal_after = [&](const std::string& steps) {
    return folder.load(kWhite + mesh + "transform = [" + steps + "]\n").scene.geometry.meshes.at(0).normals.at(0);
  };
  CHECK(normal_after("{ rotate_x = 90 }, { rotate_y = 90 }") == vec3(1, 0, 0));
  CHECK(normal_after("{ rotate_y = 90 }, { rotate_x = 90 }") == vec3(0, 0, 1));
}

TEST_CASE("a turn by any angle keeps lengths", "[unit]") {
  InputFolder folder;
  folder.write("mesh.obj", kTriangle + "vn 3 0 0\nf 1//1 2//1 3//1\n");
  const Scene scene =
      folder.load(kWhite + "[[mesh]]\nobj = \"mesh.obj\"\nmaterial = \"white\"\nrotate_y = -30\n").scene;
  const TriangleMesh& mesh = scene.geometry.meshes.at(0);
  CHECK(mesh.positions.at(1).x == Approx(0.8660254));
  CHECK(mesh.positions.at(1).z == Approx(0.5));
  CHECK(glm::length(mesh.normals.at(0)) == Approx(1.0));
}

TEST_CASE("a mesh with a material of the scene reads no MTL file", "[unit]") {
  InputFolder folder;
  folder.write("mesh.obj", "mtllib absent.mtl\nusemtl absent\n" + kTriangle);
  const LoadedScene loaded = folder.load(kWhite + "[[mesh]]\nobj = \"mesh.obj\"\nmaterial = \"white\"\n");
  CHECK(loaded.warnings.empty());
  REQUIRE(loaded.scene.materials.size() == 1);
  CHECK(loaded.scene.material_of(0, 0) == 0);
  CHECK(loaded.scene.mesh_names.at(0) == "mesh.obj");
}

TEST_CASE("two meshes share a material only when it comes from the same MTL file", "[unit]") {
  InputFolder folder;
  folder.write("a.mtl", "newmtl paint\nKd 1 0 0\nnewmtl unused\nKd 0 0 0\n");
  folder.write("b.mtl", "newmtl paint\nKd 0 1 0\n");
  folder.write("a1.obj", "mtllib a.mtl\nusemtl paint\n" + kTriangle);
  folder.write("a2.obj", "mtllib ./a.mtl\nusemtl paint\n" + kTriangle);
  folder.write("b.obj", "mtllib b.mtl\nusemtl paint\n" + kTriangle);
  const LoadedScene loaded =
      folder.load("mesh = [{obj = \"a1.obj\"}, {obj = \"a2.obj\"}, {obj = \"b.obj\", mtl = \"seed\"}]\n");
  const Scene& scene = loaded.scene;
  CHECK(scene.materials.size() == 2);
  CHECK(loaded.notes.size() == 2);
  CHECK(scene.material_of(0, 0) == scene.material_of(1, 0));
  CHECK(scene.material_of(2, 0) != scene.material_of(0, 0));
  CHECK(scene.materials.at(scene.material_of(2, 0)).color.a == Rgb(0.0f, 1.0f, 0.0f));
}

TEST_CASE("views have names of their own, and the camera's keys where they give none", "[unit]") {
  InputFolder folder;
  const LoadedScene loaded = folder.load(
      "[camera]\nlook_from = [1, 2, 3]\nvfov = 33\n[[view]]\nname = \"a\"\n"
      "[[view]]\nname = \"b\"\nlook_from = [4, 5, 6]\n");
  REQUIRE(loaded.views.size() == 2);
  CHECK(loaded.views[0].camera == loaded.camera);
  CHECK(loaded.views[1].name == "b");
  CHECK(loaded.views[1].camera.look_from == vec3(4, 5, 6));
  CHECK(loaded.views[1].camera.vfov == 33.0f);
}

TEST_CASE("with mtl = seed the plain convention counts, also where exporters say more", "[unit]") {
  InputFolder folder;
  folder.write("a.mtl", "newmtl gold\nKd 1 0.8 0.2\nPm 1\nPr 0.5\n");
  folder.write("a.obj", "mtllib a.mtl\nusemtl gold\n" + kTriangle);
  const LoadedScene loaded =
      folder.load("mesh = [{file = \"a.obj\"}, {file = \"a.obj\", mtl = \"seed\"}, {file = \"a.obj\"}]\n");
  const Scene& scene = loaded.scene;
  CHECK(scene.materials.size() == 2);
  CHECK(scene.materials[scene.material_of(0, 0)].kind == Material::Kind::metal);
  CHECK(scene.materials[scene.material_of(1, 0)].kind == Material::Kind::lambertian);
  CHECK(scene.material_of(2, 0) == scene.material_of(0, 0));
  CHECK(any_line(loaded.notes, folder.at("a.mtl:1"), {"lambertian", "left out: what only exporters write"}));
}

TEST_CASE("attributes no material reads are dropped unless they are to be kept", "[unit]") {
  InputFolder folder;
  folder.write("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n");
  const auto file = folder.write("scene.toml", kWhite + "[[mesh]]\nobj = \"mesh.obj\"\nmaterial = \"white\"\n");
  const LoadedScene kept = load_scene(file, {{}, /*keep_unneeded=*/true});
  CHECK(kept.scene.geometry.meshes.at(0).texcoords.size() == 1);
  CHECK(kept.dropped_bytes == 0);
  const LoadedScene dropped = load_scene(file);
  CHECK(dropped.scene.geometry.meshes.at(0).texcoords.empty());
  CHECK(dropped.dropped_bytes > 0);
}

TEST_CASE("the hash of a piece depends on its every byte, and is that of a file of these bytes", "[unit]") {
  const InputFolder folder;
  std::vector<std::uint64_t> hashes;
  for (const std::size_t size : {0, 1, 8, 31, 32, 33, 64, (32 << 12) - 1, 32 << 12, (32 << 12) + 1}) {
    std::string bytes(size, 'a');
    const auto hash = [&] {
      ContentHash made;
      made.add(bytes);
      hashes.push_back(made.value());
    };
    hash();
    ContentHash of_file;
    of_file.add_file(folder.write("bytes", bytes));
    CHECK(of_file.value() == hashes.back());
    for (std::size_t at = 0; at < size; at += 1 + size / 5) {
      bytes[at] = 'b';
      hash();
      bytes[at] = 'a';
    }
  }
  std::sort(hashes.begin(), hashes.end());
  CHECK(std::unique(hashes.begin(), hashes.end()) == hashes.end());
}

TEST_CASE("the hash changes with the scene file, the overrides and every file the scene names", "[unit]") {
  InputFolder folder;
  Image picture(1, 1);
  write_png(folder / "map.png", picture);
  folder.write("mesh.mtl", "newmtl paint\nmap_Kd map.png\n");
  folder.write("mesh.obj", "mtllib mesh.mtl\nusemtl paint\n" + kTriangle);
  const std::string toml = "[[mesh]]\nobj = \"mesh.obj\"\n";
  const auto hash = [&](const std::string& text, const std::vector<std::string>& overrides = {}) {
    return folder.load(text, overrides).hash;
  };
  std::vector<std::uint64_t> hashes = {hash(toml), hash(toml + "\n"), hash(toml, {"render.width=5"}),
                                       hash(toml, {"render.width=6"})};
  CHECK(hash(toml) == hashes[0]);
  folder.write("mesh.obj", "mtllib mesh.mtl\nusemtl paint\n" + kTriangle + "\n");
  hashes.push_back(hash(toml));
  folder.write("mesh.mtl", "newmtl paint\nmap_Kd map.png\n\n");
  hashes.push_back(hash(toml));
  picture.at(0, 0) = Rgb(1.0f);
  write_png(folder / "map.png", picture);
  hashes.push_back(hash(toml));
  std::sort(hashes.begin(), hashes.end());
  CHECK(std::unique(hashes.begin(), hashes.end()) == hashes.end());
}
