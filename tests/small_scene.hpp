#pragma once
#include <string>
#include <vector>

#include "catch.hpp"
#include "run_program.hpp"
#include "temp_folder.hpp"

namespace raylab::test {

inline const std::string kProgram = RAYLAB_BINARY_DIR "/raylab-render";
inline const std::string kCornell = RAYLAB_SOURCE_DIR "/scenes/cornell.toml";

inline ProgramResult raylab_render(const std::vector<std::string>& arguments) {
  return run_program(kProgram, arguments);
}

inline constexpr const char* kBall = R"([camera]
look_from = [0, 0, 5]
look_at = [0, 0, 0]
vfov = 40
[render]
width = 16
height = 8
samples_per_pixel = 4
max_depth = 5
[background]
color = [1, 1, 1]
[material.grey]
type = "lambertian"
albedo = [0.5, 0.5, 0.5]
[[sphere]]
center = [0, 0, 0]
radius = 1
material = "grey"
)";

/// A folder with a small scene, and an output file that was there before.
struct SmallScene : TempFolder {
  std::string scene = (*this / "ball.toml").string();
  std::string output = (*this / "ball.exr").string();
  SmallScene() {
    write_text(scene, kBall);
    write_text(output, "what was here before");
  }
  /// Writes the scene with `from` replaced by `to`.
  void change(const std::string& from, const std::string& to) {
    std::string text = kBall;
    const std::size_t at = text.find(from);
    REQUIRE(at != std::string::npos);
    write_text(scene, text.replace(at, from.size(), to));
  }
  /// Renders; it must fail with this exit code and one line that contains the parts, and leave the output alone.
  void expect_failure(int exit_code, const std::vector<std::string>& parts,
                      std::vector<std::string> arguments = {}) const {
    arguments.insert(arguments.begin(), {scene, "-o", output});
    const ProgramResult result = raylab_render(arguments);
    INFO(result.err);
    CHECK(result.exit_code == exit_code);
    CHECK(result.out.empty());
    for (const std::string& part : parts) {
      INFO("expected: " << part);
      CHECK(result.err.find(part) != std::string::npos);
    }
    CHECK(result.err.rfind("raylab-render: ", 0) == 0);
    CHECK(read_text(output) == "what was here before");
  }
};

}  // namespace raylab::test
