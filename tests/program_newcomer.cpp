// What someone does in the first minutes, by the commands that the README gives.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "catch.hpp"
#include "gltf_files.hpp"
#include "raylab/image/image_file.hpp"
#include "run_program.hpp"
#include "temp_folder.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

/// A pyramid on the ground, of five vertices.
constexpr const char* kPyramid =
    "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv 0 1.5 0\nf 4 3 5\nf 3 2 5\nf 2 1 5\nf 1 4 5\nf 1 2 3 4\n";

/// Runs a program where the user stands, which must go well and have nothing to say against it.
ProgramResult run_well(const std::string& program, const std::vector<std::string>& arguments) {
  const ProgramResult result = run_program(std::string(RAYLAB_BINARY_DIR "/") + program, arguments);
  INFO(program << " " << arguments.front() << ": " << result.err);
  REQUIRE(result.exit_code == 0);
  CHECK(result.err.find("warning") == std::string::npos);
  return result;
}

/// Whether a picture shows something: neither one colour nor black.
bool shows_something(const std::filesystem::path& file) {
  const auto pixels = read_image8(file).rgb;
  const auto [least, most] = std::minmax_element(pixels.begin(), pixels.end());
  return *most > 100 && *most - *least > 50;
}

}  // namespace

TEST_CASE("a newcomer renders the spheres of the book", "[cli]") {
  const TempFolder folder;
  write_text(folder / "spheres.toml", R"(
[camera]
look_from = [-2, 2, 1]
vfov = 40
[render]
width = 80
height = 45
[background]
bottom = [1, 1, 1]
top = [0.5, 0.7, 1]
[material.ground]
type = "lambertian"
albedo = [0.8, 0.8, 0]
[material.glass]
type = "dielectric"
[material.gold]
type = "metal"
albedo = [0.8, 0.6, 0.2]
[[sphere]]
center = [0, -100.5, -1]
radius = 100
material = "ground"
[[sphere]]
center = [0, 0, -1.2]
radius = 0.5
material = "gold"
[[sphere]]
center = [-1, 0, -1]
radius = 0.5
material = "glass"
)");
  run_well("raylab-render", {(folder / "spheres.toml").string(), "-o", (folder / "spheres.png").string()});
  CHECK(shows_something(folder / "spheres.png"));
}

TEST_CASE("a newcomer renders a model of each format", "[cli]") {
  const TempFolder folder;
  write_text(folder / "mine.obj", kPyramid);
  write_text(folder / "mine.ply",
             "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
             "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
             "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
  write_text(folder / "mine.stl",
             "solid mine\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 1\nendloop\nendfacet\n"
             "endsolid mine\n");
  write_text(folder / "mine.gltf", one_triangle().gltf());
  for (const char* model : {"mine.obj", "mine.ply", "mine.stl", "mine.gltf"}) {
    const std::string picture = (folder / (std::string(model) + ".png")).string();
    run_well("raylab-render", {(folder / model).string(), "-o", picture, "--width", "64", "--ground"});
    INFO(model);
    CHECK(shows_something(picture));
  }
}

TEST_CASE("a newcomer compares the accelerators on a model", "[cli]") {
  const TempFolder folder;
  write_text(folder / "mine.obj", kPyramid);
  const std::string out = (folder / "results").string();
  const ProgramResult result = run_well(
      "raylab-bench", {"rays", (folder / "mine.obj").string(), "--rays", "1000", "--repeats", "2", "--out", out});
  for (const char* accel : {"bvh", "rtiow", "embree"}) CHECK(result.out.find(accel) != std::string::npos);
  const auto rows = nlohmann::json::parse(read_text(folder / "results" / "results.json")).at("rows");
  CHECK(std::any_of(rows.begin(), rows.end(), [](const auto& row) { return row.at("scene") == "mine"; }));
}
