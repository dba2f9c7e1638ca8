// Measurements that are interrupted and gone on with, as their user meets them.
#include <algorithm>
#include <random>
#include <set>

#include "bench_runs.hpp"
#include "catch.hpp"
#include "raylab/core/text.hpp"
#include "raylab/measure/results.hpp"
#include "temp_folder.hpp"

using namespace raylab;
using namespace raylab::test;
namespace fs = std::filesystem;

namespace {

const std::string kGlobe = RAYLAB_SOURCE_DIR "/scenes/globe.toml";

using Arguments = std::vector<std::string>;

Arguments with(Arguments arguments, const Arguments& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

/// Sent the signal after so many seconds, and waited for.
ProgramResult stopped_bench(const std::string& signal, double seconds, const Arguments& arguments) {
  const std::string stop = "\"$@\" & sleep " + std::to_string(seconds) + "; kill -" + signal + " $!; wait $!";
  return run_program("/bin/sh", with({"-c", stop, "sh", RAYLAB_BINARY_DIR "/raylab-bench"}, arguments));
}

std::vector<std::string> keys_of(const Results& results) {
  std::vector<std::string> keys;
  for (const Row& row : results.rows) keys.push_back(row_key(row));
  return keys;
}

/// The parts that a run in the folder has measured, by name.
std::set<std::string> parts_in(const fs::path& folder) {
  if (!fs::exists(folder / "results.json")) return {};
  return read_results(folder).runs.back().value("measured", std::set<std::string>());
}

/// Kills the command again and again, each time a little later, and goes on with it until its end. Returns how often.
int killed_until_end(const Arguments& arguments, const fs::path& folder, double seconds) {
  static std::mt19937 random(7);
  const Arguments resumed = with(arguments, {"--resume", "--out", folder.string()});
  int kills = 0;
  std::size_t parts = 0;
  for (double most = seconds;; most *= 1.2) {
    const double after = std::uniform_real_distribution(0.1 * most, most)(random);
    const ProgramResult result = stopped_bench(kills % 3 == 2 ? "TERM" : "KILL", after, resumed);
    INFO(result.err);
    if (result.exit_code == 0) return kills;
    // 143 where SIGTERM comes before the program minds it, or after.
    REQUIRE((result.exit_code == 137 || result.exit_code == 130 || result.exit_code == 143));
    ++kills;
    REQUIRE(parts_in(folder).size() >= parts);  // nothing is lost
    parts = parts_in(folder).size();
  }
}

/// The same, from the beginning and sooner where it had ended before it could be killed.
void kill_and_resume(const Arguments& arguments, const fs::path& folder) {
  double seconds = 0.3;
  while (killed_until_end(arguments, folder, seconds) == 0) {
    fs::remove_all(folder);
    seconds /= 2.0;
    REQUIRE(seconds > 1e-3);
  }
}

}  // namespace

TEST_CASE("raylab-bench that is killed and gone on with ends with the rows of a run that was not", "[cli][bench]") {
  const std::string few = "2";
  const std::vector<Arguments> commands{
      {"rays", kCornell, kGlobe, "--rays", "500", "--checked", "100", "--repeats", "1", "--accel", "bvh,embree"},
      {"ladder", kCornell, "--rays", "500", "--checked", "100", "--repeats", "1"},
      {"embree", kCornell, "--rays", "500", "--repeats", "1"},
      {"scale", "--family", "sphere,soup", "--largest", "1000", "--rays", "200", "--checked", "50", "--accel", "bvh"},
      {"render", kCornell, kGlobe, "--width", "16", "--spp", "1,2,4", "--repeats", "1", "--reference-spp", "8"},
      {"process", kCornell, kGlobe, "--width", "16", "--spp", "2", "--repeats", "2", "--accel", "bvh,embree"},
      {"threads", kCornell, kGlobe, "--width", "16", "--spp", "2", "--repeats", "2", "--threads", "2"},
      {"profile", kCornell, kGlobe, "--width", "16", "--spp", "2", "--repeats", "1", "--accel", "bvh,embree"},
      {"stability", "--case", "small-triangle,20,5,7", "--accel", "list,bvh", "--rays", "200"}};
  for (const Arguments& command : commands) {
    INFO(command.front());
    const TempFolder folder;
    REQUIRE(raylab_bench(with(command, {"--out", (folder / "whole").string()})).exit_code == 0);
    kill_and_resume(command, folder / "parts");
    const Results whole = read_results(folder / "whole"), resumed = read_results(folder / "parts");
    CHECK(keys_of(resumed) == keys_of(whole));
    CHECK(to_csv(resumed.rows) == read_text(folder / "parts/results.csv"));
    REQUIRE(resumed.runs.size() == 1);
    CHECK(resumed.runs[0]["complete"] == true);
    for (const char* field : {"measured", "under_way"}) CHECK_FALSE(resumed.runs[0].contains(field));
    CHECK(resumed.runs[0]["command"].get<std::string>().find("--resume") == std::string::npos);
  }
}

TEST_CASE("raylab-bench needs that is gone on with leaves no row of what it had begun", "[cli][bench]") {
  const TempFolder folder;
  kill_and_resume({"needs", kCornell, kGlobe, "--width", "12", "--spp", "4", "--repeats", "2", "--reference-spp", "64",
                   "--accel", "bvh", "--intersector", "watertight", "--target-error", "2"},
                  folder.path());
  // Which strategy wins depends on the times, and with it the keys: but each scene has one, of which all its rows are.
  for (const char* scene : {"cornell", "globe"}) {
    std::map<std::string, int> count;
    std::set<std::string> chosen;
    for (const Row& row : read_results(folder.path()).rows) {
      if (row["scene"] != scene) continue;
      const std::string question = row["question"];
      ++count[question];
      if (question == "accelerator" || question == "cheapest") {
        chosen.insert(row["integrator"].get<std::string>() + " " + row["sampler"].get<std::string>() + " " +
                      row["max_depth"].dump() + row.value("needs", ""));
      }
    }
    INFO(scene);
    CHECK(chosen.size() == 1);
    for (const char* question : {"uses", "accelerator", "cheapest"}) CHECK(count[question] == 1);
  }
}

TEST_CASE("raylab-bench --resume measures nothing again that is measured, and judges it all the same", "[cli][bench]") {
  const TempFolder folder;
  Arguments arguments = with(quick_rays(folder.path()), {"--intersector", "book", "--fail-on", "wrong", "--resume"});
  const ProgramResult first = raylab_bench(arguments);
  CHECK(first.exit_code == 1);  // the book's test has wrong answers
  CHECK(first.err.find("has no such run to go on with, so all is measured") != std::string::npos);
  const Results before = read_results(folder.path());
  // In another order it is the same command.
  std::swap(arguments[2], arguments[4]);
  std::swap(arguments[3], arguments[5]);
  const ProgramResult again = raylab_bench(arguments);
  CHECK(again.exit_code == 1);
  CHECK(again.out.find("Mrays/s") == std::string::npos);
  CHECK(again.err.find("goes on with the run that began at 20") != std::string::npos);
  const Results after = read_results(folder.path());
  CHECK(after.rows == before.rows);
  CHECK(after.runs == before.runs);
  // Without it all is measured anew.
  arguments.pop_back();
  CHECK(raylab_bench(arguments).exit_code == 1);
  CHECK(read_results(folder.path()).rows != before.rows);
}

TEST_CASE("raylab-bench render --resume measures no scene again that is finished", "[cli][bench]") {
  const TempFolder folder;
  const Arguments render{"render",
                         kCornell,
                         kGlobe,
                         "--accel",
                         "list",
                         "--width",
                         "16",
                         "--spp",
                         "1,2",
                         "--reference-spp",
                         "4",
                         "--out",
                         folder.path().string()};
  // Killed as soon as the first scene is noted as measured.
  const std::string stop = "\"$@\" & until grep -qs measured " + (folder / "results.json").string() +
                           " || ! kill -0 $!; do sleep 0.01; done; kill -KILL $!; wait $!";
  const ProgramResult first =
      run_program("/bin/sh", with({"-c", stop, "sh", RAYLAB_BINARY_DIR "/raylab-bench"}, render));
  INFO(first.out << first.err);
  const std::vector<Row> cornell = rows_where(read_results(folder.path()), "scene", "cornell");
  REQUIRE(rows_where(read_results(folder.path()), "question", "time to error").size() == 1);
  const ProgramResult again = raylab_bench(with(render, {"--resume"}));
  INFO(again.out << again.err);
  CHECK(again.exit_code == 0);
  CHECK(again.out.find("cornell ") == std::string::npos);
  CHECK(again.out.find("globe ") != std::string::npos);
  CHECK(rows_where(read_results(folder.path()), "scene", "cornell") == cornell);
  CHECK(rows_where(read_results(folder.path()), "question", "time to error").size() == 2);
}

TEST_CASE("raylab-bench --resume refuses a run of another command, version or scene, naming the difference",
          "[cli][bench]") {
  const TempFolder folder;
  const std::string scene = (folder / "scene.toml").string(), out = (folder / "out").string();
  const auto write_scene = [&](const std::string& radius) {
    write_text(scene, "[material.a]\ntype = \"lambertian\"\n[[sphere]]\ncenter = [0, 0, -1]\nradius = " + radius +
                          "\nmaterial = \"a\"\n");
  };
  write_scene("0.5");
  const auto command = [&](const std::string& rays) {
    return Arguments{"rays",      scene, "--rays",  rays,   "--checked", "10",
                     "--repeats", "1",   "--accel", "list", "--out",     out};
  };
  REQUIRE(raylab_bench(command("500")).exit_code == 0);
  // As if it had been interrupted.
  const fs::path file = out + "/results.json";
  const std::string complete = read_text(file);
  const auto write_as = [&](const std::string& old, const std::string& text) {
    std::string changed = complete;
    const std::size_t at = changed.find(old);
    REQUIRE(at != std::string::npos);
    write_text(file, changed.replace(at, old.size(), text));
  };
  write_as("\"complete\":true", "\"complete\":false");
  expect_failure(with(command("600"), {"--resume"}), 2,
                 out + ": --resume cannot go on with the run there: --rays is 500 there and 600 here");
  write_as("\"complete\":true,\"raylab\":\"", "\"complete\":false,\"raylab\":\"0.0.");
  expect_failure(with(command("500"), {"--resume"}), 2, "version is 0.0.");
  write_as("", "");
  write_scene("0.25");
  expect_failure(with(command("500"), {"--resume"}), 3,
                 scene + ": --resume cannot go on with the run: the scene's hash");
  CHECK(read_text(file) == complete);
}
