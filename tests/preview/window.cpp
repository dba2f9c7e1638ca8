// raylab-preview as its user meets it: in a window on a virtual display, driven by scripts.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <thread>
#include <utility>

#include "../catch.hpp"
#include "../run_program.hpp"
#include "../temp_folder.hpp"
#include "raylab/image/image_file.hpp"
#include "raylab/io/camera_file.hpp"
#include "raylab/io/scene_file.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

const std::string kPreview = RAYLAB_BINARY_DIR "/raylab-preview";
const std::string kCornell = RAYLAB_SOURCE_DIR "/scenes/cornell.toml";

constexpr const char* kBall = R"([camera]
look_from = [0, 0, 5]   # in front
look_at = [0, 0, 0]
vfov = 40
[render]
width = 200
height = 200
samples_per_pixel = 4
max_depth = 5
[background]
color = [0.1, 0.2, 0.7]
[material.red]
type = "lambertian"
albedo = [0.8, 0.1, 0.05]
[[sphere]]
center = [0, 0, 0]
radius = 1
material = "red"
)";

struct Display : TempFolder {
  std::string scene = (*this / "ball.toml").string();
  Display() { write_text(scene, kBall); }

  ProgramResult preview(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), kPreview);
    return run(std::move(arguments));
  }
  ProgramResult run(std::vector<std::string> command) const {
    // -nolisten and a screen with 24 bits are what GLFW needs; the software rasteriser is Mesa's choice there. With a
    // file of its own for authority, xvfb-run makes no folder, whose removal fails now and then where a program ends at
    // once.
    command.insert(command.begin(), {"-a", "-f", file("authority"), "-s", "-screen 0 1280x1024x24"});
    return run_program(RAYLAB_XVFB_RUN, command);
  }
  void run_script(const std::string& script, std::vector<std::string> arguments = {}) const {
    write_text(*this / "script", script);
    arguments.insert(arguments.end(), {scene, "--script", (*this / "script").string()});
    const ProgramResult result = preview(arguments);
    INFO(result.err);
    REQUIRE(result.exit_code == 0);
    CHECK(result.err.empty());
  }
  std::string file(const std::string& name) const { return (*this / name).string(); }
};

/// 8-bit colour of a pixel.
glm::ivec3 at(const Image8& image, int x, int y) {
  const std::uint8_t* p = &image.rgb[3 * (static_cast<std::size_t>(y) * image.width + x)];
  return {p[0], p[1], p[2]};
}

bool near_to(const glm::ivec3& a, const glm::ivec3& b, int margin = 3) {
  INFO(a.x << ' ' << a.y << ' ' << a.z << " against " << b.x << ' ' << b.y << ' ' << b.z);
  return std::abs(a.x - b.x) <= margin && std::abs(a.y - b.y) <= margin && std::abs(a.z - b.z) <= margin;
}

glm::ivec3 encoded(const Rgb& c) {
  return {std::lround(255 * linear_to_srgb(c.r)), std::lround(255 * linear_to_srgb(c.g)),
          std::lround(255 * linear_to_srgb(c.b))};
}

const glm::ivec3 kSky = encoded(Rgb(0.1f, 0.2f, 0.7f));
const glm::ivec3 kFacing = encoded(0.85f * Rgb(0.8f, 0.1f, 0.05f));  // lit by the lamp at the eye

}  // namespace

TEST_CASE("the raster view shows a sphere's colour at its pixels and the sky elsewhere", "[gui][preview]") {
  const Display display;
  const ProgramResult result = display.preview({display.scene, "--no-hud", "--screenshot", display.file("s.png")});
  INFO(result.err);
  REQUIRE(result.exit_code == 0);
  const Image8 shot = read_image8(display.file("s.png"));
  REQUIRE(shot.width == 200);
  REQUIRE(shot.height == 200);
  CHECK(near_to(at(shot, 100, 100), kFacing));
  CHECK(near_to(at(shot, 5, 5), kSky));
  // The outline: the sphere's radius is seen under asin(1/5).
  const double radius = 100.0 * std::tan(std::asin(0.2)) / std::tan(20.0 * kPi / 180.0);
  for (const double angle : {0.0, 1.0, 2.0, 3.0, 4.0, 5.0}) {
    const auto pixel = [&](double r) {
      return at(shot, static_cast<int>(100 + r * std::cos(angle)), static_cast<int>(100 + r * std::sin(angle)));
    };
    CHECK(near_to(pixel(radius + 2.0), kSky));
    CHECK_FALSE(near_to(pixel(radius - 2.0), kSky, 20));
  }
}

TEST_CASE("a newcomer flies through a model and saves the view in a scene file made for it", "[gui][preview]") {
  const Display display;
  const std::string model = display.file("mine.obj"), scene = display.file("mine.toml");
  write_text(model, "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv 0 1.5 0\nf 4 3 5\nf 3 2 5\nf 2 1 5\nf 1 4 5\n");
  write_text(display / "script", "key w 10\nkey enter\n");
  const ProgramResult result = display.preview({model, "--script", (display / "script").string()});
  INFO(result.err);
  REQUIRE(result.exit_code == 0);
  const LoadedScene made = load_scene(model), saved = load_scene(scene);
  CHECK(saved.scene.geometry.triangle_count() == 4);
  CHECK(saved.camera.look_from != made.camera.look_from);
  CHECK(saved.camera.vfov == made.camera.vfov);
  // Another window on the model leaves the file alone that is there now.
  const std::string text = read_text(scene);
  REQUIRE(display.preview({model, "--script", (display / "script").string()}).exit_code == 0);
  CHECK(read_text(scene) == text);
}

TEST_CASE("a triangle covers the pixels that its rays hit, in front of a sphere behind it", "[gui][preview]") {
  const Display display;
  write_text(display / "t.obj", "v 0 -1 1.5\nv 1 -1 1.5\nv 0 1 1.5\nf 1 2 3\n");
  write_text(display.scene, std::string(kBall) +
                                "[material.green]\ntype = \"lambertian\"\nalbedo = [0.1, 0.7, 0.1]\n"
                                "[[mesh]]\nobj = \"t.obj\"\nmaterial = \"green\"\n");
  REQUIRE(display.preview({display.scene, "--no-hud", "--screenshot", display.file("s.png")}).exit_code == 0);
  const Image8 shot = read_image8(display.file("s.png"));
  const double scale = 100.0 / (3.5 * std::tan(20.0 * kPi / 180.0));  // pixels a unit, where the triangle is
  const auto pixel = [&](double x, double y) {
    return at(shot, static_cast<int>(100 + scale * x), static_cast<int>(100 - scale * y));
  };
  const auto is_green = [](const glm::ivec3& c) { return c.y > 150 && c.x < 120 && c.z < 120; };
  CHECK(is_green(pixel(0.3, 0.0)));
  CHECK(is_green(pixel(0.03, 0.85)));
  CHECK(is_green(pixel(0.9, -0.95)));
  CHECK(near_to(pixel(-0.05, 0.0), kFacing, 12));
  CHECK_FALSE(is_green(pixel(0.6, 0.0)));
}

TEST_CASE("the head-up display shows text, and nothing without it", "[gui][preview]") {
  const Display display;
  REQUIRE(display.preview({display.scene, "--screenshot", display.file("hud.png")}).exit_code == 0);
  REQUIRE(display.preview({display.scene, "--no-hud", "--screenshot", display.file("bare.png")}).exit_code == 0);
  const Image8 hud = read_image8(display.file("hud.png")), bare = read_image8(display.file("bare.png"));
  const auto bright_pixels = [](const Image8& image) {
    int count = 0;
    for (int y = 8; y < 60; ++y) {
      for (int x = 8; x < 180; ++x) count += near_to(at(image, x, y), {255, 255, 255}, 30);
    }
    return count;
  };
  CHECK(bright_pixels(hud) > 300);
  CHECK(bright_pixels(hud) < 4000);
  CHECK(bright_pixels(bare) == 0);
}

TEST_CASE("text is as large as --scale says, and U hides it", "[gui][preview]") {
  const Display display;
  const auto text_rows = [&](const std::string& scale) {  // pixels down to the last bright one of the panel
    display.run_script("wait 3\nscreenshot " + display.file("hud.png"),
                       {"--width", "600", "--height", "600", "--scale", scale});
    const Image8 shot = read_image8(display.file("hud.png"));
    int rows = 0;
    for (int y = 0; y < shot.height; ++y) {
      for (int x = 8; x < 80; ++x) {
        if (near_to(at(shot, x, y), {255, 255, 255}, 30)) rows = y;
      }
    }
    return rows;
  };
  const int small = text_rows("1"), large = text_rows("2");
  CHECK(small > 60);
  CHECK(std::abs(large - 2 * small) < 0.15 * large);
  display.run_script("wait 2\nkey u\nscreenshot " + display.file("hidden.png"));
  CHECK(near_to(at(read_image8(display.file("hidden.png")), 12, 12), kSky));
  CHECK(display.preview({display.scene, "--scale", "0"}).exit_code == 2);
}

TEST_CASE("the focus plane is translucent, lies where the focus is and ends at its edge", "[gui][preview]") {
  const Display display;
  display.run_script("screenshot " + display.file("without.png") + "\nclick 100 100\nkey f\nscreenshot " +
                         display.file("with.png") + "\nkey up 1\nwait 1\nscreenshot " + display.file("behind.png"),
                     {"--no-hud"});
  const Image8 without = read_image8(display.file("without.png"));
  const Image8 with = read_image8(display.file("with.png"));
  const Image8 behind = read_image8(display.file("behind.png"));
  CHECK(near_to(at(without, 12, 107), kSky));
  CHECK_FALSE(near_to(at(with, 14, 107), kSky, 10));  // the plane covers nine tenths of the picture
  CHECK(near_to(at(with, 5, 107), kSky));
  // In focus is what was clicked on: the plane touches the sphere there, and the rest of the sphere lies behind
  // it.
  CHECK_FALSE(near_to(at(with, 107, 117), at(without, 107, 117), 10));
  CHECK(at(with, 107, 117).x > at(with, 14, 107).x + 40);  // seen through it
  // Focused a hundredth farther away, the sphere's front stands before the plane.
  CHECK(near_to(at(behind, 100, 100), at(without, 100, 100)));
  CHECK_FALSE(near_to(at(behind, 14, 107), kSky, 10));
}

TEST_CASE("over the traced picture the focus plane tints what lies behind it, and nothing else", "[gui][preview]") {
  const Display display;
  const auto shot = [&](const char* name) { return "wait still\nscreenshot " + display.file(name) + "\n"; };
  // Focus on the sphere's front, 4 away, then go a little into the sphere.
  display.run_script("key v\nclick 100 100\nkey up 6\n" + shot("without.png") + "key f\n" + shot("with.png") +
                         "key f\n" + shot("again.png") + "key enter\nkey f\nkey up 60\n" + shot("behind.png"),
                     {"--no-hud"});
  const Image8 without = read_image8(display.file("without.png")), with = read_image8(display.file("with.png"));
  const double distance = load_scene(display.scene).camera.focus_distance;
  REQUIRE(distance > 4.1);
  REQUIRE(distance < 4.5);
  // The plane cuts the sphere, around (0, 0, 0), in a circle; its blue covers 32 %.
  const double scale = 100.0 / (distance * std::tan(20.0 * kPi / 180.0));  // pixels a unit, in the plane
  const double circle = scale * std::sqrt(1.0 - (5.0 - distance) * (5.0 - distance));
  const auto tinted = [](const glm::ivec3& c) {
    return glm::ivec3(0.68 * glm::dvec3(c) + 0.32 * glm::dvec3(64, 140, 255));
  };
  for (const double angle : {0.6, 1.0, 2.2, 3.7, 5.4}) {  // off the grid's lines
    const auto pixel = [&](const Image8& image, double r) {
      return at(image, static_cast<int>(100 + r * std::cos(angle)), static_cast<int>(100 + r * std::sin(angle)));
    };
    INFO("circle of " << circle << " pixels, at angle " << angle);
    CHECK(pixel(with, circle - 2.0) == pixel(without, circle - 2.0));
    CHECK(near_to(pixel(with, circle + 2.0), tinted(pixel(without, circle + 2.0)), 2));
    CHECK(near_to(pixel(with, 70.0), tinted(kSky), 2));
  }
  CHECK(near_to(at(with, 10, 107), {255, 217, 51}, 30));  // its edge
  CHECK(at(with, 5, 107) == at(without, 5, 107));
  CHECK((read_image8(display.file("again.png")).rgb == without.rgb));
  // The plane goes with the focus: behind all of the sphere it tints the sky alone.
  const Image8 behind = read_image8(display.file("behind.png"));
  CHECK(near_to(at(behind, 140, 130), at(without, 140, 130), 10));
  CHECK(near_to(at(behind, 14, 107), tinted(kSky), 2));
}

TEST_CASE("M captures the mouse: it then looks around as with a button held, until M again", "[gui][preview]") {
  const Display display;
  const auto shot = [&](const char* name) { return "screenshot " + display.file(name) + "\n"; };
  // The mode changes as the next frame begins.
  display.run_script("mouse 30 0\n" + shot("free.png") + "key m\nwait 2\nmouse 30 0\n" + shot("captured.png") +
                         "key m\nwait 2\nmouse 30 0\n" + shot("left.png") + "key backspace\nwait 2\ndrag 30 0\n" +
                         shot("drag.png"),
                     {"--no-hud"});
  const auto pixels = [&](const char* name) { return read_image8(display.file(name)).rgb; };
  CHECK(near_to(at(read_image8(display.file("free.png")), 100, 100), kFacing));
  CHECK((pixels("captured.png") != pixels("free.png")));
  CHECK((pixels("captured.png") == pixels("drag.png")));
  CHECK((pixels("left.png") == pixels("captured.png")));
}

TEST_CASE("the still picture is that of raylab-render, bit for bit, also after a flight", "[gui][preview]") {
  const Display display;
  display.run_script("key v\nwait still\npicture " + display.file("a.exr") + "\nscreenshot " + display.file("a.png") +
                         "\nkey d 30\ndrag 20 10\nkey ] 30\nkey enter\nwait still\npicture " + display.file("b.exr"),
                     {"--no-hud", "--width", "150", "--height", "100"});
  const auto render = [&](const std::string& scene, const std::string& picture) {
    const ProgramResult result = run_program(RAYLAB_BINARY_DIR "/raylab-render",
                                             {scene, "--width", "150", "--height", "100", "-q", "-o", picture});
    INFO(result.err);
    REQUIRE(result.exit_code == 0);
  };
  const std::string moved = read_text(display.scene);
  CHECK(moved != kBall);
  CHECK(moved.substr(moved.find("[render]")) == std::string(kBall).substr(std::string(kBall).find("[render]")));
  CHECK(moved.find("# in front") != std::string::npos);
  render(display.scene, display.file("b-ref.exr"));
  CHECK((read_exr(display.file("b.exr")).pixels == read_exr(display.file("b-ref.exr")).pixels));
  write_text(display.scene, kBall);
  render(display.scene, display.file("a-ref.exr"));
  render(display.scene, display.file("a-ref.png"));
  CHECK((read_exr(display.file("a.exr")).pixels == read_exr(display.file("a-ref.exr")).pixels));
  CHECK(
      (read_image8(display.file("a.png")).rgb == read_image8(display.file("a-ref.png")).rgb));  // what the window shows
  CHECK((read_exr(display.file("a.exr")).pixels != read_exr(display.file("b.exr")).pixels));
}

TEST_CASE("exposure changes what the window shows of the traced picture, and nothing that is saved", "[gui][preview]") {
  const Display display;
  display.run_script("key v\nwait still\npicture " + display.file("a.exr") + "\nkey =\nkey =\nwait still\nscreenshot " +
                         display.file("bright.png") + "\npicture " + display.file("b.exr") +
                         "\nkey v\nwait still\nscreenshot " + display.file("raster.png"),
                     {"--no-hud"});
  CHECK(near_to(at(read_image8(display.file("bright.png")), 5, 5), encoded(Rgb(0.2f, 0.4f, 1.0f))));
  CHECK(near_to(at(read_image8(display.file("raster.png")), 5, 5), kSky));
  CHECK((read_exr(display.file("a.exr")).pixels == read_exr(display.file("b.exr")).pixels));
}

TEST_CASE("two accelerators side by side, their difference and their disagreement", "[gui][preview]") {
  const Display display;
  display.run_script("key v\nkey 4\nkey c\nwait still\nscreenshot " + display.file("split.png") +
                         "\nkey c\nwait still\nscreenshot " + display.file("difference.png") +
                         "\nkey c\nwait still\nscreenshot " + display.file("disagreement.png"),
                     {"--no-hud"});
  const Image8 split = read_image8(display.file("split.png"));
  CHECK(near_to(at(split, 100, 50), {255, 217, 51}, 3));  // the line between them
  CHECK(near_to(at(split, 20, 100), kSky));
  CHECK(near_to(at(split, 180, 100), kSky));
  // Of a lone sphere all accelerators say the same: black, and the disagreement's dark grey.
  CHECK(near_to(at(read_image8(display.file("difference.png")), 100, 100), {0, 0, 0}));
  CHECK(near_to(at(read_image8(display.file("disagreement.png")), 5, 5), encoded(Rgb(0.02f))));
}

TEST_CASE("F5 reads the scene and its files again, and where that fails the old scene stays", "[gui][preview]") {
  const Display display;
  const std::string texture = display.file("map.png");
  Image red(2, 2);
  red.pixels.assign(4, Rgb(0.8f, 0.1f, 0.05f));
  write_image(texture, red);
  std::string scene = kBall;
  scene.replace(scene.find("[0, 0, 5]"), 9, "[0, 0, 10]");
  scene.replace(scene.find("[0.8, 0.1, 0.05]"), 16, "{ image = \"map.png\" }");
  write_text(display.scene, scene);
  // The picture becomes the texture: where the sphere faces the camera it then has the sky's colour.
  const std::string view = GENERATE("", "key v\n");
  display.run_script(view + "wait still\nscreenshot " + display.file("before.png") + "\npicture " + texture +
                         "\nkey f5\nwait still\nscreenshot " + display.file("after.png"),
                     {"--no-hud"});
  const glm::ivec3 before = at(read_image8(display.file("before.png")), 100, 100);
  const glm::ivec3 after = at(read_image8(display.file("after.png")), 100, 100);
  CHECK(before.x > before.z + 20);
  CHECK(after.z > after.x + 50);
  if (view.empty()) CHECK(near_to(after, encoded(0.85f * Rgb(0.1f, 0.2f, 0.7f)), 6));

  std::thread vandal([&] {
    while (!std::filesystem::exists(display.file("whole.png"))) std::this_thread::yield();
    write_text(display.scene, "[camera");
  });
  display.run_script(view + "wait still\nscreenshot " + display.file("whole.png") +
                         "\nwait 1000\nkey f5\nwait still\nscreenshot " + display.file("broken.png"),
                     {"--no-hud"});
  vandal.join();
  CHECK((read_image8(display.file("whole.png")).rgb == read_image8(display.file("broken.png")).rgb));
}

TEST_CASE("resizing, minimising and closing while tracing, ten times each", "[gui][preview]") {
  const Display display;
  std::string script = "key v\n";
  for (int i = 0; i < 10; ++i) {
    script += "resize " + std::to_string(100 + 37 * i) + " " + std::to_string(400 - 31 * i) + "\nwait 3\n";
    script += "minimise\nwait 2\nrestore\nwait 3\n";
  }
  display.run_script(script + "resize 160 120\nwait 5\nwait still\nscreenshot " + display.file("s.png"),
                     {"--no-hud", "--spp", "16"});
  const Image8 shot = read_image8(display.file("s.png"));
  CHECK(shot.width == 160);
  CHECK(shot.height == 120);
  CHECK(near_to(at(shot, 3, 3), kSky));
  for (int i = 1; i <= 10; ++i) {
    display.run_script("key v\nwait " + std::to_string(i) + "\nclose\nwait 1000000", {"--spp", "1000000"});
  }
}

TEST_CASE("a window in which nothing happens costs less than a hundredth of a core", "[gui][preview]") {
  const Display display;
  const std::string view = GENERATE("raster", "traced");
  // Ticks of 10 ms that the program has run for, before and after five seconds; fields 14 and 15 of stat.
  const std::string script = "\"$0\" \"$1\" --view " + view +
                             " & pid=$!; sleep 4; cut -d' ' -f14,15 /proc/$pid/stat; sleep 5; "
                             "cut -d' ' -f14,15 /proc/$pid/stat; kill $pid";
  const ProgramResult result = display.run({"sh", "-c", script, kPreview, display.scene});
  std::istringstream ticks(result.out);
  int user = 0, system = 0, user_after = 0, system_after = 0;
  ticks >> user >> system >> user_after >> system_after;
  INFO(result.out << result.err);
  REQUIRE(user + system > 0);
  CHECK(user_after + system_after - user - system < 5);
}

TEST_CASE("without a display it says so in one line and fails", "[gui][preview]") {
  const Display display;
  const ProgramResult result =
      run_program("/usr/bin/env", {"-u", "DISPLAY", "-u", "WAYLAND_DISPLAY", kPreview, kCornell});
  CHECK(result.exit_code == 1);
  CHECK(result.out.empty());
  CHECK(result.err.find("there is no display") != std::string::npos);
  CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
}

TEST_CASE("what is wrong with the command line, the scene or the script is said", "[gui][preview]") {
  const Display display;
  CHECK(display.preview({}).exit_code == 2);
  CHECK(display.preview({display.scene, "--accel", "none"}).exit_code == 2);
  CHECK(display.preview({display.file("no.toml")}).exit_code == 3);
  write_text(display / "script", "wait 1\njump\n");
  const ProgramResult result = display.preview({display.scene, "--script", display.file("script")});
  CHECK(result.exit_code == 3);
  CHECK(result.err.find("script:2: found \"jump\"") != std::string::npos);
  CHECK(display.preview({display.scene, "--frames", "2", "--screenshot", "/nowhere/a.png"}).exit_code == 4);
}
