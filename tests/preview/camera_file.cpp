// Writing a camera back changes the camera's numbers and nothing else.
#include "raylab/io/camera_file.hpp"

#include <bit>
#include <cstdint>
#include <filesystem>
#include <random>

#include "../catch.hpp"
#include "../expect_error.hpp"
#include "../temp_folder.hpp"
#include "raylab/io/scene_file.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

CameraSettings some_camera() {
  CameraSettings c;
  c.look_from = vec3(1.25f, -2.5f, 1e-7f);
  c.look_at = vec3(0.1f, 3.0f, -4.0f);
  c.up = vec3(0.0f, 0.0f, 1.0f);
  c.vfov = 33.3f;
  c.defocus_angle = 0.7f;
  c.focus_distance = 12.5f;
  return c;
}

bool same(const CameraSettings& a, const CameraSettings& b) {
  return a.look_from == b.look_from && a.look_at == b.look_at && a.up == b.up && a.vfov == b.vfov &&
         a.defocus_angle == b.defocus_angle && a.focus_distance == b.focus_distance;
}

CameraSettings camera_of(const std::string& text) {
  TempFolder folder;
  write_text(folder / "scene.toml", text);
  return load_scene(folder / "scene.toml").camera;
}

constexpr const char* kOdd =
    "# before\r\n"
    "[ camera ]  # Kamera für später\r\n"
    "  up=[0,0 , 1]# kept\r\n"
    "look_from = [ 1.0 , # ä, x ]\r\n\t2e0,\r\n +3.000 ]   \r\n"
    "  \"vfov\" = 40 # 40 degrees\r\n"
    "look_at=[1,7,0]\r\n\r\n"
    "[render]   # 1.0 40\r\nwidth = 40";

}  // namespace

TEST_CASE("a camera written back changes the numbers that differ and no other byte", "[unit][preview]") {
  CameraSettings camera = camera_of(kOdd);
  CHECK(with_camera(kOdd, "odd.toml", camera) == kOdd);
  camera.look_from.y = 2.5f;
  camera.look_from.z = -1e-12f;
  camera.vfov = 41.5f;
  std::string expected = kOdd;
  expected.replace(expected.find("2e0"), 3, "2.5");
  expected.replace(expected.find("+3.000"), 6, "-1e-12");
  expected.replace(expected.find("40 # 40"), 2, "41.5");
  CHECK(with_camera(kOdd, "odd.toml", camera) == expected);
}

TEST_CASE("keys that the file lacks follow the camera's last", "[unit][preview]") {
  CameraSettings camera = camera_of(kOdd);
  camera.focus_distance = 7.0f;
  std::string expected = kOdd;
  expected.insert(expected.find("look_at=[1,7,0]") + 15, "\r\nfocus_distance = 7");
  CHECK(with_camera(kOdd, "odd.toml", camera) == expected);
}

TEST_CASE("cameras written as inline tables, dotted keys, empty or not at all are changed too", "[unit][preview]") {
  const std::string text =
      GENERATE(as<std::string>{},
               "\xef\xbb\xbf"
               "camera = { vfov = 30 } # c\n",
               "camera = { vfov = 30, look_at = [0,1,2] } # c\n", "camera = {}\n[render]\nwidth = 3\n",
               "camera.vfov = 30 # deg\ncamera.look_at = [0, 1, 2]\n[render]\nwidth = 3\n", "[camera]",
               "[camera] # none\n\n[render]\nwidth = 3\n", "", "[render]\nwidth = 3",
               "[camera]\nlook_at = [ # ]\n 1,\n 2, # a ] here\n 3 ]\n[render]\nheight = 2\n");
  INFO(text);
  const std::string changed = with_camera(text, "t.toml", some_camera());
  CHECK(same(camera_of(changed), some_camera()));
  // Taking the camera's numbers away leaves what was there before: nothing else was lost.
  for (const char* kept : {"# c", "[render]\nwidth = 3", "# deg", "# none", "# a ] here"}) {
    if (text.find(kept) != std::string::npos) CHECK(changed.find(kept) != std::string::npos);
  }
}

TEST_CASE("every float is read back as the same float", "[unit][preview]") {
  std::mt19937 random(7);
  for (int i = 0; i < 2000; ++i) {
    CameraSettings camera = some_camera();
    for (int k = 0; k < 3; ++k) {
      const float x = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
      if (std::abs(x) > 1e-30f && std::abs(x) < 1e5f) camera.look_from[k] = x;  // farther away the view is along up
    }
    const std::string changed = with_camera(kOdd, "odd.toml", camera);  // checks what it wrote by reading it
    REQUIRE_FALSE(changed.empty());
  }
}

TEST_CASE("the cameras of the scenes change in place", "[unit][preview]") {
  for (const auto& entry : std::filesystem::directory_iterator(RAYLAB_SOURCE_DIR "/scenes")) {
    if (entry.path().extension() != ".toml") continue;
    INFO(entry.path());
    const std::string text = read_text(entry.path());
    const std::string changed = with_camera(text, entry.path(), some_camera());
    const std::size_t rest = text.find("[render]");
    REQUIRE(rest != std::string::npos);
    CHECK(changed.substr(0, text.find("[camera]")) == text.substr(0, text.find("[camera]")));
    CHECK(changed.substr(changed.find("[render]")) == text.substr(rest));
  }
}

TEST_CASE("a scene file changed meanwhile is left alone until asked again", "[unit][preview]") {
  TempFolder folder;
  const auto file = folder / "scene.toml";
  write_text(file, kOdd);
  CameraFile camera_file(file);
  CHECK_FALSE(camera_file.write(camera_of(kOdd)));  // nothing to change
  const std::string edited = std::string(kOdd) + "\n# edited elsewhere\n";
  write_text(file, edited);
  CameraSettings camera = camera_of(kOdd);
  camera.vfov = 50.0f;
  expect_error(ErrorKind::output, file.string(), {"changed since"}, [&] { camera_file.write(camera); });
  CHECK(read_text(file) == edited);
  CHECK(camera_file.write(camera));
  CHECK(read_text(file) == with_camera(edited, "", camera));
  CHECK(folder.entries() == 1);
}

TEST_CASE("a camera is written where it stands in the world, though the scene's origin is there", "[unit][preview]") {
  const std::string text =
      "origin = [10000000, 0, -3e7]\n[camera]\nlook_from = [10000000.125, 0, -3e7]\nlook_at = "
      "[10000001, 0, -3e7]\n";
  CameraSettings camera = camera_of(text);
  REQUIRE(camera.look_from == vec3(0.125f, 0.0f, 0.0f));
  CHECK(with_camera(text, "far.toml", camera) == text);
  camera.look_from = vec3(0.0625f, 0.1f, -0.3f);
  const std::string changed = with_camera(text, "far.toml", camera);
  CHECK(changed.find("look_from = [10000000.0625, 0.1, -30000000.3") != std::string::npos);
  CHECK(camera_of(changed).look_from == camera.look_from);
  std::string name;
  const std::string with_one = with_view(text, "far.toml", camera, name);
  TempFolder folder;
  write_text(folder / "scene.toml", with_one);
  CHECK(load_scene(folder / "scene.toml").views.at(0).camera.look_from == camera.look_from);
}

TEST_CASE("a scene file that is to be new is not written over one that is there", "[unit][preview]") {
  TempFolder folder;
  write_text(folder / "scene.toml", "somebody's work");
  CameraFile file(folder / "scene.toml", "[camera]\nlook_at = [0, 0, 1]\n");
  expect_error(ErrorKind::output, (folder / "scene.toml").string(), {"is there already"},
               [&] { file.write(some_camera()); });
  CHECK(read_text(folder / "scene.toml") == "somebody's work");
}
