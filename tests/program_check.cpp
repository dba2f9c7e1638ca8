// What raylab-render --check says of the shipped scenes: bytes and code paths are those of what a scene uses.
#include <nlohmann/json.hpp>
#include <string>

#include "catch.hpp"
#include "run_program.hpp"
#include "shipped_scenes.hpp"
#include "temp_folder.hpp"

using namespace raylab::test;

TEST_CASE("no shipped scene has bytes or code paths for what it does not use", "[cli]") {
  struct Expected {
    const char* scene;
    const char* needs;        ///< what the code has to be ready for
    std::size_t scene_bytes;  ///< a sphere takes 16 + 4, a triangle, a vertex, a normal and a texel 12
    std::size_t light_bytes, lights;
    std::size_t dropped_bytes;
  };
  const Expected table[] = {
      {"cornell", "spheres, area lights, specular spheres", 376, 208, 2, 0},
      {"one-weekend", "spheres", 484 * (16 + 4), 0, 0, 0},
      {"mirror-room", "spheres, area lights, plane mirrors", 6299528, 204, 2, 0},
      {"dragon", "shading normals, area lights", 20960952, 196, 2, 0},
      {"bunny", "shading normals, area lights", 91508, 204, 2, 0},
      {"globe", "shading normals, area lights", 7202840, 200, 2, 0},
      {"forest", "", 3674628, 0, 0, 0},
      {"lamps", "spheres, area lights", 55544, 58848, 1500, 0},
      {"caustics", "spheres, area lights, specular spheres", 272, 200, 2, 0},
      {"kaleidoscope", "spheres, area lights, plane mirrors", 364, 208, 2, 0},
  };
  for (const Expected& e : table) {
    const auto file = shipped_scene(e.scene);
    if (!file) continue;
    const ProgramResult result = run_program(RAYLAB_BINARY_DIR "/raylab-render", {file->string(), "--check"});
    REQUIRE(result.exit_code == 0);
    std::string needs;
    for (std::size_t at = 0; (at = result.out.find("\n  yes  ", at)) != std::string::npos; ++at) {
      const std::size_t name = at + 8;
      needs += (needs.empty() ? "" : ", ") + result.out.substr(name, result.out.find(':', name) - name);
    }
    INFO(e.scene);
    CHECK(needs == e.needs);
    CHECK(result.out.substr(result.out.find("bytes\n")) ==
          "bytes\n  " + std::to_string(e.scene_bytes) + " of geometry, material ids and pictures\n  " +
              std::to_string(e.light_bytes) + " for the sampling of " + std::to_string(e.lights) + " lights\n  " +
              std::to_string(e.dropped_bytes) + " of mesh attributes that no material reads were left out\n");
  }
}

TEST_CASE("the memory that a render takes is stated beforehand, within a tenth", "[cli]") {
  const std::string program = RAYLAB_BINARY_DIR "/raylab-render";
  const TempFolder folder;
  const std::string stats = (folder / "s.json").string();
  const auto number_after = [](const std::string& text, const std::string& word) {
    const std::size_t at = text.find(word);
    REQUIRE(at != std::string::npos);
    return std::stod(text.substr(text.find_first_of("0123456789", at + word.size())));
  };
  for (const char* scene : {"dragon", "globe", "cornell"}) {
    const auto file = shipped_scene(scene);
    if (!file) continue;
    for (const std::string accel : {"list", "rtiow", "bvh", "embree", "embree-robust", "exact"}) {
      if (scene != std::string("globe") && accel != "bvh" && accel != "embree") continue;
      // Of small scenes the film is nearly all.
      const std::string width = scene == std::string("cornell") ? "1600" : "16";
      const std::vector<std::string> arguments{file->string(), "--accel", accel, "--width", width};
      std::vector<std::string> check = arguments, render = arguments;
      check.push_back("--check");
      render.insert(render.end(),
                    {"--spp", "1", "--max-depth", "1", "-o", (folder / "a.png").string(), "--stats", stats});
      const ProgramResult checked = run_program(program, check), rendered = run_program(program, render);
      INFO(scene << " " << checked.out << rendered.err);
      REQUIRE(rendered.exit_code == 0);
      if (width == "16") {
        const double bytes = nlohmann::json::parse(read_text(stats))["bytes"];
        CHECK(number_after(checked.out, "\naccel      " + accel + ": about ") ==
              Approx(bytes / 1048576).epsilon(0.1).margin(0.06));
        continue;
      }
      const double scene_and_film = number_after(checked.out, "\nmemory ");
      constexpr double kProgram = 12.0;  // MiB that it takes itself
#ifndef RAYLAB_SANITIZED
      CHECK(scene_and_film + kProgram == Approx(static_cast<double>(rendered.peak_kib) / 1024).epsilon(0.1));
#endif
    }
  }
}

TEST_CASE("the map of samples of an adaptive render counts among the memory that is stated", "[cli]") {
  const auto film_of = [](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{shipped_scene("cornell")->string(), "--check", "--width", "1600"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const std::string text = run_program(RAYLAB_BINARY_DIR "/raylab-render", arguments).out;
    const std::size_t at = text.find(" pixels, ");
    REQUIRE(at != std::string::npos);
    return std::stod(text.substr(at + 9));
  };
  const double map = 1600.0 * 1600.0 * 6.0 / 1048576.0;
  CHECK(film_of({"--spp", "17", "--adaptive"}) == Approx(film_of({"--spp", "17"}) + map).margin(0.11));
  CHECK(film_of({"--spp", "16", "--adaptive"}) == film_of({"--spp", "16"}));  // there is no map
}

TEST_CASE("the town loads with millions of triangles, nothing of it missing", "[cli]") {
  const auto file = shipped_scene("town");
  if (!file) return;
  const ProgramResult result =
      run_program(RAYLAB_BINARY_DIR "/raylab-render", {file->string(), "--check", "--set", "render.width=32"});
  REQUIRE(result.exit_code == 0);
  CHECK(result.err.find("missing") == std::string::npos);
  const std::size_t number = result.out.find_first_of("0123456789", result.out.find("\nbytes"));
  CHECK(std::stoull(result.out.substr(number)) > 150'000'000);
}
