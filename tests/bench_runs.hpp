#pragma once
// Runs of raylab-bench.
#include <filesystem>
#include <vector>

#include "catch.hpp"
#include "raylab/measure/results.hpp"
#include "run_program.hpp"

namespace raylab::test {

inline const std::string kCornell = RAYLAB_SOURCE_DIR "/scenes/cornell.toml";

inline ProgramResult raylab_bench(const std::vector<std::string>& arguments) {
  return run_program(RAYLAB_BINARY_DIR "/raylab-bench", arguments);
}

inline void expect_failure(const std::vector<std::string>& arguments, int exit_code, const std::string& part) {
  const ProgramResult result = raylab_bench(arguments);
  INFO(result.err);
  CHECK(result.exit_code == exit_code);
  CHECK(result.err.find("raylab-bench: ") != std::string::npos);
  CHECK(result.err.find(part) != std::string::npos);
}

inline std::vector<Row> rows_where(const Results& results, const std::string& field, const Row& value) {
  std::vector<Row> found;
  for (const Row& row : results.rows) {
    if (row.contains(field) && row[field] == value) found.push_back(row);
  }
  return found;
}

/// Arguments of a measurement of a moment, into a folder.
inline std::vector<std::string> quick_rays(const std::filesystem::path& out) {
  return {"rays", kCornell, "--rays", "500", "--checked", "100", "--repeats", "1", "--out", out.string()};
}

}  // namespace raylab::test
