// --adaptive as its user meets it.
#include <nlohmann/json.hpp>

#include "raylab/image/film_file.hpp"
#include "small_scene.hpp"

using namespace raylab;
using namespace raylab::test;
namespace fs = std::filesystem;

namespace {

ProgramResult render(const SmallScene& small, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), small.scene);
  return raylab_render(arguments);
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

Film read_film(const fs::path& file) {
  FilmFile opened(file);
  Film film(opened.width(), opened.height());
  opened.add_to(film);
  return film;
}

}  // namespace

TEST_CASE("an adaptive render says what it took, and its film goes on to the bits of one render",
          "[cli][film][adaptive]") {
  const SmallScene small;
  const std::string output = (small / "out.exr").string(), whole = (small / "whole.exr").string();
  const std::string stats = (small / "stats.json").string();
  const ProgramResult first =
      render(small, {"-o", output, "--spp", "20", "--film", "--adaptive", "--layers", "samples", "--stats", stats});
  INFO(first.err);
  CHECK(first.exit_code == 0);
  CHECK(contains(first.out, "adaptive   16 to "));
  const auto json = nlohmann::json::parse(read_text(stats));
  CHECK(json.at("adaptive") == true);
  CHECK(json.at("samples_taken").at("fewest") == 16);
  CHECK(json.at("samples_taken").at("most") > 20);
  const FilmInfo info = FilmFile(output).info();
  CHECK(info.settings.at("adaptive") == "by 16 samples");
  CHECK(info.wanted == 20);
  const ProgramResult more = render(small, {"-o", output, "--spp", "70", "--film", "--adaptive", "--resume"});
  INFO(more.err);
  CHECK(more.exit_code == 0);
  CHECK(render(small, {"-o", whole, "--spp", "70", "--film", "--adaptive"}).exit_code == 0);
  CHECK(read_film(output) == read_film(whole));
  const ProgramResult fewer = render(small, {"-o", output, "--spp", "40", "--film", "--adaptive", "--resume"});
  CHECK(fewer.exit_code == 3);
  CHECK(contains(fewer.err, "samples of a pixel, and 40 are asked for"));
}

TEST_CASE("parts of an adaptive render, and films of both kinds together, are refused", "[cli][film][adaptive]") {
  const SmallScene small;
  const std::string adaptive = (small / "adaptive.exr").string(), even = (small / "even.exr").string();
  small.expect_failure(2, {"--adaptive", "--samples"}, {"--adaptive", "--samples", "0:8"});
  CHECK(render(small, {"-o", adaptive, "--spp", "20", "--film", "--adaptive"}).exit_code == 0);
  CHECK(render(small, {"-o", even, "--spp", "20", "--film", "--adaptive", "--no-adaptive"}).exit_code == 0);
  const auto resumed = [&](const std::string& output, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"-o", output, "--spp", "40", "--film", "--resume"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramResult result = render(small, arguments);
    CHECK(result.exit_code == 3);
    return result.err;
  };
  CHECK(contains(resumed(adaptive, {}), "adaptive is by 16 samples there and not said here"));
  CHECK(contains(resumed(even, {"--adaptive"}), "adaptive is not said there and by 16 samples here"));
  const std::string rest = (small / "rest.exr").string();
  CHECK(render(small, {"-o", rest, "--samples", "20:40"}).exit_code == 0);
  const ProgramResult merged =
      run_program(RAYLAB_BINARY_DIR "/raylab-image", {"merge", rest, adaptive, "-o", (small / "m.exr").string()});
  CHECK(merged.exit_code == 3);
  CHECK(contains(merged.err, adaptive + ": cannot be merged with the others: its samples are where the error was"));
}

TEST_CASE("the error so far is estimated while a render goes on", "[cli][film]") {
  const SmallScene small;
  const std::string output = (small / "out.exr").string();
  const ProgramResult result =
      render(small, {"-o", output, "--spp", "1000000000", "--time-limit", "2.5s", "--progress", "json"});
  CHECK(result.exit_code == 0);
  const std::size_t last = result.err.rfind('{');
  REQUIRE(last != std::string::npos);
  const auto json = nlohmann::json::parse(result.err.substr(last));
  CHECK(json.at("estimated_relmse") > 0.0);
  CHECK(json.at("estimated_relmse") < 1e-3);
}
