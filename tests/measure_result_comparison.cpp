#include "catch.hpp"
#include "expect_error.hpp"
#include "raylab/measure/result_comparison.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

const Row kMachine{{"cpu", "abacus"}, {"threads", 2}, {"memory_gib", 8}};

Row rays_row(const std::string& accel, double median, double min, double max) {
  return {{"suite", "rays"},     {"scene", "box"},
          {"accel", accel},      {"mrays_per_second", {{"median", median}, {"min", min}, {"max", max}}},
          {"rays_checked", 100}, {"false_hits", 5}};
}

Row render_row(double seconds, double relmse, double relmse_error) {
  return {{"suite", "render"},
          {"scene", "box"},
          {"spp", 16},
          {"seconds", seconds},
          {"seconds_min", seconds * 0.99},
          {"seconds_max", seconds * 1.01},
          {"relmse", relmse},
          {"relmse_error", relmse_error}};
}

ResultComparison compare(const std::vector<Row>& before, const std::vector<Row>& after) {
  return compare_results({kMachine, {}, before}, {kMachine, {}, after}, false);
}

}  // namespace

TEST_CASE("results compared with themselves have not changed", "[unit][measure]") {
  const std::vector<Row> rows{rays_row("bvh", 4.0, 3.9, 4.1), render_row(2.0, 0.01, 0.001)};
  const ResultComparison same = compare(rows, rows);
  CHECK(same.changes.empty());
  CHECK(same.unchanged == 4);
  CHECK(same.only_before.empty());
  CHECK(same.only_after.empty());
}

TEST_CASE("a speed has changed when the ranges of its repeats do not overlap", "[unit][measure]") {
  const auto of = [](const Row& after) { return compare({rays_row("bvh", 4.0, 3.8, 4.2)}, {after}).changes; };
  CHECK(of(rays_row("bvh", 4.3, 4.1, 4.5)).empty());
  const auto faster = of(rays_row("bvh", 5.0, 4.9, 5.1));
  REQUIRE(faster.size() == 1);
  CHECK(faster[0] == ChangedValue{Change::faster, "suite=rays scene=box accel=bvh", "mrays_per_second", 4.0, 5.0});
  const auto slower = of(rays_row("bvh", 3.0, 2.9, 3.1));
  REQUIRE(slower.size() == 1);
  CHECK(slower[0].change == Change::slower);
}

TEST_CASE("a difference below 1% is none, however small the spread", "[unit][measure]") {
  CHECK(compare({rays_row("bvh", 4.0, 4.0, 4.0)}, {rays_row("bvh", 4.03, 4.03, 4.03)}).changes.empty());
  CHECK(compare({rays_row("bvh", 4.0, 4.0, 4.0)}, {rays_row("bvh", 4.05, 4.05, 4.05)}).changes.size() == 1);
}

TEST_CASE("less time is faster", "[unit][measure]") {
  const auto changes = compare({render_row(2.0, 0.01, 0.001)}, {render_row(1.0, 0.01, 0.001)}).changes;
  REQUIRE(changes.size() == 1);
  CHECK(changes[0].change == Change::faster);
  CHECK(changes[0].field == "seconds");
}

TEST_CASE("a relMSE has changed beyond two standard errors of the difference", "[unit][measure]") {
  // The difference's standard error is 0.001 * sqrt(2).
  CHECK(compare({render_row(2.0, 0.010, 0.001)}, {render_row(2.0, 0.0127, 0.001)}).changes.empty());
  const auto changes = compare({render_row(2.0, 0.010, 0.001)}, {render_row(2.0, 0.0130, 0.001)}).changes;
  REQUIRE(changes.size() == 1);
  CHECK(changes[0].change == Change::less_accurate);
}

TEST_CASE("one wrong answer more is a change, and counts are compared by their share of the rays", "[unit][measure]") {
  Row after = rays_row("bvh", 4.0, 3.8, 4.2);
  after["false_hits"] = 6;
  const auto worse = compare({rays_row("bvh", 4.0, 3.8, 4.2)}, {after}).changes;
  REQUIRE(worse.size() == 1);
  CHECK(worse[0].change == Change::less_accurate);
  CHECK(worse[0].field == "false_hits");
  after["false_hits"] = 10;
  after["rays_checked"] = 200;
  CHECK(compare({rays_row("bvh", 4.0, 3.8, 4.2)}, {after}).changes.empty());
}

TEST_CASE("rows without a counterpart are named", "[unit][measure]") {
  const auto result = compare({rays_row("bvh", 4, 4, 4), rays_row("list", 1, 1, 1)},
                              {rays_row("bvh", 4, 4, 4), rays_row("embree", 3, 3, 3)});
  CHECK(result.only_before == std::vector<std::string>{"suite=rays scene=box accel=list"});
  CHECK(result.only_after == std::vector<std::string>{"suite=rays scene=box accel=embree"});
}

TEST_CASE("results of two machines are compared only when told to", "[unit][measure]") {
  Row other = kMachine;
  other["threads"] = 64;
  const std::vector<Row> rows{rays_row("bvh", 4.0, 3.9, 4.1)};
  expect_error(ErrorKind::usage, "compare", {"abacus, 2 threads", "abacus, 64 threads", "--any-machine"}, [&] {
    (void)compare_results({kMachine, {}, rows}, {other, {}, rows}, false);
  });
  CHECK(compare_results({kMachine, {}, rows}, {other, {}, rows}, true).unchanged == 2);
}
