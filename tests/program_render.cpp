// raylab-render as its user meets it: options, exit codes, messages, files.
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "file_size_limit.hpp"
#include "raylab/image/image_file.hpp"
#include "raylab/image/metrics.hpp"
#include "small_scene.hpp"

using namespace raylab;
using namespace raylab::test;
namespace fs = std::filesystem;

TEST_CASE("raylab-render writes each picture it is asked for and reports what it did", "[cli]") {
  const SmallScene small;
  const std::string png = (small / "ball.png").string();
  const std::string stats = (small / "stats.json").string();
  const ProgramResult result = raylab_render({small.scene, "-o", small.output, "-o", png, "--stats", stats, "--layers",
                                              "albedo,normal,depth,variance,samples", "--seed", "9", "--threads", "2"});
  INFO(result.err);
  REQUIRE(result.exit_code == 0);
  CHECK(result.err.empty());
  for (const char* part :
       {"1 spheres", "built in", "camera", "shadow", "Mrays/s", "Mpaths/s", "relMSE", "dropped    0"}) {
    INFO(part << " in " << result.out);
    CHECK(result.out.find(part) != std::string::npos);
  }
  const Image picture = read_exr(small.output);
  CHECK(picture.width == 16);
  CHECK(picture.height == 8);
  CHECK(picture.at(0, 0) == Rgb(1.0f));  // the sky
  CHECK(picture.at(8, 4).r < 0.9f);      // the ball
  CHECK(read_image8(png).width == 16);
  const Attributes attributes = read_exr_attributes(small.output);
  CHECK(attributes.at("raylab.seed") == "9");
  CHECK(attributes.at("raylab.version") == RAYLAB_VERSION);
  CHECK(attributes.at("raylab.partial") == "false");
  CHECK(attributes.at("raylab.command").find("--seed 9") != std::string::npos);
  const auto json = nlohmann::json::parse(read_text(stats));
  CHECK(json.at("rays").at("camera") == 16 * 8 * 4);
  CHECK(json.at("version") == RAYLAB_VERSION);
  CHECK(json.at("spp") == 4);
  CHECK(json.at("partial") == false);
  CHECK(json.at("threads") == 2);
  CHECK(json.at("clamped_samples") == 0);
  CHECK(json.at("faded_samples") == 0);
}

TEST_CASE("the options of raylab-render reach the picture", "[cli]") {
  const SmallScene small;
  const auto render = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {small.scene, "-o", small.output, "--quiet"});
    const ProgramResult result = raylab_render(arguments);
    INFO(result.err);
    REQUIRE(result.exit_code == 0);
    CHECK(result.out.empty());
    CHECK(result.err.empty());
    return read_exr(small.output);
  };
  const Image plain = render({});
  const auto differs = [&](const std::vector<std::string>& arguments) {
    return image_error(render(arguments), plain).different_pixels > 0;
  };
  CHECK_FALSE(differs({}));
  CHECK_FALSE(differs({"--threads", "1", "--tile-size", "3"}));
  CHECK(differs({"--seed", "1"}));
  CHECK(differs({"--samples", "4:8"}));
  CHECK(differs({"--spp", "5"}));
  CHECK(differs({"--sampler", "independent"}));
  CHECK(differs({"--max-depth", "1"}));
  CHECK(differs({"--set", "camera.vfov=50"}));
  CHECK(differs({"--set", "material.grey.albedo=[0.1, 0.2, 0.3]", "--set", "sphere.0.radius=0.5"}));
  CHECK(render({"--width", "32"}).height == 16);  // alone, it keeps the aspect ratio
  CHECK(render({"--height", "4"}).width == 8);
  CHECK(render({"--width", "5", "--height", "7"}).height == 7);

  const Image cropped = render({"--crop", "7,3,2,1"});
  CHECK(cropped.at(7, 3) == plain.at(7, 3));
  CHECK(cropped.at(8, 3) == plain.at(8, 3));
  CHECK(cropped.at(0, 0) == Rgb(0.0f));
}

TEST_CASE("every built-in accelerator can be chosen by name", "[cli]") {
  const SmallScene small;
  const ProgramResult list = raylab_render({"--list-accels"});
  CHECK(list.exit_code == 0);
  for (const std::string name : {"list", "rtiow", "bvh", "embree", "embree-robust"}) {
    CHECK(("\n" + list.out).find("\n" + name + " ") != std::string::npos);
    CHECK(raylab_render({small.scene, "-o", small.output, "--accel", name, "--quiet"}).exit_code == 0);
  }
  CHECK(raylab_render({small.scene, "-o", small.output, "--accel", "list", "--intersector", "fast"}).exit_code == 0);
}

TEST_CASE("the build quality has an old name, which the help does not show", "[cli]") {
  const SmallScene small;
  const std::string stats = small.output + ".json";
  for (const std::string option : {"--quality", "--bvh-quality"}) {
    REQUIRE(raylab_render({small.scene, "-o", small.output, "--accel", "embree", "--compact", option, "best", "--stats",
                           stats, "--quiet"})
                .exit_code == 0);
    const auto json = nlohmann::json::parse(read_text(stats));
    CHECK(json["quality"] == "best");
    CHECK(json["compact"] == true);
  }
  const std::string help = raylab_render({"--help"}).out;
  CHECK(help.find("--quality") != std::string::npos);
  CHECK(help.find("--bvh-quality") == std::string::npos);
}

TEST_CASE("without -o the picture has the name of the scene", "[cli]") {
  const TempFolder folder;
  // The program is started in the folder the tests run in; a relative scene name there would litter it.
  const fs::path old = fs::current_path();
  fs::current_path(folder.path());
  const ProgramResult result = raylab_render({kCornell, "--width", "8", "--spp", "1", "--quiet"});
  fs::current_path(old);
  CHECK(result.exit_code == 0);
  CHECK(read_exr(folder / "cornell.exr").width == 8);
}

TEST_CASE("the check option says how the scene was understood and writes nothing", "[cli]") {
  const TempFolder folder;
  const std::string output = (folder / "none.exr").string();
  const ProgramResult result = raylab_render({kCornell, "-o", output, "--check"});
  CHECK(result.exit_code == 0);
  for (const char* part : {"12 triangles", "2 spheres", "lambertian", "dielectric", "mirror", "area lights",
                           "376 of geometry", "800 x 800 pixels, 60.4 MiB", "; 64 samples a pixel\n"}) {
    INFO(part << " in " << result.out);
    CHECK(result.out.find(part) != std::string::npos);
  }
  CHECK(folder.entries() == 0);
}

TEST_CASE("what cannot be printed is not taken for done", "[cli]") {
  const FileSizeLimit limit(3);  // of standard output too
  CHECK(raylab_render({kCornell, "--check"}).exit_code == 4);
  CHECK(raylab_render({"--list-accels"}).exit_code == 4);
}

TEST_CASE("a wrong command line exits with 2 and names the option", "[cli]") {
  const SmallScene small;
  small.expect_failure(2, {"bvvh", "embree"}, {"--accel", "bvvh"});
  small.expect_failure(2, {"--intersector", "sloppy"}, {"--accel", "list", "--intersector", "sloppy"});
  small.expect_failure(2, {"--intersector"}, {"--accel", "embree", "--intersector", "fast"});
  small.expect_failure(2, {"--isa", "mmx"}, {"--accel", "bvh", "--isa", "mmx"});
  small.expect_failure(2, {"--quality", "bvh, embree, embree-robust"}, {"--accel", "list", "--quality", "best"});
  small.expect_failure(2, {"--quality", "good"}, {"--quality", "good"});
  small.expect_failure(2, {"--compact", "embree, embree-robust"}, {"--compact"});
  small.expect_failure(2, {"--integrator", "magic"}, {"--integrator", "magic"});
  small.expect_failure(2, {"--sampler", "dice"}, {"--sampler", "dice"});
  small.expect_failure(2, {"--spp"}, {"--spp", "0"});
  small.expect_failure(2, {"--width", "0"}, {"--width", "0"});
  small.expect_failure(2, {"--crop", "10,0,10,1"}, {"--crop", "10,0,10,1"});
  small.expect_failure(2, {"--crop", "1,2,x"}, {"--crop", "1,2,x"});
  for (const char* crop : {"4294967296,0,1,1", "0,0,4294967297,1", "-4294967296,0,1,1", "0,0,1,1,", "0,0,1", "0,,1,1"})
    small.expect_failure(2, {"--crop", "expected X,Y,WIDTH,HEIGHT"}, {std::string("--crop=") + crop});
  small.expect_failure(2, {"--width", "4294836225 pixels", "268435456"}, {"--width", "65535", "--height", "65535"});
  small.expect_failure(2, {"--set", "camera.vfow"}, {"--set", "camera.vfow=3"});
  small.expect_failure(2, {"unknown option --nonsense"}, {"--nonsense"});
  small.expect_failure(2, {"unknown option --with: the nearest option is --width"}, {"--with", "8"});
  small.expect_failure(2, {"unexpected argument other.toml"}, {"other.toml", "another.toml"});
  small.expect_failure(2, {"is a scene"}, {"--ground"});
  const ProgramResult nothing = raylab_render({});
  CHECK(nothing.exit_code == 2);
  CHECK(nothing.err.find("scene") != std::string::npos);
}

TEST_CASE("a side that is derived from the scene's aspect ratio counts in the limit of pixels", "[cli]") {
  SmallScene small;
  small.change("width = 16\nheight = 8", "width = 268435456\nheight = 1");
  small.expect_failure(2, {"--height", "17592186044416 x 65536", "268435456"}, {"--height", "65536"});
  small.change("width = 16\nheight = 8", "width = 1\nheight = 268435456");
  small.expect_failure(2, {"--width", "65536 x 17592186044416"}, {"--width", "65536"});
}

TEST_CASE("views are rendered one picture each, and a flight leads through them", "[cli]") {
  SmallScene small;
  small.expect_failure(3, {"has 0 [[view]] tables, and --views needs one or more"}, {"--views"});
  small.change("[material.grey]",
               "[[view]]\nname = \"front\"\n[[view]]\nname = \"side\"\nlook_from = [5, 0, 0]\n"
               "[material.grey]");
  const std::string output = (small / "a.exr").string();
  CHECK(raylab_render({small.scene, "-o", output, "--views", "--quiet"}).exit_code == 0);
  CHECK(read_exr(small / "a-front.exr").width == 16);
  CHECK(read_exr(small / "a-side.exr").width == 16);
  CHECK_FALSE(fs::exists(output));
  CHECK(raylab_render({small.scene, "-o", (small / "whole.exr").string(), "--quiet"}).exit_code == 0);
  CHECK(read_exr(small / "whole.exr").pixels == read_exr(small / "a-front.exr").pixels);
  const ProgramResult flight = raylab_render({small.scene, "-o", (small / "b.png").string(), "--fly", "3"});
  INFO(flight.err);
  CHECK(flight.exit_code == 0);
  CHECK(flight.out.find("film       ") != std::string::npos);
  for (const char* frame : {"b-0001.png", "b-0002.png", "b-0003.png"}) CHECK(read_image8(small / frame).width == 16);
  small.expect_failure(2, {"--views"}, {"--views", "--fly", "3"});
}

TEST_CASE("a model is rendered as it is, and the scene made for it can be kept once", "[cli]") {
  const TempFolder folder;
  const std::string model = (folder / "model.obj").string(), scene = (folder / "sub.toml").string();
  write_text(model, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const std::string picture = (folder / "a.png").string(), again = (folder / "b.png").string();
  const ProgramResult result = raylab_render({model, "-o", picture, "--write-scene", scene});
  INFO(result.err);
  REQUIRE(result.exit_code == 0);
  CHECK(result.err.empty());
  CHECK(raylab_render({scene, "-o", again}).exit_code == 0);
  CHECK(read_text(picture) == read_text(again));
  const std::string text = read_text(scene);
  CHECK(text.starts_with("version = 1\n"));
  const ProgramResult second = raylab_render({model, "-o", picture, "--write-scene", scene});
  CHECK(second.exit_code == 4);
  CHECK(second.err.find("is there already") != std::string::npos);
  const ProgramResult both = raylab_render({model, "--write-scene", scene, "--set", "camera.vfov=20"});
  CHECK(both.exit_code == 2);
  CHECK(both.err.find("--set excludes --write-scene") != std::string::npos);
  CHECK(read_text(scene) == text);
}

TEST_CASE("names that are not UTF-8 are taken, and replaced where JSON cannot hold them", "[cli]") {
  const SmallScene small;
  const std::string odd = (small / "odd\xff.exr").string();
  const std::string stats = (small / "stats\xfe.json").string();
  fs::rename(small.scene, small / "odd\xff.toml");
  const ProgramResult result =
      raylab_render({(small / "odd\xff.toml").string(), "-o", odd, "--stats", stats, "--spp", "1"});
  INFO(result.err);
  CHECK(result.exit_code == 0);
  CHECK(read_exr(odd).width == 16);
  CHECK(nlohmann::json::parse(read_text(stats)).at("scene") == "odd\xef\xbf\xbd");
}

TEST_CASE("an output that cannot be written is told before rendering, with exit code 4", "[cli]") {
  const SmallScene small;
  const std::string nowhere = (small / "no/such/folder/x.exr").string();
  const ProgramResult result = raylab_render({small.scene, "-o", nowhere, "--spp", "1000000", "--width", "4000"});
  CHECK(result.exit_code == 4);
  CHECK(result.err.find(nowhere) != std::string::npos);
  const ProgramResult folder = raylab_render({small.scene, "-o", small.path().string() + "/folder.exr/"});
  CHECK(folder.exit_code != 0);
  const ProgramResult ending = raylab_render({small.scene, "-o", (small / "x.gif").string()});
  CHECK(ending.exit_code == 2);
  CHECK(ending.err.find("x.gif") != std::string::npos);
}

TEST_CASE("no file is written over another output, nor over what the scene is read from", "[cli]") {
  const SmallScene small;
  const std::string scene = small.scene, picture = (small / "ball.png").string();
  fs::create_hard_link(scene, small / "link.exr");
  small.expect_failure(2, {"link.exr: is read by the scene"}, {"-o", (small / "link.exr").string()});
  small.expect_failure(2, {small.scene + ": is read by the scene"}, {"--stats", small.scene});
  small.expect_failure(2, {small.output + ": would be written twice"}, {"--stats", small.output});
  small.expect_failure(2, {"ball.png: would be written twice"},
                       {"-o", picture, "-o", (small.path() / "." / "ball.png").string()});
  CHECK(read_text(scene) == kBall);
  CHECK_FALSE(fs::exists(picture));
}

TEST_CASE("an interrupted render writes what it has, marked partial, and exits with 130", "[cli]") {
  const SmallScene small;
  // `timeout` sends the signal that Ctrl-C would.
  const ProgramResult result =
      run_program("/usr/bin/timeout", {"--preserve-status", "-s", "INT", "2", kProgram, small.scene, "-o", small.output,
                                       "--spp", "100000000", "--width", "64", "--progress", "json"});
  CHECK(result.exit_code == 130);
  CHECK(result.out.find("partial") != std::string::npos);
  CHECK(read_exr_attributes(small.output).at("raylab.partial") == "true");
  CHECK(read_exr(small.output).at(0, 0) == Rgb(1.0f));
  // Each line of JSON progress is JSON.
  std::size_t lines = 0;
  for (std::size_t at = 0, end; (end = result.err.find('\n', at)) != std::string::npos; at = end + 1, ++lines) {
    const auto json = nlohmann::json::parse(result.err.substr(at, end - at));
    CHECK(json.at("progress") <= 1.0);
  }
  CHECK(lines >= 1);
}
