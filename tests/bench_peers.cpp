// Other renderers in raylab-bench render, as programs that answer in their place.
#include <signal.h>

#include <algorithm>
#include <fstream>

#include "bench_runs.hpp"
#include "catch.hpp"
#include "raylab/image/image_file.hpp"
#include "temp_folder.hpp"

using namespace raylab;
using namespace raylab::test;
namespace fs = std::filesystem;

namespace {

/// A program that is to be taken for a Python: it does as `answers` says in place of Mitsuba's or LuxCore's command,
/// once the scene is built, over and over; no other peer is there.
fs::path fake_peer(const TempFolder& folder, const std::string& answers) {
  const fs::path python = folder / "python";
  for (const int seed : {1, 2, 3}) {
    Image image(400, 400);
    std::fill(image.pixels.begin(), image.pixels.end(), Rgb(static_cast<float>(seed * seed)));
    write_exr(folder / (std::to_string(seed) + ".exr"), image);
  }
  std::ofstream(python) << R"(#!/bin/sh
case $1 in */mitsuba_render.py) name=mitsuba ;; */luxcore_render.py) name=luxcore ;; *) exit 1 ;; esac
[ "$2" = --probe ] && exit 0
output() { path=${1#*'"output":"'}; echo "${path%%'"'*}"; }
echo '{"version": "3", "variant": "fast", "settings": {"sampler": "good", "depth": 5}, "differences": ["none"]}'
while :; do
)" << answers << "\ndone\n";
  fs::permissions(python, fs::perms::owner_all);
  return python;
}

}  // namespace

TEST_CASE("raylab-bench render takes from a peer what is measured long enough, and in pictures wide enough",
          "[cli][bench]") {
  const TempFolder folder;
  // For 8 samples more than a second.
  const fs::path python = fake_peer(folder, R"sh(
read asked || exit
seconds=0.5
case $asked in *'"spp":8'*) seconds=2.5 ;; esac
case $asked in *'"seed":'[2345],*) ;; *) exit 1 ;; esac
cp "${0%/*}/1.exr" "$(output "$asked")"
echo '{"seconds": '$seconds', "cpu_seconds": 4, "spp": 9, "start_up_seconds": 3, "waited_seconds": 10,' \
     '"waited_cpu_seconds": 0.5}'
)sh");
  std::vector<std::string> arguments{
      "render", kCornell, "--accel", "bvh",   "--spp",   "1,8",           "--repeats",     "2",      "--reference-spp",
      "2",      "--seed", "1",       "--out", "results", "--peer-python", python.string(), "--width"};
  arguments[13] = (folder / "results").string();
  arguments.insert(arguments.begin() + 14, {"--peers", "mitsuba,cycles"});
  std::vector<std::string> narrow = arguments;
  narrow.push_back("399");
  arguments.push_back("400");
  CHECK(raylab_bench(narrow).err.find("no peers below a width of 400 pixels") != std::string::npos);
  CHECK(rows_where(read_results(folder / "results"), "peer", "mitsuba").empty());
  const ProgramResult run = raylab_bench(arguments);
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  CHECK(run.err.find("cycles left out") != std::string::npos);
  CHECK(run.err.find("mitsuba with 1 samples a pixel takes 0.50 s, less than 1: not taken") != std::string::npos);
  CHECK(run.err.find("mitsuba took 0.50 s of the processors in 10.0 s of waiting") != std::string::npos);
  const auto rows = rows_where(read_results(folder / "results"), "peer", "mitsuba");
  REQUIRE(rows.size() == 2);  // one point, and the time to an error
  const Row& row = rows[0].contains("question") ? rows[1] : rows[0];
  CHECK(row["renderer"] == "mitsuba 3 fast");
  CHECK(row["settings"] == Row{"depth = 5", "sampler = good"});
  CHECK(row["differences"] == Row{"none"});
  CHECK(row["spp"] == 9);
  CHECK(row["seconds"] == 2.5);
  CHECK(row["start_up_seconds"] == 3.0);
  CHECK(row["relmse_noise"] == 0.0);  // equal pictures
}

TEST_CASE("raylab-bench render takes turns with its peers, and leaves out the one that fails", "[cli][bench]") {
  const TempFolder folder;
  const fs::path python = fake_peer(folder, R"sh(
read asked || exit
seed=${asked#*'"seed":'}
echo "$name ${seed%%,*}" >> "${0%/*}/log"
echo "$TMPDIR" > "${0%/*}/temporary"
[ "$name ${seed%%,*}" != 'luxcore 3' ] || exit 7
cp "${0%/*}/${seed%%,*}.exr" "$(output "$asked")"
echo '{"seconds": 2, "cpu_seconds": 4, "spp": 8, "start_up_seconds": 3, "waited_seconds": 1, "waited_cpu_seconds": 0}'
)sh");
  const ProgramResult run =
      raylab_bench({"render", kCornell, "--accel", "bvh,list", "--spp", "2", "--repeats", "3", "--reference-spp", "2",
                    "--width", "400", "--out", (folder / "results").string(), "--peer-python", python.string()});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  CHECK(read_text(folder / "log") == "mitsuba 1\nluxcore 1\nluxcore 2\nmitsuba 2\nmitsuba 3\nluxcore 3\n");
  CHECK(run.err.find("left out: luxcore: ended with exit code 7 (see above)") != std::string::npos);
  const std::string temporary = read_text(folder / "temporary");
  CHECK(temporary.find("/raylab-bench-") != std::string::npos);
  CHECK_FALSE(fs::exists(temporary.substr(0, temporary.find('\n'))));
  const Results results = read_results(folder / "results");
  CHECK(rows_where(results, "peer", "luxcore").empty());  // a point is whole or not there
  CHECK(rows_where(results, "peer", "mitsuba").size() == 2);
  const auto targets = rows_where(results, "question", "time to error");
  REQUIRE(targets.size() == 3);
  CHECK_FALSE(targets[0].contains("time_ratio"));
  for (const Row& target : {targets[1], targets[2]}) {
    CHECK(target["against"] == "bvh");
    CHECK(target["runs"] == 3);
    CHECK(target["time_ratio"]["low"] <= target["time_ratio"]["mean"]);
    CHECK(target["time_ratio"]["mean"] <= target["time_ratio"]["high"]);
  }
  // What a picture's own samples say of its error is beside the truth, for ours alone.
  for (const Row& row : rows_where(results, "spp", 2)) {
    if (row.contains("question")) continue;
    CHECK(row["estimated_relmse"].get<double>() > 0.0);
    CHECK(row["estimated_relmse_95"]["low"] <= row["estimated_relmse"]);
    CHECK(row["estimated_relmse"] <= row["estimated_relmse_95"]["high"]);
    CHECK(row.contains("estimated_relmse_reliable"));
  }
}

TEST_CASE("raylab-bench render leaves out a peer that does not answer", "[cli][bench]") {
  const TempFolder folder;
  const fs::path python = fake_peer(folder, R"(
read asked || exit
sleep 20
echo > "${0%/*}/lived-on")");
  const ProgramResult run = raylab_bench({"render", kCornell, "--accel", "bvh", "--spp", "1", "--reference-spp", "2",
                                          "--width", "400", "--out", (folder / "results").string(), "--peers",
                                          "mitsuba", "--peer-minutes", "0.02", "--peer-python", python.string()});
  INFO(run.err);
  CHECK(run.exit_code == 0);
  CHECK(run.err.find("left out: mitsuba: has not answered for 0.02 minutes (--peer-minutes)") != std::string::npos);
  CHECK_FALSE(fs::exists(folder / "lived-on"));
  CHECK(rows_where(read_results(folder / "results"), "peer", "mitsuba").empty());
}

TEST_CASE("an interrupted raylab-bench ends its peers", "[cli][bench]") {
  const TempFolder folder;
  const fs::path python = fake_peer(folder, R"(
read asked || exit
echo $$ > "${0%/*}/process.part" && mv "${0%/*}/process.part" "${0%/*}/process"
sleep 20
echo > "${0%/*}/lived-on")");
  const std::string wait_then_stop =
      R"("$@" & p=$!; until [ -s "$0" ] || ! kill -0 $p; do sleep 0.02; done; kill -TERM $p; wait $p)";
  const ProgramResult run = run_program("/bin/sh", {"-c",
                                                    wait_then_stop,
                                                    (folder / "process").string(),
                                                    RAYLAB_BINARY_DIR "/raylab-bench",
                                                    "render",
                                                    kCornell,
                                                    "--accel",
                                                    "bvh",
                                                    "--spp",
                                                    "1",
                                                    "--reference-spp",
                                                    "2",
                                                    "--width",
                                                    "400",
                                                    "--out",
                                                    (folder / "results").string(),
                                                    "--peers",
                                                    "mitsuba",
                                                    "--peer-python",
                                                    python.string()});
  INFO(run.err);
  CHECK(run.exit_code == 130);
  CHECK(kill(std::stoi(read_text(folder / "process")), 0) != 0);
  CHECK_FALSE(fs::exists(folder / "lived-on"));
}
