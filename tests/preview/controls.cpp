// Keys and mouse and what they do, without a window.
#include <thread>

#include "../catch.hpp"
#include "../temp_folder.hpp"
#include "explorer.hpp"
#include "first_surfaces.hpp"
#include "mouse.hpp"
#include "raylab/io/scene_file.hpp"
#include "watched_files.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

constexpr const char* kBall = R"([camera]
look_from = [0, 0, 5]  # the eye
look_at = [0, 0, 0]
vfov = 40
[material.red]
type = "lambertian"
albedo = [0.8, 0.1, 0.1]
[[sphere]]
center = [0, 0, 0]
radius = 1
material = "red"
)";

struct Ball : TempFolder {
  LoadedScene loaded;
  AcceleratorShelf shelf{loaded.scene.geometry};
  std::optional<CameraFile> file;
  std::optional<Explorer> explorer;

  Ball() {
    write_text(*this / "ball.toml", kBall);
    loaded = load_scene(*this / "ball.toml");
    file.emplace(*this / "ball.toml");
    shelf.get("bvh");
    explorer.emplace(loaded.scene, loaded.camera, *file, shelf, std::vector<std::string>{"list", "bvh", "embree"},
                     "bvh");
    explorer->resize(100, 100);
  }
  void press(Key key, double seconds = 0.0) {
    explorer->key_down(key);
    explorer->step(seconds);
    explorer->key_up(key);
  }
};

}  // namespace

TEST_CASE("every key has a name that reads back as the key", "[unit][preview]") {
  for (int i = 0; i < kKeyCount; ++i) CHECK(parse_key(key_name(static_cast<Key>(i))) == static_cast<Key>(i));
  CHECK(parse_key("Space") == Key::space);
  CHECK_FALSE(parse_key("hyper"));
}

TEST_CASE("the help calls keys as the keyboard does", "[unit][preview]") {
  const auto french = [](Key key) { return key == Key::w ? std::string("Z") : plain_key_name(key); };
  CHECK(with_key_names("{w} {a} / {space}", french) == "Z A / Space");
  CHECK(with_key_names("{[} / {]}, {escape}", plain_key_name) == "[ / ], Escape");
  for (const KeyHelp& line : key_help()) {
    CHECK(with_key_names(line.keys, plain_key_name).find_first_of("{}") == std::string::npos);
    CHECK(with_key_names(line.what, plain_key_name).find_first_of("{}") == std::string::npos);
  }
}

TEST_CASE("N adds a view to the scene file, and the page keys go from view to view", "[unit][preview]") {
  Ball ball;
  ball.press(Key::page_down);
  CHECK(ball.explorer->message() == "the scene has no views yet");
  const CameraSettings first = ball.explorer->camera();
  ball.press(Key::n);
  ball.press(Key::w, 0.5);
  const CameraSettings second = ball.explorer->camera();
  REQUIRE(first.look_from != second.look_from);
  ball.press(Key::n);
  ball.press(Key::d, 0.5);
  ball.press(Key::page_down);
  CHECK(ball.explorer->camera() == first);
  ball.press(Key::page_down);
  CHECK(ball.explorer->camera() == second);
  ball.press(Key::page_up);
  CHECK(ball.explorer->camera() == first);
  ball.press(Key::page_up);
  CHECK(ball.explorer->camera() == second);
  const LoadedScene saved = load_scene(ball / "ball.toml");
  REQUIRE(saved.views.size() == 2);
  CHECK(saved.views[0].name == "view-1");
  CHECK(saved.views[1].name == "view-2");
  CHECK(saved.views[0].camera == first);
  CHECK(saved.views[1].camera == second);
  CHECK(saved.camera == first);
  CHECK(read_text(ball / "ball.toml").starts_with(kBall));
}

TEST_CASE("U hides all text, and help brings it back", "[unit][preview]") {
  Ball ball;
  CHECK(ball.explorer->shows_hud());
  ball.press(Key::u);
  CHECK_FALSE(ball.explorer->shows_hud());
  ball.press(Key::h);
  CHECK(ball.explorer->shows_hud());
  CHECK(ball.explorer->shows_help());
}

TEST_CASE("the keys move the camera the way they say", "[unit][preview]") {
  struct Way {
    Key key;
    dvec3 way;
  };
  const Way w =
      GENERATE(Way{Key::w, {0, 0, -1}}, Way{Key::s, {0, 0, 1}}, Way{Key::a, {-1, 0, 0}}, Way{Key::d, {1, 0, 0}},
               Way{Key::space, {0, 1, 0}}, Way{Key::r, {0, 1, 0}}, Way{Key::e, {0, -1, 0}}, Way{Key::q, {0, -1, 0}});
  Ball ball;
  ball.press(w.key, 0.5);
  CHECK(ball.explorer->moved());
  const dvec3 step = dvec3(ball.explorer->camera().look_from) - dvec3(0, 0, 5);
  CHECK(glm::length(step - w.way * (0.5 * ball.explorer->speed())) < 1e-5);
  ball.explorer->step(0.5);
  CHECK_FALSE(ball.explorer->moved());
}

TEST_CASE("shift is fast, control slow, the wheel changes the speed, backspace goes back", "[unit][preview]") {
  Ball ball;
  const auto length_of_step = [&] {
    const dvec3 before(ball.explorer->camera().look_from);
    ball.press(Key::d, 0.1);
    return glm::length(dvec3(ball.explorer->camera().look_from) - before);
  };
  const double plain = length_of_step();
  ball.explorer->key_down(Key::shift);
  CHECK(length_of_step() > 3.0 * plain);
  ball.explorer->key_up(Key::shift);
  ball.explorer->key_down(Key::control);
  CHECK(length_of_step() < 0.3 * plain);
  ball.explorer->key_up(Key::control);
  ball.explorer->scroll(2.0);
  CHECK(length_of_step() > 1.5 * plain);
  ball.press(Key::backspace);
  CHECK(ball.explorer->moved());
  CHECK(ball.explorer->camera().look_from == vec3(0, 0, 5));
}

TEST_CASE("Home brings all of the scene into view, and turns nothing", "[unit][preview]") {
  Ball ball;
  ball.explorer->drag(100.0, 30.0);
  ball.press(Key::d, 20.0);
  const dvec3 ahead = ball.explorer->viewpoint().forward();
  ball.press(Key::home);
  CHECK(ball.explorer->moved());
  CHECK(glm::length(ball.explorer->viewpoint().forward() - ahead) < 1e-6);
  // The ball fills the picture but for a margin of 8 % of the distance.
  const double touching = 1.0 / std::sin(20.0 * kPi / 180.0);
  CHECK(glm::length(ball.explorer->viewpoint().position()) == Approx(1.08 * touching).epsilon(1e-5));
  CHECK(ball.explorer->camera().focus_distance == 10.0f);
}

TEST_CASE("a click focuses on what is there, and Tab orbits around it", "[unit][preview]") {
  Ball ball;
  ball.explorer->click(50.0, 50.0);
  CHECK(ball.explorer->camera().focus_distance == Approx(4.0f));
  ball.explorer->click(1.0, 1.0);
  CHECK(ball.explorer->camera().focus_distance == Approx(4.0f));
  ball.explorer->point(50.0, 50.0);
  ball.press(Key::tab);
  REQUIRE(ball.explorer->pivot());
  ball.explorer->drag(100.0, 0.0);
  CHECK(glm::length(ball.explorer->viewpoint().position() - dvec3(0, 0, 1)) == Approx(4.0).epsilon(1e-5));
  CHECK(ball.explorer->viewpoint().position().x < -1.0);  // the scene follows the mouse
  ball.press(Key::tab);
  CHECK_FALSE(ball.explorer->pivot());
}

TEST_CASE("first surfaces lie where rays meet them, whatever the focus", "[unit][preview]") {
  Ball ball;
  CameraSettings camera = ball.loaded.camera;
  camera.focus_distance = GENERATE(1.0f, 4.0f, 300.0f);
  camera.defocus_angle = 5.0f;
  const std::vector<float> depths = first_depths(ball.shelf.get("bvh"), camera, 101, 51);
  REQUIRE(depths.size() == 101 * 51);
  const auto depth = [&](std::size_t x, std::size_t y) { return depths[y * 101 + x]; };
  CHECK(depth(50, 25) == Approx(4.0f));
  CHECK(depth(50, 0) == kInfinity);
  CHECK(depth(0, 25) == kInfinity);
  // Beside the middle: along the view, not along the ray. tan is that of the ray's angle to the view.
  const double tan = 10.0 / 25.5 * std::tan(20.0 * kPi / 180.0), d = 1.0 + tan * tan;
  const double expected = (5.0 - std::sqrt(25.0 - 24.0 * d)) / d;
  CHECK(depth(60, 25) == Approx(expected).epsilon(1e-5));
  CHECK(depth(50, 15) == Approx(expected).epsilon(1e-5));
}

TEST_CASE("the depths of a view are found once, and anew when the view changes", "[unit][preview]") {
  Ball ball;
  FirstSurfaces surfaces(ball.shelf);
  CameraSettings camera = ball.loaded.camera;
  const auto find = [&] {
    while (!surfaces.update(camera, 11, 11)) std::this_thread::yield();
  };
  CHECK_FALSE(surfaces.known(camera, 11, 11));
  find();
  CHECK(surfaces.known(camera, 11, 11));
  CHECK(surfaces.depths()[60] == Approx(4.0f));
  camera.focus_distance = 2.0f;
  camera.defocus_angle = 1.0f;
  CHECK(surfaces.known(camera, 11, 11));
  CHECK_FALSE(surfaces.update(camera, 11, 11));
  CHECK_FALSE(surfaces.known(camera, 12, 11));
  camera.look_from.z += 1.0f;
  CHECK_FALSE(surfaces.known(camera, 11, 11));
  find();
  CHECK(surfaces.depths()[60] == Approx(5.0f));
}

TEST_CASE("the mouse turns the camera while it is captured or a button is held, and never else", "[unit][preview]") {
  Ball ball;
  Mouse mouse(*ball.explorer);
  mouse.put(50.0, 50.0);
  const auto turned_by = [&](double dx, double dy) {
    const dvec3 before = ball.explorer->viewpoint().forward();
    mouse.move_by(dx, dy);
    return ball.explorer->viewpoint().forward() - before;
  };
  CHECK(turned_by(30.0, 20.0) == dvec3(0.0));
  ball.press(Key::m);
  CHECK(turned_by(30.0, 0.0).x > 0.1);    // to the right
  CHECK(turned_by(0.0, -30.0).y > 0.1);   // upwards
  CHECK(turned_by(-30.0, 0.0).x < -0.1);  // every motion counts anew
  // What capturing does to the pointer is no movement, and a captured mouse does not click.
  const dvec3 ahead = ball.explorer->viewpoint().forward();
  mouse.put(400.0, 300.0);
  CHECK(ball.explorer->viewpoint().forward() == ahead);
  mouse.put(50.0, 50.0);
  mouse.press();
  mouse.release(true);
  CHECK(ball.explorer->camera().focus_distance == 10.0f);
  ball.press(Key::m);
  CHECK(turned_by(30.0, 20.0) == dvec3(0.0));
  mouse.press();
  CHECK(turned_by(30.0, 0.0).x > 0.1);
  mouse.release(true);
  CHECK(turned_by(30.0, 0.0) == dvec3(0.0));
}

TEST_CASE("a left button that comes up where it went down focuses", "[unit][preview]") {
  Ball ball;
  Mouse mouse(*ball.explorer);
  const auto push = [&](double dx, bool left) {
    mouse.put(50.0, 50.0);
    mouse.press();
    mouse.move_by(dx, 0.0);
    mouse.move_by(-dx, 0.0);
    mouse.release(left);
    return ball.explorer->camera().focus_distance;
  };
  CHECK(push(0.0, false) == 10.0f);
  CHECK(push(10.0, true) == 10.0f);  // that was looking
  CHECK(push(1.0, true) == Approx(4.0f).epsilon(1e-3));
}

TEST_CASE("focus, aperture, accelerators, views", "[unit][preview]") {
  Ball ball;
  ball.press(Key::up, 0.5);
  CHECK(ball.explorer->camera().focus_distance > 11.0f);
  ball.press(Key::down, 1.0);
  CHECK(ball.explorer->camera().focus_distance < 9.0f);
  ball.press(Key::right_bracket, 2.0);
  CHECK(ball.explorer->camera().defocus_angle > 0.1f);
  ball.press(Key::left_bracket, 20.0);
  CHECK(ball.explorer->camera().defocus_angle == 0.0f);
  CHECK(ball.explorer->accel() == "bvh");
  CHECK(ball.explorer->other_accel() == "embree");
  ball.press(Key::digit3);
  CHECK(ball.explorer->accel() == "embree");
  CHECK(ball.explorer->other_accel() == "bvh");
  ball.press(Key::b);
  CHECK(ball.explorer->other_accel() == "list");
  ball.press(Key::digit9);
  CHECK(ball.explorer->accel() == "embree");
  ball.press(Key::v);
  CHECK(ball.explorer->view() == View::traced);
  ball.press(Key::v);
  ball.press(Key::c);
  CHECK(ball.explorer->view() == View::traced);
  CHECK(ball.explorer->compare() == Compare::split);
  ball.press(Key::escape);
  CHECK(ball.explorer->leaves());
  CHECK(read_text(ball / "ball.toml") == kBall);
}

TEST_CASE("Z and X change the field of view, within what a camera takes", "[unit][preview]") {
  Ball ball;
  ball.press(Key::z, 0.5);
  CHECK(ball.explorer->moved());
  CHECK(ball.explorer->camera().vfov < 35.0f);
  ball.press(Key::x, 1.0);
  CHECK(ball.explorer->camera().vfov > 45.0f);
  CHECK(ball.explorer->camera().look_from == vec3(0, 0, 5));
  ball.press(Key::x, 60.0);
  CHECK(ball.explorer->camera().vfov == 170.0f);
  ball.press(Key::z, 60.0);
  CHECK(ball.explorer->camera().vfov == 1.0f);
}

TEST_CASE("exposure goes by half stops, and moves no camera", "[unit][preview]") {
  Ball ball;
  ball.press(Key::equal);
  ball.press(Key::equal);
  ball.press(Key::equal);
  ball.press(Key::minus);
  CHECK(ball.explorer->exposure() == 1.0);
  CHECK_FALSE(ball.explorer->moved());
  CHECK(ball.explorer->message().find("+1 stops") != std::string::npos);
}

TEST_CASE("Enter writes the camera, and says so when it may not", "[unit][preview]") {
  Ball ball;
  ball.press(Key::d, 0.5);
  ball.press(Key::enter);
  std::string expected = kBall;
  const CameraSettings c = ball.explorer->camera();
  CHECK(read_text(ball / "ball.toml") == with_camera(kBall, "", c));
  CHECK(read_text(ball / "ball.toml").find("# the eye") != std::string::npos);
  CHECK(load_scene(ball / "ball.toml").camera.look_from == c.look_from);
  write_text(ball / "ball.toml", kBall);
  ball.press(Key::enter);
  CHECK(ball.explorer->message().find("changed since") != std::string::npos);
  CHECK(read_text(ball / "ball.toml") == kBall);
}

TEST_CASE("files that change are noticed once they rest, and what is remembered is no change", "[unit][preview]") {
  TempFolder folder;
  write_text(folder / "a", "1");
  WatchedFiles files({folder / "a", folder / "b"});
  CHECK_FALSE(files.changed());
  write_text(folder / "a", "12");
  CHECK_FALSE(files.changed());  // it may still be written to
  write_text(folder / "a", "123");
  CHECK_FALSE(files.changed());
  CHECK(files.changed());
  files.remember();
  CHECK_FALSE(files.changed());
  CHECK_FALSE(files.changed());
  write_text(folder / "b", "");
  CHECK_FALSE(files.changed());
  CHECK(files.changed());
  std::filesystem::remove(folder / "b");
  CHECK_FALSE(files.changed());
  CHECK_FALSE(files.changed());  // as it is remembered
}

TEST_CASE("a scene read again keeps the view, unless its file has another camera", "[unit][preview]") {
  Ball ball;
  ball.press(Key::f5);
  CHECK(ball.explorer->take_reload_request());
  CHECK_FALSE(ball.explorer->take_reload_request());
  ball.press(Key::d, 0.5);
  const CameraSettings here = ball.explorer->camera();
  ball.explorer->change_scene(ball.loaded.camera);
  ball.explorer->step(0.0);
  CHECK(ball.explorer->moved());
  CHECK(ball.explorer->camera() == here);
  CameraSettings other = ball.loaded.camera;
  other.vfov = 50.0f;
  ball.explorer->change_scene(other);
  CHECK(ball.explorer->camera() == other);
  ball.press(Key::enter);
  CHECK(ball.explorer->take_written());
}
