// `--set key=value` acts as if the file said so.
#include "catch.hpp"
#include "expect_error.hpp"
#include "io_files.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

const std::string kScene = R"([camera]
vfov = 40
[material.white]
type = "lambertian"
albedo = [0.5, 0.5, 0.5]
[material."other name"]
type = "metal"
[[sphere]]
center = [0, 0, 0]
radius = 1
material = "white"
[[sphere]]
center = [3, 0, 0]
radius = 2
material = "other name"
)";

}  // namespace

TEST_CASE("an override replaces a value, adds a key or adds a table", "[unit]") {
  InputFolder folder;
  const LoadedScene loaded = folder.load(
      kScene, {"camera.vfov=30", "camera.look_at = [1, 0, 0]", "render.width=17", "background.color=[1, 1, 1]"});
  const Scene& scene = loaded.scene;
  CHECK(loaded.camera.vfov == 30.0f);
  CHECK(loaded.camera.look_at == vec3(1.0f, 0.0f, 0.0f));
  CHECK(scene.render.width == 17);
  CHECK(scene.environment.bottom == Rgb(1.0f));
}

TEST_CASE("an override reaches into arrays of tables, arrays and quoted names", "[unit]") {
  InputFolder folder;
  const Scene scene =
      folder.load(kScene, {"sphere.1.radius=0.25", "sphere.0.center.2=-4", "material.\"other name\".fuzz=0.5"}).scene;
  CHECK(scene.geometry.spheres.at(0).radius == 1.0f);
  CHECK(scene.geometry.spheres.at(1).radius == 0.25f);
  CHECK(scene.geometry.spheres.at(0).center == vec3(0.0f, 0.0f, -4.0f));
  CHECK(scene.materials.at(scene.sphere_materials[1]).fuzz == 0.5f);
}

TEST_CASE("of two overrides of one key the later wins", "[unit]") {
  InputFolder folder;
  CHECK(folder.load(kScene, {"camera.vfov=30", "camera.vfov=20"}).camera.vfov == 20.0f);
}

TEST_CASE("a bare word is taken as a string", "[unit]") {
  InputFolder folder;
  const Scene scene = folder.load(kScene, {"material.white.type=metal"}).scene;
  CHECK(scene.materials.at(scene.sphere_materials[0]).kind == Material::Kind::metal);
  const Scene same = folder.load(kScene, {"material.white.type=\"metal\""}).scene;
  CHECK(same.materials.at(same.sphere_materials[0]).kind == Material::Kind::metal);
}

TEST_CASE("an override may replace a colour by a table", "[unit]") {
  InputFolder folder;
  const Scene scene =
      folder.load(kScene, {"material.white.albedo={checker = 2, even = [1, 1, 1], odd = [0, 0, 0]}"}).scene;
  CHECK(scene.materials.at(scene.sphere_materials[0]).color.kind == Texture::Kind::checker);
}

TEST_CASE("a bad override is a usage error placed at the option", "[unit]") {
  InputFolder folder;
  struct Case {
    std::string text;
    std::string location;
    std::vector<const char*> parts;
  };
  const std::vector<Case> cases = {
      {"camera.vfvo=3", "--set camera.vfvo", {"unknown key \"vfvo\"", "\"vfov\""}},
      {"camrea.vfov=3", "--set camrea.vfov", {"unknown key \"camrea\"", "\"camera\""}},
      {"camera.vfov=200", "--set camera.vfov", {"found 200", "(0, 180)"}},
      {"camera.vfov=wide", "--set camera.vfov", {"found \"wide\"", "number"}},
      {"camera.vfov=[1, 2", "--set camera.vfov", {"found \"[1, 2\"", "TOML"}},
      {"camera.vfov=", "--set camera.vfov", {"no value"}},
      {"camera.vfov=3\nwidth = 4", "--set camera.vfov", {"expected"}},
      {"camera.vfov.x=3", "--set camera.vfov.x", {"camera.vfov is 40", "\"x\""}},
      {"camera..vfov=3", "--set camera..vfov", {"path of keys"}},
      {"material.\"white.type=metal", "--set material.\"white.type", {"path of keys"}},
      {"camera.vfov", "--set camera.vfov", {"KEY=VALUE"}},
      {"=3", "--set =3", {"KEY=VALUE"}},
      {"sphere.2.radius=3", "--set sphere.2.radius", {"found \"2\"", "from 0 to 1"}},
      {"sphere.x.radius=3", "--set sphere.x.radius", {"found \"x\"", "from 0 to 1"}},
      {"sphere.-1.radius=3", "--set sphere.-1.radius", {"found \"-1\""}},
      {"sphere.0.radius=-3", "--set sphere.0.radius", {"sphere.0.radius", "found -3", "above 0"}},
      {"sphere.0.material=whit", "--set sphere.0.material", {"\"whit\"", "\"white\""}},
      {"material.whit.albedo=[0, 0, 0]", "--set material.whit.albedo", {"\"whit\"", "\"white\""}},
      {"material.white.albedo=[0, 0, 7]", "--set material.white.albedo", {"found 7", "[0, 1]"}},
      {"camera.look_at=[0, 0, 0]", "--set camera.look_at", {"same point"}},
      {"render.width=0", "--set render.width", {"found 0", "at least 1"}},
  };
  for (const Case& bad : cases) {
    INFO(bad.text);
    for (const char* part : bad.parts) {
      expect_error(ErrorKind::usage, bad.location, {part}, [&] { folder.load(kScene, {bad.text}); });
    }
  }
}

TEST_CASE("an override does not turn the errors of the file into usage errors", "[unit]") {
  InputFolder folder;
  expect_error(ErrorKind::input, folder.at("scene.toml:2:8"), {"found 400"},
               [&] { folder.load("[camera]\nvfov = 400\n", {"render.width=5"}); });
}
