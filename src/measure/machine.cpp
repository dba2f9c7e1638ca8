#include <unistd.h>

#include <fstream>
#include <string>

#include "raylab/core/parallel.hpp"
#include "raylab/measure/results.hpp"

namespace raylab {

namespace {

/// What follows `key` and its separator in the first line that begins with it; "unknown" without one.
std::string value_in(const char* file, const std::string& key, char separator) {
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    if (line.rfind(key, 0) != 0) continue;
    const std::size_t start = line.find_first_not_of(" \t\"", line.find(separator) + 1);
    if (start == std::string::npos) break;
    return line.substr(start, line.find_last_not_of(" \"") + 1 - start);
  }
  return "unknown";
}

}  // namespace

Row describe_machine() {
  const double bytes = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  return {{"cpu", value_in("/proc/cpuinfo", "model name", ':')},
          {"threads", hardware_threads()},
          {"memory_gib", static_cast<int>(bytes / (1 << 30) + 0.5)},
          {"system", value_in("/etc/os-release", "PRETTY_NAME", '=')},
          {"compiler", "GCC or compatible " __VERSION__},
          {"raylab", RAYLAB_VERSION}};
}

bool same_machine(const Row& a, const Row& b) {
  for (const char* field : {"cpu", "threads", "memory_gib"}) {
    if (a.value(field, Row()) != b.value(field, Row())) return false;
  }
  return true;
}

}  // namespace raylab
