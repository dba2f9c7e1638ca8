#include <filesystem>

#include "bench_runs.hpp"
#include "temp_folder.hpp"

using namespace raylab;
using namespace raylab::test;
namespace fs = std::filesystem;

TEST_CASE("raylab-bench compare tells what changed", "[cli][bench]") {
  const TempFolder folder;
  const auto results = [](double speed) {
    return R"({"machine": {"cpu": "a"}, "rows": [{"suite": "rays", "accel": "bvh", "mrays_per_second": {"median": )" +
           std::to_string(speed) + R"(, "min": )" + std::to_string(speed) + R"(, "max": )" + std::to_string(speed) +
           "}}]}";
  };
  fs::create_directory(folder / "old");
  fs::create_directory(folder / "new");
  write_text(folder / "old/results.json", results(2.0));
  write_text(folder / "new/results.json", results(3.0));
  const ProgramResult run = raylab_bench({"compare", (folder / "old").string(), (folder / "new").string()});
  CHECK(run.exit_code == 0);
  CHECK(run.out ==
        "faster\n  suite=rays accel=bvh: mrays_per_second 2 -> 3 (1.500 times)\n"
        "1 figures changed, 0 did not, beyond their noise\n");
  write_text(folder / "new/results.json", R"({"machine": {"cpu": "b"}, "rows": []})");
  expect_failure({"compare", (folder / "old").string(), (folder / "new").string()}, 2, "--any-machine");
  CHECK(raylab_bench({"compare", "--any-machine", (folder / "old").string(), (folder / "new").string()}).exit_code ==
        0);
}

TEST_CASE("raylab-bench compare --fail-on exits with 1 at what is worse, and tells it in JUnit's XML", "[cli][bench]") {
  const TempFolder folder;
  const auto results = [](double speed, int wrong) {
    const std::string s = std::to_string(speed);
    return R"({"machine": {"cpu": "a"}, "rows": [{"suite": "rays", "accel": "bvh", "rays_checked": 100, "wrong": )" +
           std::to_string(wrong) + R"(, "mrays_per_second": {"median": )" + s + R"(, "min": )" + s + R"(, "max": )" +
           s + "}}]}";
  };
  const std::string before = (folder / "old").string(), after = (folder / "new").string();
  fs::create_directory(before);
  fs::create_directory(after);
  write_text(folder / "old/results.json", results(2.0, 1));
  const auto exit_code = [&](double speed, int wrong, const std::string& fail_on) {
    write_text(folder / "new/results.json", results(speed, wrong));
    return raylab_bench({"compare", before, after, "--fail-on", fail_on, "--junit", (folder / "j.xml").string()})
        .exit_code;
  };
  CHECK(exit_code(1.92, 1, "slower=5%,wrong") == 0);
  CHECK(exit_code(1.88, 1, "slower=5%,wrong") == 1);
  CHECK(exit_code(1.88, 1, "slower=10%,wrong") == 0);
  CHECK(exit_code(3.0, 1, "slower=5%,wrong") == 0);
  CHECK(exit_code(2.0, 2, "slower=5%") == 0);
  CHECK(exit_code(2.0, 0, "wrong") == 0);
  CHECK(exit_code(2.0, 2, "wrong") == 1);
  CHECK(read_text(folder / "j.xml") ==
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"compare\" tests=\"1\" failures=\"1\">\n"
        "  <testcase classname=\"compare\" name=\"suite=rays accel=bvh wrong\">\n"
        "    <failure message=\"less accurate: wrong 0.01 -&gt; 0.02\"/>\n  </testcase>\n</testsuite>\n");
  expect_failure({"compare", before, after, "--fail-on", "slower=5"}, 2, "slower=5%");
  expect_failure({"compare", before, after, "--fail-on", "magic"}, 2, "magic");
}

TEST_CASE("raylab-bench compare --build finds the build that takes longer", "[cli][bench]") {
  const TempFolder folder;
  const std::string program = RAYLAB_BINARY_DIR "/raylab-render";
  // The same program, after it has done what it is to do once already.
  write_text(folder / "twice", "#!/bin/sh\n" + program + " \"$@\" && exec " + program + " \"$@\"\n");
  fs::permissions(folder / "twice", fs::perms::owner_all);
  const auto compare = [&](const std::string& before, const std::string& after) {
    return raylab_bench({"compare", "--build", before, "--build", after, "--scene", kCornell, "--width", "40",
                         "--seconds", "6", "--fail-on", "slower=50%", "--junit", (folder / "j.xml").string()});
  };
  const ProgramResult slower = compare(RAYLAB_BINARY_DIR, (folder / "twice").string());
  INFO(slower.out << slower.err);
  CHECK(slower.exit_code == 1);
  CHECK(read_text(folder / "j.xml").find("<failure message=\"slower: ") != std::string::npos);
  CHECK(compare((folder / "twice").string(), program).exit_code == 0);
  expect_failure({"compare", "--build", program}, 2, "--build");
  expect_failure({"compare", "--build", program, "--build", "/absent", "--scene", kCornell}, 2, "/absent");
  expect_failure({"compare", "--build", program, "--build", program}, 2, "--scene");
}

TEST_CASE("raylab-bench rays --fail-on wrong exits with 1 where the book's test leaks", "[cli][bench]") {
  const TempFolder folder;
  const auto exit_code = [&](const std::string& intersector) {
    return raylab_bench({"rays", kCornell, "--accel", "rtiow", "--intersector", intersector, "--rays", "4000",
                         "--checked", "4000", "--repeats", "1", "--out", (folder / "out").string(), "--fail-on",
                         "wrong", "--junit", (folder / "j.xml").string()})
        .exit_code;
  };
  CHECK(exit_code("watertight") == 0);
  CHECK(read_text(folder / "j.xml").find("failures=\"0\"") != std::string::npos);
  CHECK(exit_code("book") == 1);
  CHECK(read_text(folder / "j.xml").find("rtiow book\">\n    <failure message=\"wrong answers: ") != std::string::npos);
}
