#include <algorithm>
#include <map>

#include "bench_runs.hpp"
#include "catch.hpp"
#include "raylab/image/image_file.hpp"
#include "raylab/measure/results.hpp"
#include "temp_folder.hpp"

using namespace raylab;
using namespace raylab::test;
namespace fs = std::filesystem;

TEST_CASE("raylab-bench rays measures every accelerator and triangle test, and checks each", "[cli][bench]") {
  const TempFolder folder;
  const ProgramResult run = raylab_bench(quick_rays(folder.path()));
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  const Results results = read_results(folder.path());
  // Eleven accelerators with triangle tests, five kinds of rays.
  CHECK(results.rows.size() == 55);
  for (const Row& row : results.rows) {
    INFO(row.dump());
    for (const char* field :
         {"suite", "scene", "accel", "rays", "threads", "triangles", "build_seconds", "bytes", "mrays_per_second",
          "rays_checked", "leaks", "false_misses", "false_hits", "wrong_primitives", "wrong", "t_error_ulp"}) {
      CHECK(row.contains(field));
    }
    CHECK(row["rays_checked"] == 100);
    CHECK(row["mrays_per_second"]["median"].get<double>() > 0.0);
  }
  CHECK(rows_where(results, "rays", "shadow").size() == 11);
  CHECK(rows_where(results, "intersector", "book").size() == 15);
  const std::string csv = read_text(folder / "results.csv");
  CHECK(std::count(csv.begin(), csv.end(), '\n') == 56);
  CHECK(std::count(run.out.begin(), run.out.end(), '\n') == 55);
  CHECK(results.runs[0]["complete"] == true);
}

TEST_CASE("raylab-bench rays gives the build qualities to those that have a choice, and records them", "[cli][bench]") {
  const TempFolder folder;
  std::vector<std::string> arguments = quick_rays(folder.path());
  arguments.insert(arguments.end(), {"--accel", "list,bvh,embree", "--intersector", "watertight", "--quality",
                                     "fast,best", "--compact"});
  const ProgramResult run = raylab_bench(arguments);
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  const Results results = read_results(folder.path());
  CHECK(results.rows.size() == 25);
  CHECK(rows_where(results, "quality", "fast").size() == 10);
  CHECK(rows_where(results, "quality", "best").size() == 10);
  for (const Row& row : results.rows) {
    CHECK(row.contains("quality") == (row["accel"] != "list"));
    CHECK(row.contains("compact") == (row["accel"] == "embree"));
  }
  CHECK(run.out.find("embree best quality compact ") != std::string::npos);
}

TEST_CASE("raylab-bench embree measures our Embree backends beside bare loops over the same scenes", "[cli][bench]") {
  const TempFolder folder;
  const ProgramResult run =
      raylab_bench({"embree", kCornell, "--rays", "500", "--repeats", "1", "--out", folder.path().string()});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  const Results results = read_results(folder.path());
  CHECK(results.rows.size() == 8);  // two backends, four kinds of rays
  for (const Row& row : results.rows) {
    INFO(row.dump());
    CHECK(row["rays_timed"] == 496);  // whole packets
    CHECK(row["mrays_per_second_bare"].get<double>() > 0.0);
    CHECK(row["batch_of_fastest_bare"].get<double>() > 0.0);
  }
}

TEST_CASE("raylab-bench stability counts the failures of each method at each value, and names no other case",
          "[cli][bench]") {
  const TempFolder folder;
  const ProgramResult run = raylab_bench({"stability", "--case", "small-triangle,20", "--accel", "list,bvh", "--rays",
                                          "200", "--out", folder.path().string()});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  const Results results = read_results(folder.path());
  CHECK(results.runs[0]["complete"] == true);
  // Nineteen sizes, two accelerators of three triangle tests, single rays and batches.
  CHECK(rows_where(results, "scene", "small-triangle").size() == 19 * 12);
  // Seven gaps, integrators and offsets of two accelerators.
  CHECK(rows_where(results, "scene", "plates").size() == 7 * 5 * 2);
  for (const Row& row : results.rows) {
    INFO(row.dump());
    for (const char* field : {"case", "theme", "title", "fails", "swept", "value", "holds", "trials", "failures"}) {
      CHECK(row.contains(field));
    }
    const bool sound = row.value("intersector", "watertight") == "watertight" && row.value("ray_offset", "") != "book";
    if (sound) CHECK(row["failures"] == 0);
  }
  CHECK(run.out.find("list book") != std::string::npos);
  expect_failure({"stability", "--case", "small-triangel"}, 2, "small-triangle");
}

TEST_CASE("raylab-bench render tells the error of each way against one reference", "[cli][bench]") {
  const TempFolder folder;
  const std::vector<std::string> arguments{"render",          kCornell, "--width",   "16",
                                           "--spp",           "1,4",    "--repeats", "2",
                                           "--reference-spp", "32",     "--out",     folder.path().string()};
  const ProgramResult run = raylab_bench(arguments);
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  // A peer that is not there is named, not passed over.
  CHECK(run.err.find("peers left out: no --peer-python was given") != std::string::npos);
  const Results results = read_results(folder.path());
  const auto measured = rows_where(results, "spp", 4);
  const auto targets = rows_where(results, "question", "time to error");
  CHECK(targets.size() == 8);
  CHECK(rows_where(results, "ray_offset", "book").size() == 3);  // two numbers of samples, and the time to the error
  double reference = 0.0;
  for (const Row& row : measured) {
    if (row.contains("question")) continue;
    CHECK(row["relmse"].get<double>() > 0.0);
    CHECK(row["relmse_trimmed"].get<double>() <= row["relmse"].get<double>());
    CHECK(row["runs"] == 2);
    if (reference == 0.0) reference = row["reference_relmse"];
    CHECK(row["reference_relmse"] == reference);
  }
  CHECK(reference > 0.0);
  for (const Row& row : rows_where(results, "question", "difference")) {
    CHECK(row["against"] == "list");
    CHECK(fs::exists(folder / row["picture"].get<std::string>()));
    if (row["accel"] == "bvh" && !row.contains("intersector")) CHECK(row["different_pixels"] == 0);
  }
  // Nor is one that cannot be run.
  std::vector<std::string> with_peer = arguments;
  with_peer.insert(with_peer.end(), {"--peer-python", "/bin/false"});
  CHECK(raylab_bench(with_peer).err.find("mitsuba left out: /bin/false cannot run it") != std::string::npos);
  with_peer.insert(with_peer.end(), {"--peers", "povray:fast"});
  expect_failure(with_peer, 2, "--peers: found povray:fast, expected mitsuba, cycles or luxcore");
  // The reference is made once: the second run finds it.
  const auto reference_time = [&] { return fs::last_write_time(*fs::directory_iterator(folder / "references")); };
  const auto before = reference_time();
  REQUIRE(raylab_bench(arguments).exit_code == 0);
  CHECK(reference_time() == before);
}

TEST_CASE("a reference of another size is refused by name", "[cli][bench]") {
  const TempFolder folder;
  const std::vector<std::string> arguments{"render",          kCornell,
                                           "--width",         "8",
                                           "--spp",           "1",
                                           "--repeats",       "1",
                                           "--accel",         "list",
                                           "--reference-spp", "2",
                                           "--out",           folder.path().string()};
  REQUIRE(raylab_bench(arguments).exit_code == 0);
  const fs::path file = *fs::directory_iterator(folder / "references");
  // Named by all that makes it, so that none is taken for another.
  CHECK(file.string().find("-8x8-7segments-path-sobol-1spp-seed471") != std::string::npos);
  write_exr(file, Image(4, 2));
  expect_failure(arguments, 3, file.string() + ": the reference has 4 x 2 pixels, expected 8 x 8");
}

TEST_CASE("raylab-bench needs finds a cheap way and says it in scene-file lines", "[cli][bench]") {
  const TempFolder folder;
  const ProgramResult run = raylab_bench({"needs", kCornell, "--width", "12", "--spp", "4", "--repeats", "2",
                                          "--reference-spp", "64", "--accel", "list,bvh", "--intersector", "watertight",
                                          "--target-error", "2", "--out", folder.path().string()});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  const Results results = read_results(folder.path());
  const auto energy = rows_where(results, "question", "energy by segment");
  REQUIRE(energy.size() > 3);
  for (std::size_t i = 1; i < energy.size(); ++i) CHECK(energy[i]["missing_energy"] <= energy[i - 1]["missing_energy"]);
  const auto cheapest = rows_where(results, "question", "cheapest");
  REQUIRE(cheapest.size() == 1);
  const Row& best = cheapest[0];
  CHECK(best["kept"] == (best["relmse"].get<double>() < 2.0));
  const std::string lines = best["scene_file"];
  CHECK(lines == "[render]\nsamples_per_pixel = " + best["spp"].dump() + "\nmax_depth = " + best["max_depth"].dump());
  CHECK(run.out.find(lines) != std::string::npos);
  for (const Row& row : rows_where(results, "question", "accelerator")) {
    INFO(row.dump());
    if (row["accel"] == best["accel"]) CHECK(row["runs"].get<int>() >= 6);
  }

  // The command renders what was measured.
  std::string command = best["command"];
  const std::string program = "raylab-render ";
  REQUIRE(command.rfind(program, 0) == 0);
  command = "cd " + folder.path().string() + " && " RAYLAB_BINARY_DIR "/" + command + " --quiet --stats stats.json";
  REQUIRE(run_program("/bin/sh", {"-c", command}).exit_code == 0);
  const Row stats = Row::parse(read_text(folder / "stats.json"));
  for (const char* field : {"width", "spp", "max_depth", "integrator", "sampler"}) CHECK(stats[field] == best[field]);

  // A run with another winner leaves none of the old one.
  const ProgramResult again =
      raylab_bench({"needs", kCornell, "--width", "12", "--spp", "4", "--repeats", "1", "--reference-spp", "64",
                    "--accel", "list", "--target-error", "2", "--out", folder.path().string()});
  REQUIRE(again.exit_code == 0);
  const auto winners = rows_where(read_results(folder.path()), "question", "cheapest");
  REQUIRE(winners.size() == 1);
  CHECK(winners[0]["accel"] == "list");
}

TEST_CASE("raylab-bench scale measures a family by size", "[cli][bench]") {
  const TempFolder folder;
  const ProgramResult run =
      raylab_bench({"scale", "--family", "sphere", "--largest", "1000", "--rays", "200", "--checked", "50", "--repeats",
                    "1", "--accel", "bvh,embree", "--out", folder.path().string()});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  const Results results = read_results(folder.path());
  CHECK(rows_where(results, "threads", 1).size() == 2);
  for (const Row& row : rows_where(results, "threads", 1))
    CHECK(row["mrays_per_second_batch"]["median"].get<double>() > 0.0);
  for (const Row& row : results.rows) {
    CHECK(row["rays_checked"] == 50);
    // What threads give comes from pairs of runs, not from speeds that were measured at different times.
    CHECK(row.contains("speedup") == (row["threads"] > 1));
    if (row.contains("speedup")) CHECK(row["speedup"]["min"] <= row["speedup"]["max"]);
  }
}

TEST_CASE("raylab-bench ladder measures each step from the book's tree to bvh, and checks it", "[cli][bench]") {
  const TempFolder folder;
  const ProgramResult run = raylab_bench(
      {"ladder", kCornell, "--rays", "500", "--checked", "500", "--repeats", "1", "--out", folder.path().string()});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  const Results results = read_results(folder.path());
  CHECK(results.rows.size() == 40);  // eight steps, five kinds of rays
  std::map<std::string, std::size_t> wrong_book;
  for (const Row& row : rows_where(results, "step", "1 book")) wrong_book[row["rays"]] = row["wrong"];
  CHECK(wrong_book["vertex"] > 0);
  for (const Row& row : results.rows) {
    INFO(row.dump());
    CHECK(row["mrays_per_second"]["median"].get<double>() > 0.0);
    CHECK(row["batch_differences"] == 0);
    // The book's faults in its triangle test, and hardly others, until there is a better one.
    if (row["intersector"] == "watertight")
      CHECK(row["wrong"] == 0);
    else
      CHECK(row["wrong"].get<std::size_t>() <= wrong_book[row["rays"]] + 2);
  }
}

TEST_CASE("raylab-bench process measures whole renders, and what all needs cost beside what the scene needs",
          "[cli][bench]") {
  const TempFolder folder;
  const ProgramResult run =
      raylab_bench({"process", kCornell, "--width", "16", "--spp", "2", "--repeats", "2", "--needs", "all,scene",
                    "--accel", "bvh,embree", "--set", "render.max_depth=3", "--out", folder.path().string()});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  const Results results = read_results(folder.path());
  REQUIRE(results.rows.size() == 4);
  CHECK(rows_where(results, "needs", "all").size() == 2);
  for (const Row& row : results.rows) {
    INFO(row.dump());
    const double parts = row["load_seconds"]["min"].get<double>() + row["build_seconds_min"].get<double>() +
                         row["seconds_min"].get<double>();
    CHECK(parts > 0.0);
    CHECK(row["process_seconds"]["max"].get<double>() > parts);
    CHECK(row["estimated_relmse"].get<double>() > 0.0);
    CHECK(row["overrides"] == "render.max_depth=3");
    CHECK(row["max_depth"] == 3);
    CHECK(row["runs"] == 2);
    CHECK(row.contains("seconds_ratio") == row.contains("needs"));
    if (row.contains("needs")) CHECK(row["different_pixels"] == 0);
  }
}

TEST_CASE("raylab-bench threads measures threads beside processes that share nothing", "[cli][bench]") {
  const TempFolder folder;
  const ProgramResult run = raylab_bench({"threads", kCornell, "--width", "16", "--spp", "2", "--repeats", "1",
                                          "--threads", "2", "--out", folder.path().string()});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  const std::vector<Row> rows = read_results(folder.path()).rows;
  REQUIRE(rows.size() == 3);
  const std::pair<int, int> expected[] = {{1, 1}, {1, 2}, {2, 1}};  // processes, threads of each
  for (std::size_t i = 0; i < rows.size(); ++i) {
    CHECK(rows[i]["processes"] == expected[i].first);
    CHECK(rows[i]["threads"] == expected[i].second);
    CHECK(rows[i]["speedup"]["median"].get<double>() ==
          Approx(expected[i].first * rows[0]["seconds"].get<double>() / rows[i]["seconds"].get<double>()));
  }
}

TEST_CASE("raylab-bench profile tells the accelerator's share of a render", "[cli][bench]") {
  const TempFolder folder;
  const ProgramResult run = raylab_bench(
      {"profile", kCornell, "--width", "32", "--spp", "4", "--repeats", "1", "--out", folder.path().string()});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  const std::vector<Row> rows = read_results(folder.path()).rows;
  REQUIRE(rows.size() == 1);
  const auto median = [&](const char* field) { return rows[0][field]["median"].get<double>(); };
  CHECK(median("intersect_seconds") > 0.0);
  CHECK(median("occluded_seconds") > 0.0);
  CHECK(median("accelerator_share") < 1.0);
  CHECK(median("accelerator_share") ==
        Approx((median("intersect_seconds") + median("occluded_seconds")) / rows[0]["seconds"].get<double>()));
  CHECK(rows[0]["estimated_relmse"].get<double>() > 0.0);
}

TEST_CASE("an interrupted raylab-bench keeps the rows it has and says so", "[cli][bench]") {
  const TempFolder folder;
  const std::string wait_then_stop =
      R"("$@" & p=$!; until [ -s "$0" ] || ! kill -0 $p; do sleep 0.02; done; kill -TERM $p; wait $p)";
  const ProgramResult run = run_program(
      "/bin/sh", {"-c", wait_then_stop, (folder / "results.json").string(), RAYLAB_BINARY_DIR "/raylab-bench", "rays",
                  kCornell, "--rays", "2000", "--checked", "10", "--repeats", "100", "--out", folder.path().string()});
  INFO(run.err);
  CHECK(run.exit_code == 130);
  CHECK(run.err.find("interrupted; what was measured is written, and --resume goes on from it\n") != std::string::npos);
  const Results results = read_results(folder.path());
  CHECK(results.runs[0]["complete"] == false);
  CHECK(results.rows.size() >= 11);
  CHECK(results.rows.size() < 55);
  for (const Row& row : results.rows) CHECK(row.contains("rays_checked"));
}

TEST_CASE("raylab-bench that is stopped before its first row says that nothing was written", "[cli][bench]") {
  const TempFolder folder;
  const ProgramResult run = run_program(
      "/usr/bin/timeout", {"--preserve-status", "-s", "INT", "0.5", RAYLAB_BINARY_DIR "/raylab-bench", "rays", kCornell,
                           "--rays", "1000000", "--repeats", "1000", "--out", folder.path().string()});
  INFO(run.err);
  CHECK(run.exit_code == 130);
  CHECK(run.err.find("interrupted; nothing was written\n") != std::string::npos);
  CHECK(folder.entries() == 0);
}

TEST_CASE("a second raylab-bench does not write into the folder of one that measures", "[cli][bench]") {
  const TempFolder folder;
  const std::string two_at_once = R"(
"$@" --rays 2000 --repeats 100 --checked 10 & p=$!
until [ -s "$0" ] || ! kill -0 $p; do sleep 0.02; done
"$@" --rays 500 --repeats 1 --checked 10 --accel list; code=$?
kill -TERM $p; wait $p; exit $code)";
  const ProgramResult run =
      run_program("/bin/sh", {"-c", two_at_once, (folder / "results.json").string(), RAYLAB_BINARY_DIR "/raylab-bench",
                              "rays", kCornell, "--out", folder.path().string()});
  INFO(run.err);
  CHECK(run.exit_code == 4);
  CHECK(run.err.find("raylab-bench: " + folder.path().string() + ": is being written to by another program") !=
        std::string::npos);
  CHECK(read_results(folder.path()).runs.size() == 1);
  CHECK(raylab_bench(quick_rays(folder.path())).exit_code == 0);
}

TEST_CASE("raylab-bench tells bad input by its place, and exits as documented", "[cli][bench]") {
  const TempFolder folder;
  const std::string out = (folder / "out").string();
  expect_failure({}, 2, "");
  expect_failure({"rays"}, 2, "scene");
  expect_failure({"rays", "absent.toml", "--out", out}, 3, "absent.toml");
  expect_failure({"rays", kCornell, "--accel", "magic", "--out", out}, 2, "magic");
  expect_failure({"rays", kCornell, "--intersector", "magic", "--out", out}, 2, "magic");
  expect_failure({"render", kCornell, "--sampler", "magic", "--out", out}, 2, "magic");
  expect_failure({"scale", "--family", "magic", "--out", out}, 2, "magic");
  expect_failure({"process", "absent.toml", "--out", out}, 3, "absent.toml");
  expect_failure({"threads", kCornell, "--render-program", "/absent", "--out", out}, 2, "there is no /absent");
  write_text(folder / "file", "");
  expect_failure({"rays", kCornell, "--out", (folder / "file").string()}, 4, "cannot be made");
  expect_failure({"report", (folder / "absent").string()}, 3, "results.json: cannot be read");
  write_text(folder / "results.json", "{\"machine\": {\"cpu\": \"a\"},\n \"rows\": [{\"suite\": ");
  expect_failure({"report", folder.path().string()}, 3, "results.json:2:");
  expect_failure({"compare", folder.path().string(), folder.path().string()}, 3, "truncated");
}
