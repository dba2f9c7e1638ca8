#include <algorithm>
#include <nlohmann/json.hpp>

#include "catch.hpp"
#include "file_size_limit.hpp"
#include "raylab/image/image_file.hpp"
#include "run_program.hpp"
#include "temp_folder.hpp"

using namespace raylab;
using namespace raylab::test;
namespace fs = std::filesystem;

namespace {

ProgramResult raylab_image(const std::vector<std::string>& arguments) {
  return run_program(RAYLAB_BINARY_DIR "/raylab-image", arguments);
}

/// Checks the exit code, that standard output is empty, and that standard error is one line that begins with the
/// program's name and contains the part.
void expect_failure(const std::vector<std::string>& arguments, int exit_code, const std::string& part) {
  const ProgramResult result = raylab_image(arguments);
  INFO(result.err);
  CHECK(result.exit_code == exit_code);
  CHECK(result.out.empty());
  CHECK(result.err.rfind("raylab-image: ", 0) == 0);
  CHECK(result.err.find(part) != std::string::npos);
  CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
  CHECK(result.err.back() == '\n');
}

/// A folder with two EXR pictures, a.exr of 1 and 1 and b.exr of 1 and 2.
struct Pictures : TempFolder {
  Pictures() {
    Image image(2, 1);
    image.pixels = {Rgb(1.0f), Rgb(1.0f)};
    write_exr(*this / "a.exr", image, {{"Z", true, {4.0f, 5.0f}}}, {{"seed", "7"}});
    image.pixels[1] = Rgb(2.0f);
    write_exr(*this / "b.exr", image);
  }
  std::string name(const std::string& file) const { return (*this / file).string(); }
};

}  // namespace

TEST_CASE("raylab-image tells its version and how it is used", "[cli][image]") {
  const ProgramResult version = raylab_image({"--version"});
  CHECK(version.exit_code == 0);
  CHECK(version.out.rfind("raylab-image ", 0) == 0);
  CHECK(version.err.empty());
  const ProgramResult help = raylab_image({"--help"});
  CHECK(help.exit_code == 0);
  for (const char* command : {"compare", "convert", "info", "diff", "merge"}) {
    CHECK(help.out.find(command) != std::string::npos);
  }
  CHECK(raylab_image({"diff", "--help"}).out.find("--full-scale") != std::string::npos);
}

TEST_CASE("raylab-image compare prints the errors", "[cli][image]") {
  const Pictures folder;
  const ProgramResult text = raylab_image({"compare", folder.name("a.exr"), folder.name("b.exr")});
  CHECK(text.exit_code == 0);
  CHECK(text.err.empty());
  // MSE (0 + 1) / 2, relMSE 1 / 4.01 / 2, ratio 2 / 3, residuals 1 - 2/3 and 1 - 4/3.
  for (const char* part : {"relMSE            0.124688", "relMSE, trimmed   0.124688", "MSE               0.5\n",
                           "mean ratio        0.666667 ± 0.22\n", "differing pixels  1 of 2\n"}) {
    INFO(text.out);
    CHECK(text.out.find(part) != std::string::npos);
  }
  const ProgramResult json = raylab_image({"compare", "--json", folder.name("a.exr"), folder.name("b.exr")});
  CHECK(json.exit_code == 0);
  const auto row = nlohmann::json::parse(json.out);
  CHECK(row["relmse"].get<double>() == Approx(0.5 / 4.01));
  CHECK(row["relmse_trimmed"].get<double>() == Approx(0.5 / 4.01));
  CHECK(row["mse"].get<double>() == Approx(0.5));
  CHECK(row["mean_ratio"].get<double>() == Approx(2.0 / 3.0));
  CHECK(row["mean_ratio_error"].get<double>() == Approx(1.0 / 3.0 / 1.5));
  CHECK(row["different_pixels"] == 1);
  CHECK(row["pixels"] == 2);
}

TEST_CASE("raylab-image convert goes from EXR to PNG and back, with exposure", "[cli][image]") {
  const Pictures folder;
  const ProgramResult png = raylab_image({"convert", folder.name("b.exr"), folder.name("b.png"), "--exposure", "-2"});
  CHECK(png.err.empty());
  CHECK(png.exit_code == 0);
  CHECK(read_image8(folder / "b.png").rgb == std::vector<std::uint8_t>{137, 137, 137, 188, 188, 188});
  CHECK(raylab_image({"convert", folder.name("b.png"), folder.name("back.exr")}).exit_code == 0);
  CHECK(read_exr(folder / "back.exr").at(0, 0).g == Approx(0.25).epsilon(0.01));
  CHECK(read_exr(folder / "back.exr").at(1, 0).g == Approx(0.5).epsilon(0.01));
}

TEST_CASE("raylab-image convert keeps attributes and leaves layers out", "[cli][image]") {
  const Pictures folder;
  CHECK(raylab_image({"convert", folder.name("a.exr"), folder.name("c.exr"), "--exposure", "1"}).exit_code == 0);
  const ImageInfo info = read_image_info(folder / "c.exr");
  CHECK(info.attributes == Attributes{{"seed", "7"}});
  CHECK(info.channels.size() == 4);
  CHECK(read_exr(folder / "c.exr").at(0, 0) == Rgb(2.0f));
}

TEST_CASE("raylab-image convert writes floats where half would lose values", "[cli][image]") {
  const Pictures folder;
  const ProgramResult bright =
      raylab_image({"convert", folder.name("a.exr"), folder.name("c.exr"), "--exposure", "20"});
  CHECK(bright.exit_code == 0);
  CHECK(bright.err.find("c.exr holds floats") != std::string::npos);
  CHECK(read_exr(folder / "c.exr").at(0, 0) == Rgb(0x1p20f));
  const ProgramResult back = raylab_image({"convert", folder.name("c.exr"), folder.name("d.exr"), "--exposure", "-50"});
  CHECK(back.exit_code == 0);
  CHECK(read_exr(folder / "d.exr").at(0, 0) == Rgb(0x1p-30f));
}

TEST_CASE("raylab-image info describes a picture", "[cli][image]") {
  const Pictures folder;
  const ProgramResult info = raylab_image({"info", folder.name("a.exr")});
  CHECK(info.exit_code == 0);
  CHECK(info.out ==
        "size: 2 x 1\nchannels: A half, B half, G half, R half, Z float\nrange R: 1 to 1\nrange G: 1 to 1\n"
        "range B: 1 to 1\nseed: 7\n");
  Image odd(3, 1);
  odd.pixels = {Rgb(0.5f, 1.0f, NAN), Rgb(-1.0f, INFINITY, NAN), Rgb(4.0f, 3.0f, NAN)};
  write_exr(folder / "odd.exr", odd);
  const std::string text = raylab_image({"info", folder.name("odd.exr")}).out;
  CHECK(text.find("range R: -1 to 4\nrange G: 1 to 65504\nrange B: 3 not finite\n") != std::string::npos);
  write_png(folder / "a.png", Image(3, 2));
  CHECK(raylab_image({"info", folder.name("a.png")}).out ==
        "size: 3 x 2\nchannels: R 8-bit, G 8-bit, B 8-bit\nrange R: 0 to 0\nrange G: 0 to 0\nrange B: 0 to 0\n");
}

TEST_CASE("raylab-image diff shows where the error is", "[cli][image]") {
  const Pictures folder;
  // The second pixel's relative error is 1 / sqrt(4.01), a little below a half.
  const ProgramResult diff =
      raylab_image({"diff", folder.name("a.exr"), folder.name("b.exr"), "-o", folder.name("d.png")});
  CHECK(diff.err.empty());
  CHECK(diff.exit_code == 0);
  CHECK(read_image8(folder / "d.png").rgb == std::vector<std::uint8_t>{0, 0, 0, 255, 127, 0});
  CHECK(raylab_image({"diff", folder.name("a.exr"), folder.name("b.exr"), "--output", folder.name("d.png"),
                      "--full-scale", "0.1"})
            .exit_code == 0);
  CHECK(read_image8(folder / "d.png").rgb == std::vector<std::uint8_t>{0, 0, 0, 255, 255, 255});
}

TEST_CASE("raylab-image refuses a wrong command line with exit code 2", "[cli][image]") {
  const Pictures folder;
  const std::string a = folder.name("a.exr");
  expect_failure({}, 2, "a command is missing");
  expect_failure({"paint"}, 2, "");
  expect_failure({"compare", a}, 2, "REFERENCE");
  expect_failure({"compare", a, a, a}, 2, a);
  expect_failure({"convert", a, folder.name("b.png"), "--exposure", "much"}, 2, "much");
  expect_failure({"diff", a, a}, 2, "--output");
  expect_failure({"diff", a, a, "-o", folder.name("d.png"), "--full-scale", "0"}, 2, "--full-scale");
  expect_failure({"convert", a, folder.name("b.jpg")}, 2, "b.jpg: ");
  write_exr(folder / "large.exr", Image(4, 4));
  expect_failure({"compare", a, folder.name("large.exr")}, 2, "2 x 1");
}

TEST_CASE("raylab-image refuses bad input with exit code 3", "[cli][image]") {
  const Pictures folder;
  const std::string missing = folder.name("missing.exr");
  expect_failure({"compare", folder.name("a.exr"), missing}, 3, missing + ": cannot be read");
  expect_failure({"info", missing}, 3, missing + ": cannot be read");
  write_text(folder / "text.png", "hello");
  expect_failure({"convert", folder.name("text.png"), folder.name("c.exr")}, 3, folder.name("text.png") + ": ");
  CHECK_FALSE(fs::exists(folder / "c.exr"));
}

TEST_CASE("a command that is unknown or missing is told with those there are", "[cli]") {
  for (const char* program : {"/raylab-image", "/raylab-bench"}) {
    const ProgramResult unknown = run_program(std::string(RAYLAB_BINARY_DIR) + program, {"foo"});
    CHECK(unknown.exit_code == 2);
    CHECK(unknown.err.find("unknown command foo: the commands are ") != std::string::npos);
    const ProgramResult near = run_program(std::string(RAYLAB_BINARY_DIR) + program, {"compore"});
    CHECK(near.err.find("unknown command compore: the nearest command is compare") != std::string::npos);
    const ProgramResult missing = run_program(std::string(RAYLAB_BINARY_DIR) + program, {});
    CHECK(missing.exit_code == 2);
    CHECK(missing.err.find("a command is missing: the commands are ") != std::string::npos);
  }
}

TEST_CASE("raylab-image says with exit code 4 what it cannot write", "[cli][image]") {
  const Pictures folder;
  const std::string a = folder.name("a.exr");
  const std::string out = folder.name("missing/b.png");
  expect_failure({"convert", a, out}, 4, out + ": cannot be written: No such file");
  expect_failure({"diff", a, a, "-o", out}, 4, out + ": cannot be written: No such file");
  // Before anything is read.
  expect_failure({"convert", folder.name("missing.exr"), out}, 4, out + ": cannot be written");
  const FileSizeLimit limit(3);  // of standard output too
  CHECK(raylab_image({"info", a}).exit_code == 4);
  CHECK(raylab_image({"--version"}).exit_code == 4);
}
