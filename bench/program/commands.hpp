#pragma once
// The subcommands of raylab-bench, each with its options. They return the exit code, throw Error, and throw
// Interrupted once they were interrupted.
#include <cstdint>
#include <string>
#include <vector>

namespace raylab::bench {

struct CommonOptions {
  std::vector<std::string> scenes;
  std::string out = "bench-results";
  std::vector<std::string> accels, intersectors;
  int repeats = 5;
  std::uint32_t seed = 0;
  std::string command_line;
};

struct RaysOptions : CommonOptions {
  std::size_t rays = 1 << 17;
  std::size_t checked = 20000;
};

int rays(const RaysOptions& options);

}  // namespace raylab::bench
