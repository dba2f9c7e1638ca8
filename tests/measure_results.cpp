#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>

#include "catch.hpp"
#include "expect_error.hpp"
#include "raylab/measure/results.hpp"
#include "raylab/measure/statistics.hpp"
#include "temp_folder.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

Row row(const std::string& accel, double speed) {
  return {{"suite", "rays"},
          {"scene", "box"},
          {"accel", accel},
          {"bytes", 240},
          {"mrays_per_second", {{"median", speed}, {"min", speed}, {"max", speed}}}};
}

}  // namespace

TEST_CASE("the spread of values is their median, smallest and largest", "[unit][measure]") {
  const Spread odd = spread_of({3.0, 1.0, 2.0});
  CHECK(odd.median == 2.0);
  CHECK(odd.min == 1.0);
  CHECK(odd.max == 3.0);
  CHECK(spread_of({4.0, 1.0, 2.0, 8.0}).median == 3.0);
  CHECK(spread_of({7.0}).median == 7.0);
}

TEST_CASE("the standard error of a mean is the deviation over the root of the number", "[unit][measure]") {
  const MeanAndError m = mean_and_error({1.0, 2.0, 3.0, 4.0});
  CHECK(m.mean == 2.5);
  CHECK(m.error == Approx(std::sqrt(5.0 / 3.0 / 4.0)));
  CHECK(std::isinf(mean_and_error({1.0}).error));
}

TEST_CASE("a results folder gives back the rows that were added", "[unit][measure]") {
  const TempFolder folder;
  ResultsFolder results(folder / "new", "rays", "raylab-bench rays box.toml");
  results.add({row("bvh", 2.5), row("embree", 3.5)});
  const Results read = read_results(folder / "new");
  CHECK(read.rows == std::vector<Row>{row("bvh", 2.5), row("embree", 3.5)});
  CHECK(same_machine(read.machine, describe_machine()));
  REQUIRE(read.runs.size() == 1);
  CHECK(read.runs[0]["command"] == "raylab-bench rays box.toml");
  CHECK(read.runs[0]["complete"] == false);
  results.finish();
  CHECK(read_results(folder / "new").runs[0]["complete"] == true);
}

TEST_CASE("a row measured anew takes the place of the old one, and the rest of the folder stays", "[unit][measure]") {
  const TempFolder folder;
  ResultsFolder(folder.path(), "rays", "first").add({row("bvh", 2.5), row("embree", 3.5)});
  ResultsFolder(folder.path(), "rays", "second").add({row("bvh", 2.75), row("list", 0.5)});
  const Results read = read_results(folder.path());
  CHECK(read.rows == std::vector<Row>{row("bvh", 2.75), row("embree", 3.5), row("list", 0.5)});
  CHECK(read.runs.size() == 2);
}

TEST_CASE("a run that is gone on with keeps its measured parts alone, and what was there before it",
          "[unit][measure]") {
  const TempFolder folder;
  ResultsFolder(folder.path(), "rays", "other").add({row("exact", 0.5)});
  {
    ResultsFolder first(folder.path(), "rays", "command");
    first.add({row("bvh", 2.5)}, "a");
    first.add({row("list", 0.5)});
    CHECK_FALSE(first.measured("a"));  // in this run it may be measured twice
  }
  {
    ResultsFolder second(folder.path(), "rays", "command", true);
    CHECK(second.resumed());
    CHECK(second.measured("a"));
    CHECK_FALSE(second.measured("b"));
    CHECK(second.results().rows == std::vector<Row>{row("exact", 0.5), row("bvh", 2.5)});
    second.finish();
  }
  CHECK(ResultsFolder(folder.path(), "rays", "command", true).measured("b"));  // as it came to its end
  CHECK_FALSE(ResultsFolder(folder.path(), "rays", "command").measured("a"));
}

TEST_CASE("the key of a row is what it measures, not what came out", "[unit][measure]") {
  CHECK(row_key(row("bvh", 1.0)) == row_key(row("bvh", 2.0)));
  CHECK(row_key(row("bvh", 1.0)) != row_key(row("list", 1.0)));
  // Results of before there was a choice of quality are compared with those of the default.
  Row built = row("bvh", 1.0);
  built["quality"] = "balanced";
  CHECK(row_key(built) == row_key(row("bvh", 2.0)));
  built["quality"] = "best";
  CHECK(row_key(built) != row_key(row("bvh", 2.0)));
  Row other = row("bvh", 1.0);
  other["rays"] = "shadow";
  CHECK(row_key(row("bvh", 1.0)) != row_key(other));
}

TEST_CASE(
    "CSV has a column for each field in the order of the schema, empty where a row has none, and quotes what "
    "needs it",
    "[unit][measure]") {
  const Row first = row("bvh", 2.5);
  const Row second{{"leaks", 12}, {"suite", "scale"}, {"scene", "a \"b\", c"}};
  CHECK(to_csv({first, second}) ==
        "suite,scene,accel,bytes,mrays_per_second.median,mrays_per_second.min,mrays_per_second.max,leaks\r\n"
        "rays,box,bvh,240,2.5,2.5,2.5,\r\n"
        "scale,\"a \"\"b\"\", c\",,,,,,12\r\n");
}

TEST_CASE("a row that does not conform to the schema is told by its field", "[unit][measure]") {
  const auto fault_with = [](const char* field, const Row& value) {
    Row r = row("bvh", 2.5);
    r[field] = value;
    return row_fault(r);
  };
  CHECK(row_fault(row("bvh", 2.5)) == "");
  CHECK(fault_with("sah_cost", 3) == "");
  CHECK(fault_with("Scene", "box") == "Scene: no field of the schema");
  CHECK(fault_with("bytes", 2.5) == "bytes: expected an integer");
  CHECK(fault_with("bytes", true) == "bytes: expected an integer");
  CHECK(fault_with("scene", 7) == "scene: expected a string");
  CHECK(fault_with("sah_cost", nullptr) == "sah_cost: expected a number");
  CHECK(fault_with("compact", 1) == "compact: expected true or false");
  CHECK(fault_with("mrays_per_second", 2.5) == "mrays_per_second: expected a number for each of median, min, max");
  CHECK(fault_with("mrays_per_second", {{"median", 2.5}}) ==
        "mrays_per_second: expected a number for each of median, min, max");
  CHECK(fault_with("spp", 16) == "spp: no field of the suite \"rays\"");
  CHECK(row_fault({{"scene", "box"}}) == "suite: expected a string");
}

TEST_CASE("a number that is not finite is left out of its row", "[unit][measure]") {
  const TempFolder folder;
  Row measured = row("bvh", 2.5);
  measured["sah_cost"] = std::numeric_limits<double>::quiet_NaN();
  Row speedless = row("list", std::numeric_limits<double>::infinity());
  ResultsFolder(folder.path(), "rays", "command").add({measured, speedless});
  speedless.erase("mrays_per_second");
  CHECK(read_results(folder.path()).rows == std::vector<Row>{row("bvh", 2.5), speedless});
}

TEST_CASE("the shipped results conform to the schema, and their CSV is that of their rows", "[unit][measure]") {
  const std::string folder = RAYLAB_SOURCE_DIR "/bench/results";
  const Results shipped = read_results(folder);
  CHECK(shipped.rows.size() > 500);
  CHECK(read_text(folder + "/results.csv") == to_csv(shipped.rows));
}

TEST_CASE("results.json that is cut off is refused with the place where it ends", "[unit][measure]") {
  const TempFolder folder;
  ResultsFolder(folder.path(), "rays", "command").add({row("bvh", 2.5)});
  const std::string whole = read_text(folder / "results.json");
  const std::string file = (folder / "results.json").string();
  write_text(folder / "results.json", whole.substr(0, whole.find("\"rows\"") + 12));
  const auto lines = std::count(whole.begin(), whole.begin() + static_cast<long>(whole.find("\"rows\"")), '\n') + 2;
  expect_error(ErrorKind::input, file + ":" + std::to_string(lines) + ":3", {"truncated"},
               [&] { (void)read_results(folder.path()); });
  write_text(folder / "results.json", "{\n \"machine\": {},\n \"rows\": nonsense\n}\n");
  expect_error(ErrorKind::input, file + ":3:11", {"not JSON"}, [&] { (void)read_results(folder.path()); });
}

TEST_CASE("results.json that nests without end, or holds numbers without end, is refused at its place",
          "[unit][measure]") {
  const TempFolder folder;
  const std::string file = (folder / "results.json").string();
  const std::string begin =
      "{\"machine\": {}, \"rows\": [],\n\"x\": \"[[[[[[[[[[[[\\\"[[[[[[[[[[[[[[[[[[[[[[\", \"y\": ";
  for (const char* bracket : {"[", "{\"a\":"}) {
    std::string nested = begin;
    for (int i = 0; i < 200000; ++i) nested += bracket;
    write_text(folder / "results.json", nested);
    const std::size_t column = begin.size() - begin.find('\n') + 31 * std::string(bracket).size();
    expect_error(ErrorKind::input, file + ":2:" + std::to_string(column), {"nested more than 32 deep"},
                 [&] { (void)read_results(folder.path()); });
  }
  write_text(folder / "results.json", begin + "1e999}");
  expect_error(ErrorKind::input, file + ":2:" + std::to_string(begin.size() - begin.find('\n')), {"1e999"},
               [&] { (void)read_results(folder.path()); });
  write_text(folder / "results.json", begin + "[{\"a\": 0}]}");
  CHECK(read_results(folder.path()).rows.empty());
}

TEST_CASE("results.json that holds something else is refused with the place inside it", "[unit][measure]") {
  const TempFolder folder;
  const std::string file = (folder / "results.json").string();
  const auto refused = [&](const std::string& text, const char* where) {
    write_text(folder / "results.json", text);
    expect_error(ErrorKind::input, file, {where}, [&] { (void)read_results(folder.path()); });
  };
  refused("[]", "the document: expected an object");
  refused("{\"rows\": []}", "machine: expected an object");
  refused("{\"machine\": {}}", "rows: expected an array");
  refused("{\"version\": \"1\"}", "version: expected an integer, at least 1");
  refused("{\"version\": 0}", "version: expected an integer, at least 1");
  refused("{\"machine\": {}, \"rows\": [{\"suite\": \"rays\"}, 7]}", "rows[1]: expected an object");
  refused("{\"machine\": {}, \"rows\": [{\"scene\": \"box\"}]}", "rows[0]: suite: expected a string");
  refused("{\"machine\": {}, \"rows\": [{\"suite\": \"rays\", \"threads\": \"two\"}]}",
          "rows[0]: threads: expected an integer");
  expect_error(ErrorKind::input, (folder / "absent/results.json").string(), {"cannot be read"},
               [&] { (void)read_results(folder / "absent"); });
}

TEST_CASE("results say the version of their format, and those of a later one are refused by it", "[unit][measure]") {
  const TempFolder folder;
  const auto results = [&] { return read_results(folder.path()); };
  ResultsFolder(folder.path(), "rays", "command").add({row("bvh", 2.5)});
  std::string text = read_text(folder / "results.json");
  const std::string version = "\"version\": 1,";
  const std::size_t at = text.find(version);
  REQUIRE(at != std::string::npos);
  write_text(folder / "results.json", text.replace(at, version.size(), ""));  // as before there were versions
  CHECK(results().rows.size() == 1);
  write_text(folder / "results.json", text.insert(at, "\"version\": 2,"));
  expect_error(ErrorKind::input, (folder / "results.json").string(),
               {"its results are of format version 2, and this program reads 1"}, results);
  expect_error(ErrorKind::input, (folder / "results.json").string(), {"format version 2"},
               [&] { ResultsFolder(folder.path(), "rays", "command"); });
}

TEST_CASE("results of another machine are not added to", "[unit][measure]") {
  const TempFolder folder;
  write_text(folder / "results.json",
             "{\"machine\": {\"cpu\": \"abacus\", \"threads\": 1, \"memory_gib\": 1}, \"rows\": [{\"suite\": "
             "\"rays\"}]}");
  expect_error(ErrorKind::usage, folder.path().string(), {"another machine"},
               [&] { ResultsFolder(folder.path(), "rays", "command"); });
}

TEST_CASE("a results folder that cannot be written is known before anything is measured", "[unit][measure]") {
  const TempFolder folder;
  write_text(folder / "file", "");
  expect_error(ErrorKind::output, (folder / "file").string(), {"cannot be made"},
               [&] { ResultsFolder(folder / "file", "rays", "command"); });
  expect_error(ErrorKind::output, (folder / "file" / "results").string(), {"cannot be made"},
               [&] { ResultsFolder(folder / "file" / "results", "rays", "command"); });
}
