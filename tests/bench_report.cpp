#include <fstream>
#include <map>

#include "bench_runs.hpp"
#include "raylab/measure/results.hpp"
#include "temp_folder.hpp"

using namespace raylab;
using namespace raylab::test;
namespace fs = std::filesystem;

TEST_CASE("raylab-bench report draws the same files from the same results", "[cli][bench]") {
  const TempFolder folder;
  REQUIRE(raylab_bench(quick_rays(folder.path())).exit_code == 0);
  for (const char* suite : {"process", "threads", "profile"}) {
    REQUIRE(
        raylab_bench({suite, kCornell, "--width", "8", "--spp", "2", "--repeats", "1", "--out", folder.path().string()})
            .exit_code == 0);
  }
  const ProgramResult run = raylab_bench({"report", folder.path().string()});
  if (run.err.find("no python3 with matplotlib and scipy") != std::string::npos) {
    CHECK(run.exit_code == 1);
    WARN("left out: python3-matplotlib or python3-scipy is not installed");
    return;
  }
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  const std::string page = read_text(folder / "index.html");
  const std::string chart = read_text(folder / "rays-cornell.svg");
  CHECK(page.find("<figure id=\"rays-cornell\">") != std::string::npos);
  CHECK(page.find("raylab-bench rays") != std::string::npos);
  for (const char* part :
       {"<figure id=\"process\">", "<figure id=\"profile\">", "<figure id=\"threads\">", "Speed-up with threads"})
    CHECK(page.find(part) != std::string::npos);
  REQUIRE(raylab_bench({"report", folder.path().string()}).exit_code == 0);
  CHECK(read_text(folder / "rays-cornell.svg") == chart);
  CHECK(read_text(folder / "index.html") == page);
}

TEST_CASE("report.py tells a row that does not conform to the schema by its place and field", "[cli][bench]") {
  const TempFolder folder;
  const auto report = [&](const std::string& fields) {
    write_text(folder / "results.json",
               R"({"machine": {}, "rows": [{"suite": "rays"}, {"suite": "ladder")" + fields + "}]}");
    return run_program("/bin/sh", {"-c", R"(for python in python3 /usr/bin/python3; do
                                              $python -c 'import matplotlib, scipy' 2> /dev/null && exec $python "$@"
                                            done; exit 127)",
                                   "sh", RAYLAB_SOURCE_DIR "/bench/report/report.py", folder.path().string()});
  };
  if (report("").exit_code == 127) {
    WARN("left out: python3-matplotlib or python3-scipy is not installed");
    return;
  }
  const std::pair<const char*, const char*> faults[] = {
      {R"(, "thread": 1)", "rows[1]: thread: no field of the schema"},
      {R"(, "threads": "two")", "rows[1]: threads: expected integer"},
      {R"(, "bytes": true)", "rows[1]: bytes: expected integer"},
      {R"(, "spp": 1)", "rows[1]: spp: no field of the suite ladder"},
      {R"(, "mrays_per_second": {"median": 1})", "rows[1]: mrays_per_second: expected number for each of median"},
      {R"(, "scene": "box")", "rows[1]: lacks the field step"}};
  for (const auto& [fields, message] : faults) {
    const ProgramResult run = report(fields);
    INFO(run.err);
    CHECK(run.exit_code == 3);
    CHECK(run.err.find("results.json: " + std::string(message)) != std::string::npos);
  }
}
