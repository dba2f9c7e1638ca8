// What raylab-render --check says of the shipped scenes: bytes and code paths are those of what a scene uses.
#include <string>

#include "catch.hpp"
#include "run_program.hpp"
#include "shipped_scenes.hpp"

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
      {"cornell", "spheres, area lights", 376, 208, 2, 0},
      {"one-weekend", "spheres", 484 * (16 + 4), 0, 0, 0},
      {"mirror-room", "spheres, area lights, plane mirrors", 6299528, 204, 2, 0},
      {"dragon", "shading normals, area lights", 20960952, 196, 2, 0},
      {"bunny", "shading normals, area lights", 91508, 204, 2, 0},
      {"globe", "shading normals, area lights", 7202840, 200, 2, 0},
      {"forest", "", 3674628, 0, 0, 0},
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
