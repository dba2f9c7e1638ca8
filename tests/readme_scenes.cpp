// The scene files that README.md shows.
#include <algorithm>
#include <filesystem>

#include "catch.hpp"
#include "raylab/image/image_file.hpp"
#include "run_program.hpp"
#include "temp_folder.hpp"

using namespace raylab::test;
namespace fs = std::filesystem;

TEST_CASE("every scene of the README renders as it stands, in the folder of the shipped ones", "[cli]") {
  const TempFolder folder;
  for (const fs::directory_entry& entry : fs::directory_iterator(RAYLAB_SOURCE_DIR "/scenes")) {
    if (entry.path().extension() != ".toml")
      fs::create_symlink(entry.path(), folder / entry.path().filename().string());
  }
  const std::string readme = read_text(RAYLAB_SOURCE_DIR "/README.md"), begin = "```toml\n", end = "\n```";
  int scenes = 0;
  for (std::size_t at = 0; (at = readme.find(begin, at)) != std::string::npos;) {
    at += begin.size();
    const std::string text = readme.substr(at, readme.find(end, at) + 1 - at);
    INFO(text);
    const std::string scene = (folder / ("readme-" + std::to_string(++scenes) + ".toml")).string();
    const std::string picture = (folder / "picture.exr").string();
    write_text(scene, text);
    const ProgramResult result = run_program(RAYLAB_BINARY_DIR "/raylab-render", {scene, "--width", "32", "--spp", "16",
                                                                                  "--progress", "none", "-o", picture});
    CHECK(result.err.empty());  // no warning
    REQUIRE(result.exit_code == 0);
    const std::vector<raylab::Rgb> pixels = raylab::read_image(picture).pixels;
    const auto lit = std::count_if(pixels.begin(), pixels.end(), [](const raylab::Rgb& p) { return p[1] > 0.01F; });
    CHECK(lit > static_cast<std::ptrdiff_t>(pixels.size() / 2));
  }
  CHECK(scenes > 0);
}
