// Renders that are stopped, gone on with, cut into parts and merged, as their user meets them: to the bits of one.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "raylab/image/film_file.hpp"
#include "raylab/image/metrics.hpp"
#include "small_scene.hpp"

using namespace raylab;
using namespace raylab::test;
namespace fs = std::filesystem;

namespace {

ProgramResult raylab_image(const std::vector<std::string>& arguments) {
  return run_program(RAYLAB_BINARY_DIR "/raylab-image", arguments);
}

Film read_film(const fs::path& file) {
  FilmFile opened(file);
  Film film(opened.width(), opened.height());
  opened.add_to(film);
  return film;
}

/// Renders the small scene; it must end with this exit code. Killed by the signal after so many seconds, if any.
ProgramResult render(const SmallScene& small, std::vector<std::string> arguments, const std::string& signal = "",
                     double seconds = 0.0) {
  arguments.insert(arguments.begin(), small.scene);
  if (signal.empty()) return raylab_render(arguments);
  arguments.insert(arguments.begin(), {"--preserve-status", "-s", signal, std::to_string(seconds), kProgram});
  return run_program("/usr/bin/timeout", arguments);
}

void expect_success(const ProgramResult& result) {
  INFO(result.err);
  CHECK(result.exit_code == 0);
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// Picture and sums.
void expect_same(const fs::path& a, const fs::path& b) {
  CHECK(read_film(a) == read_film(b));
  CHECK(read_exr(a).pixels == read_exr(b).pixels);
}

}  // namespace

TEST_CASE("two halves of a picture are merged to the bits of the whole", "[cli][film]") {
  const SmallScene small;
  const std::string whole = (small / "whole.exr").string(), merged = (small / "merged.exr").string();
  const std::string first = (small / "first.exr").string(), second = (small / "second.exr").string();
  expect_success(render(small, {"-o", whole, "--spp", "21", "--film", "--layers", "variance,samples"}));
  expect_success(render(small, {"-o", first, "--samples", "0:5", "--spp", "21"}));
  expect_success(render(small, {"-o", second, "--samples", "5:21", "--threads", "1", "--tile-size", "3"}));
  const ProgramResult result = raylab_image({"merge", second, first, "-o", merged, "--layers", "variance,samples"});
  expect_success(result);
  CHECK(result.err.empty());
  CHECK(contains(result.out, "merged 2 parts of 16 x 8 pixels, 21 samples a pixel"));
  expect_same(merged, whole);
  const FilmFile film(merged), one(whole);
  CHECK(film.info().ranges == one.info().ranges);
  CHECK(film.info().settings == one.info().settings);
  CHECK(film.attributes().at("raylab.partial") == "false");
  CHECK(read_image_info(merged).channels == read_image_info(whole).channels);
  // A film can be written as a picture of another kind, and merged again.
  expect_success(raylab_image({"merge", merged, "-o", (small / "merged.png").string()}));
  CHECK(read_image8(small / "merged.png").width == 16);
  expect_success(raylab_image({"merge", merged, "-o", (small / "again.exr").string()}));
  expect_same(small / "again.exr", whole);
}

TEST_CASE("a picture is cut anywhere into parts, jobs are killed and restarted, and no bit changes", "[cli][film]") {
  const SmallScene small;
  const std::string whole = (small / "whole.exr").string(), merged = (small / "merged.exr").string();
  constexpr int kSamples = 600000;
  expect_success(render(small, {"-o", whole, "--spp", std::to_string(kSamples), "--film"}));
  std::mt19937 random(12);
  std::vector<int> cuts{0, kSamples};
  while (cuts.size() < 25) cuts.push_back(1 + static_cast<int>(random() % (kSamples - 1)));
  std::sort(cuts.begin(), cuts.end());
  cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
  std::vector<std::string> parts;
  int killed = 0;
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    parts.push_back((small / ("part-" + std::to_string(i) + ".exr")).string());
    const std::vector<std::string> arguments = {"-o",
                                                parts.back(),
                                                "--samples",
                                                std::to_string(cuts[i]) + ":" + std::to_string(cuts[i + 1]),
                                                "--spp",
                                                std::to_string(kSamples),
                                                "--resume",
                                                "--checkpoint-every",
                                                "0.01s",
                                                "--threads",
                                                std::to_string(1 + random() % 3)};
    if (i % 5 == 0) {
      killed += render(small, arguments, "KILL", 0.01 + 0.001 * static_cast<double>(random() % 20)).exit_code == 137;
    }
    expect_success(render(small, arguments));
  }
  CHECK(killed > 0);
  std::shuffle(parts.begin(), parts.end(), random);
  std::vector<std::string> arguments{"merge"};
  arguments.insert(arguments.end(), parts.begin(), parts.end());
  arguments.insert(arguments.end(), {"-o", merged});
  const ProgramResult result = raylab_image(arguments);
  expect_success(result);
  CHECK(result.err.empty());
  expect_same(merged, whole);
}

// As many parts as RAYLAB_PARTS says, such as 1000, a hundred by default.
TEST_CASE("a hundred parts, a fifth killed at random instants and restarted, are merged to the bits of one render",
          "[cli][film][parts]") {
  const SmallScene small;
  const char* const asked = std::getenv("RAYLAB_PARTS");
  const int count = asked ? std::atoi(asked) : 100;
  const std::string whole = (small / "whole.exr").string(), merged = (small / "merged.exr").string();
  const std::string wanted = std::to_string(count);
  expect_success(render(small, {"-o", whole, "--width", "8", "--spp", wanted, "--film"}));
  std::vector<std::string> parts;
  for (int i = 0; i < count; ++i) parts.push_back((small / ("part-" + std::to_string(i) + ".exr")).string());
  std::atomic<int> next{0}, killed{0}, failed{0};
  const auto work = [&](unsigned seed) {
    std::mt19937 random(seed);
    for (int i; (i = next++) < count;) {
      const std::vector<std::string> arguments{"-o",        parts[i],
                                               "--width",   "8",
                                               "--spp",     wanted,
                                               "--samples", std::to_string(i) + ":" + std::to_string(i + 1),
                                               "--resume",  "--checkpoint-every",
                                               "0.001s",    "--threads",
                                               "1"};
      // From before it has begun to after its end.
      if (i % 5 == 0) killed += render(small, arguments, "KILL", 1e-4 * (1 + random() % 200)).exit_code == 137;
      failed += render(small, arguments).exit_code != 0;
    }
  };
  std::vector<std::thread> workers;
  for (unsigned seed = 0; seed < 4; ++seed) workers.emplace_back(work, seed);
  for (std::thread& worker : workers) worker.join();
  CHECK(failed == 0);
  CHECK(killed > count / 20);
  std::shuffle(parts.begin(), parts.end(), std::mt19937(1));
  std::vector<std::string> arguments{"merge", "-o", merged};
  arguments.insert(arguments.end(), parts.begin(), parts.end());
  const ProgramResult result = raylab_image(arguments);
  expect_success(result);
  CHECK(result.err.empty());
  expect_same(merged, whole);
}

TEST_CASE("a render that is stopped or killed is gone on with to the same bits", "[cli][film]") {
  const SmallScene small;
  const std::string whole = (small / "whole.exr").string(), output = (small / "out.exr").string();
  const std::vector<std::string> common = {"--spp", "150000", "--film", "--progress", "none"};
  const auto with = [&](const std::string& file, std::vector<std::string> more) {
    more.insert(more.end(), common.begin(), common.end());
    more.insert(more.end(), {"-o", file});
    return more;
  };
  expect_success(render(small, with(whole, {})));
  const std::string checkpoint = output + ".checkpoint.exr";
  for (const std::string signal : {"TERM", "KILL", "HUP", "INT"}) {
    fs::remove(output);
    int resumed = 0, runs = 0;
    for (double seconds = 0.15;; seconds *= 1.3) {
      const ProgramResult result =
          render(small, with(output, {"--resume", "--checkpoint-every", "0.02s"}), signal, seconds);
      INFO(signal << ": " << result.err);
      ++runs;
      resumed += contains(result.out, "resumed    " + checkpoint + " with");
      if (result.exit_code == 0) break;
      CHECK(result.exit_code == (signal == "KILL" ? 137 : 130));
      if (signal != "KILL") {
        CHECK(fs::exists(checkpoint));
        CHECK(contains(result.out, "checkpoint " + checkpoint));
        CHECK(read_exr_attributes(output).at("raylab.partial") == "true");
      }
    }
    CHECK(runs > 1);
    CHECK(resumed > 0);
    CHECK_FALSE(fs::exists(checkpoint));
    CHECK(read_exr_attributes(output).at("raylab.partial") == "false");
    expect_same(output, whole);
  }
}

TEST_CASE("a render writes the picture so far, and says how far it is when it is asked", "[cli][film]") {
  const SmallScene small;
  const std::string output = (small / "out.exr").string();
  // Killed, so that what is there was written on the way; asked by the shell that started it.
  const ProgramResult result = run_program(
      "/bin/sh", {"-c", "\"$0\" \"$@\" & sleep 0.5; kill -USR1 $!; sleep 0.2; kill -KILL $!; wait $!", kProgram,
                  small.scene, "-o", output, "--spp", "1000000000", "--write-every", "0.05s", "--progress", "none"});
  CHECK(result.exit_code == 137);
  CHECK(contains(result.err, "% after "));
  CHECK(contains(result.err, " s left\n"));
  CHECK(read_exr(output).at(0, 0) == Rgb(1.0f));
  CHECK(read_exr_attributes(output).at("raylab.partial") == "true");
}

TEST_CASE("what there is not to resume is said, and a checkpoint that is not gone on from too", "[cli][film]") {
  const SmallScene small;
  const std::string output = (small / "out.png").string(), checkpoint = output + ".checkpoint.exr";
  const ProgramResult nothing = render(small, {"-o", output, "--resume"});
  expect_success(nothing);
  CHECK(contains(nothing.out, "resumed    nothing: there is no " + checkpoint));
  CHECK(render(small, {"-o", output, "--spp", "100000000"}, "TERM", 0.5).exit_code == 130);
  CHECK(fs::exists(checkpoint));
  const ProgramResult anew = render(small, {"-o", output});
  expect_success(anew);
  CHECK(contains(anew.err, checkpoint + " is left of an earlier render"));
  CHECK_FALSE(fs::exists(checkpoint));
}

TEST_CASE("a film is brought to more samples by --resume", "[cli][film]") {
  const SmallScene small;
  const std::string output = (small / "out.exr").string(), whole = (small / "whole.exr").string();
  expect_success(render(small, {"-o", output, "--spp", "5", "--film"}));
  const std::string png = (small / "out.png").string();
  const ProgramResult more = render(small, {"-o", png, "-o", output, "--spp", "12", "--film", "--resume"});
  expect_success(more);
  CHECK(contains(more.out, "resumed    " + output + " with 5 to 5 of 12 samples a pixel"));
  expect_success(render(small, {"-o", whole, "--spp", "12", "--film"}));
  expect_same(output, whole);
  const ProgramResult fewer = render(small, {"-o", output, "--spp", "4", "--film", "--resume"});
  CHECK(fewer.exit_code == 3);
  CHECK(contains(fewer.err, "it has 12 samples of a pixel, and 4 are asked for"));
}

TEST_CASE("a film of another picture is refused, resumed or merged, with what differs", "[cli][film]") {
  SmallScene small;
  const std::string output = (small / "out.exr").string();
  const auto refused = [&](std::vector<std::string> arguments, const std::string& part) {
    const std::string other = (small / "other.exr").string();
    std::vector<std::string> resume = arguments;
    resume.insert(resume.end(), {"-o", output, "--film", "--spp", "8", "--resume"});
    const ProgramResult resumed = render(small, resume);
    INFO(part << " in " << resumed.err);
    CHECK(resumed.exit_code == 3);
    CHECK(contains(resumed.err, output + ": --resume cannot go on from it: it is of another picture: " + part));
    arguments.insert(arguments.end(), {"-o", other, "--samples", "4:8"});
    expect_success(render(small, arguments));
    const ProgramResult merged = raylab_image({"merge", output, other, "-o", (small / "m.exr").string()});
    INFO(merged.err);
    CHECK(merged.exit_code == 3);
    CHECK(contains(merged.err, other + ": cannot be merged with the others: "));
    CHECK(contains(merged.err, part.substr(0, part.find(" is "))));
    CHECK(contains(merged.err, output));
    CHECK_FALSE(fs::exists(small / "m.exr"));
  };
  expect_success(render(small, {"-o", output, "--film", "--spp", "4"}));
  refused({"--seed", "7"}, "seed is 0 there and 7 here");
  refused({"--width", "8"}, "crop is 0,0,16,8 there and 0,0,8,4 here; size is 16x8 there and 8x4 here");
  refused({"--crop", "1,2,3,4"}, "crop is 0,0,16,8 there and 1,2,3,4 here");
  refused({"--sampler", "independent"}, "sampler is sobol there and independent here");
  refused({"--integrator", "book"}, "integrator is path there and book here");
  refused({"--max-depth", "3"}, "max-depth is 5 there and 3 here");
  refused({"--ray-offset", "book"}, "ray-offset is bounds there and book here");
  refused({"--accel", "list"}, "accel is bvh there and list here");
  refused({"--accel", "embree"}, "accel is bvh there and embree, ");  // and its instruction set, on which bits depend
  refused({"--strategies", "bsdf,light"}, "strategies is auto there and bsdf,light here");
  refused({"--needs", "all"}, "needs is scene there and all here");
  refused({"--set", "material.grey.albedo=[1,0,0]"}, "scene is ");
  small.change("radius = 1", "radius = 1.1");
  refused({}, "scene is ");
}

TEST_CASE("overlaps and damage are refused when films are merged, and gaps are said", "[cli][film]") {
  const SmallScene small;
  const auto part = [&](const char* samples, std::vector<std::string> more = {}) {
    std::string file = (small / (std::string(samples) + ".exr")).string();
    more.insert(more.end(), {"-o", file, "--samples", samples});
    expect_success(render(small, more));
    return file;
  };
  const std::string a = part("0:4"), b = part("3:8"), c = part("8:16"), d = part("4:8", {"--spp", "20"});
  const std::string out = (small / "merged.exr").string();
  const ProgramResult overlap = raylab_image({"merge", c, b, a, "-o", out});
  CHECK(overlap.exit_code == 3);
  CHECK(contains(overlap.err, b + ": cannot be merged with the others: it has sample 3 that " + a + " has too"));
  CHECK(raylab_image({"merge", a, a, "-o", out}).exit_code == 3);
  CHECK_FALSE(fs::exists(out));

  const ProgramResult gaps = raylab_image({"merge", c, a, "-o", out});
  CHECK(gaps.exit_code == 0);
  CHECK(contains(gaps.err, "samples 4 to 7 of 16 are in no part"));
  CHECK(read_film(out).samples(3, 3) == 12);
  CHECK(FilmFile(out).info().ranges == std::vector<SampleRange>{{0, 4}, {8, 16}});
  CHECK(FilmFile(out).attributes().at("raylab.partial") == "true");
  // The part that was missing comes later.
  const std::string all = (small / "all.exr").string(), whole = (small / "whole.exr").string();
  const ProgramResult end = raylab_image({"merge", out, d, "-o", all});
  CHECK(end.exit_code == 0);
  CHECK(contains(end.err, "samples 16 to 19 of 20 are in no part"));
  expect_success(render(small, {"-o", whole, "--film", "--spp", "16"}));
  expect_same(all, whole);

  std::string bytes = read_text(a);
  bytes[bytes.size() - 5] ^= 1;
  write_text(a, bytes);
  const ProgramResult damaged = raylab_image({"merge", a, c, "-o", out});
  CHECK(damaged.exit_code == 3);
  CHECK(contains(damaged.err, a + ": its film is damaged at pixel 14, 7"));
  const ProgramResult described = raylab_image({"info", a});
  CHECK(described.exit_code == 3);
  CHECK(contains(described.out, "film: samples 0:4 of 4"));
  CHECK(described.err ==
        "raylab-image: " + a + ": its film is damaged in 1 rows of 8, at 1 pixels: row 7: 1 from x = 14\n");
  CHECK(contains(raylab_image({"info", c}).out, "film sums: whole\n"));
  const ProgramResult picture = raylab_image({"merge", c, (small / "none.exr").string(), "-o", out});
  CHECK(picture.exit_code == 3);
}

TEST_CASE("a part that was interrupted is merged with a warning, and what follows it is not mistaken", "[cli][film]") {
  const SmallScene small;
  const std::string a = (small / "a.exr").string(), b = (small / "b.exr").string(), out = (small / "m.exr").string();
  CHECK(render(small, {"-o", a, "--samples", "0:10000000"}, "TERM", 0.5).exit_code == 130);
  expect_success(render(small, {"-o", b, "--samples", "10000000:10000004"}));
  const ProgramResult result = raylab_image({"merge", b, a, "-o", out});
  CHECK(result.exit_code == 0);
  CHECK(contains(result.err, a + " is not whole: pixels have "));
  CHECK(FilmFile(out).info().ranges.size() == 2);
  const ProgramResult resumed = render(small, {"-o", out, "--film", "--spp", "10000008", "--resume"});
  CHECK(resumed.exit_code == 3);
  CHECK(contains(resumed.err, "merged of parts of which some are missing or not whole"));
}

TEST_CASE("a render stops at a time or an error, and says what was reached", "[cli][film]") {
  const SmallScene small;
  const std::string output = (small / "out.exr").string(), stats = (small / "s.json").string();
  const auto stop = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"-o", output, "--stats", stats});
    const ProgramResult result = render(small, arguments);
    expect_success(result);
    const Attributes attributes = read_exr_attributes(output);
    const auto json = nlohmann::json::parse(read_text(stats));
    CHECK(attributes.at("raylab.stoppedBy") == json.at("stopped_by").get<std::string>());
    CHECK(attributes.at("raylab.partial") == "false");
    CHECK(json.at("partial") == false);
    return std::pair(result.out, json);
  };
  const auto [time_text, time] = stop({"--spp", "1000000000", "--time-limit", "0.3s"});
  CHECK(contains(time_text, "stopped    by --time-limit with "));
  CHECK(time.at("stopped_by") == "--time-limit");
  CHECK(time.at("samples_taken").at("most") < 1000000000);
  const auto [error_text, error] = stop({"--spp", "100000", "--target-error", "1e-4"});
  CHECK(contains(error_text, "stopped    by --target-error with "));
  CHECK(error.at("estimated_relmse") <= 1e-4);
  CHECK(error.at("samples_taken").at("most") == error.at("samples_taken").at("fewest"));
  const auto [cap_text, cap] = stop({"--spp", "3", "--target-error", "1e-9", "--time-limit", "1h"});
  CHECK(cap.at("stopped_by") == "samples");
  CHECK_FALSE(contains(cap_text, "stopped"));
  small.expect_failure(2, {"--time-limit", "found \"soon\"", "30s, 10m or 1h"}, {"--time-limit", "soon"});
  small.expect_failure(2, {"--checkpoint-every", "found \"0s\""}, {"--checkpoint-every", "0s"});
  small.expect_failure(2, {"--target-error"}, {"--target-error", "-1"});
}

TEST_CASE("a picture that cannot be written at the end is kept, and the next run goes on from it", "[cli][film]") {
  const SmallScene small;
  const std::string folder = (small / "sub").string(), output = folder + "/out.exr",
                    kept = small.path().string() + "/tmp";
  fs::create_directory(folder);
  fs::create_directory(kept);
  // The folder goes away while it renders, as a disk that fills or a share that is unmounted does. Quietly too, it is
  // said what is not lost.
  const ProgramResult result = run_program(
      "/bin/sh", {"-c", "export TMPDIR=\"$0\"; \"$@\" & sleep 0.2; rm -r \"" + folder + "\"; wait $!", kept, kProgram,
                  small.scene, "-o", output, "--spp", "1000000000", "--time-limit", "0.5s", "-q"});
  CHECK(result.exit_code == 4);
  const std::string checkpoint = kept + "/out.exr.checkpoint.exr";
  CHECK(contains(result.err, "the render is kept in " + checkpoint));
  fs::create_directory(folder);
  fs::copy(checkpoint, output + ".checkpoint.exr");
  const ProgramResult resumed =
      render(small, {"-o", output, "--spp", "1000000000", "--resume", "--time-limit", "0.05s"});
  expect_success(resumed);
  CHECK(contains(resumed.out, "resumed    " + output + ".checkpoint.exr with"));
}

TEST_CASE("an interrupted render that is quiet says where it is kept, on standard error", "[cli][film]") {
  const SmallScene small;
  const std::string output = (small / "out.exr").string();
  const ProgramResult result = render(small, {"-o", output, "--spp", "1000000000", "-q"}, "INT", 0.3);
  CHECK(result.exit_code == 130);
  CHECK(result.out.empty());
  CHECK(contains(result.err, "the render is kept in " + output + ".checkpoint.exr: --resume goes on from it\n"));
}

TEST_CASE("other names of a file that is replaced keep what they have, which is said", "[cli][film]") {
  const SmallScene small;
  const fs::path output = small / "a.png", other = small / "other.png";
  write_text(output, "old");
  fs::create_hard_link(output, other);
  const std::string warning = output.string() + " has other names, hard links, which keep what they have";
  const ProgramResult first = render(small, {"-o", output.string()});
  expect_success(first);
  CHECK(contains(first.err, "raylab-render: warning: " + warning));
  CHECK(read_text(other) == "old");
  CHECK(read_image8(output).width == 16);
  CHECK(render(small, {"-o", output.string()}).err.empty());  // it is a file of one name now
  fs::remove(other);
  fs::create_hard_link(output, other);
  const ProgramResult second = raylab_image({"convert", other.string(), output.string()});
  expect_success(second);
  CHECK(second.err == "raylab-image: warning: " + warning + "\n");
}

TEST_CASE("ranges of samples that make no part are refused, and the option that was", "[cli][film]") {
  const SmallScene small;
  for (const char* samples : {"5", "5:5", "6:5", ":5", "5:", "-1:5", "0:4294967296", "0:5x"}) {
    small.expect_failure(2, {"--samples", "A:B"}, {std::string("--samples=") + samples});
  }
  small.expect_failure(2, {"--samples", "0:9 goes beyond the 8 samples of --spp"}, {"--samples", "0:9", "--spp", "8"});
  small.expect_failure(2, {"--first-sample", "--samples A:B"}, {"--first-sample", "4"});
  const ProgramResult png = render(small, {"-o", (small / "a.png").string(), "--samples", "0:4"});
  CHECK(png.exit_code == 2);
  CHECK(contains(png.err, "--samples: a part of a picture is kept in an EXR file"));
  CHECK(contains(render(small, {"-o", (small / "a.png").string(), "--film"}).err, "--film: nothing is written of it"));
}

TEST_CASE("a picture that half cannot hold is written in float, which is said once", "[cli][film]") {
  SmallScene small;
  small.change("color = [1, 1, 1]", "color = [1e5, 1, 1]");
  const std::string output = (small / "out.exr").string();
  const ProgramResult chosen = render(small, {"-o", output});
  expect_success(chosen);
  CHECK(contains(chosen.err, "holds floats, as half would lose"));
  CHECK(read_exr(output).at(0, 0).r == 1e5f);
  const ProgramResult half = render(small, {"-o", output, "--exr", "half"});
  CHECK(half.err.empty());
  CHECK(read_exr(output).at(0, 0).r == 65504.0f);
  small.change("color = [1, 1, 1]", "color = [0.1, 1, 1]");
  CHECK(render(small, {"-o", output}).err.empty());
  CHECK(read_image_info(output).channels.front() == "A half");
  CHECK(render(small, {"-o", output, "--exr", "float"}).err.empty());
  CHECK(read_exr(output).at(0, 0).r == 0.1f);
  small.expect_failure(2, {"--exr"}, {"--exr", "double"});
}
