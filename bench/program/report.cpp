// raylab-bench report: charts of a folder of results.
#include <filesystem>

#include "commands.hpp"
#include "raylab/core/atomic_file.hpp"
#include "raylab/core/error.hpp"
#include "raylab/measure/results.hpp"
#include "subprocess.hpp"

namespace raylab::bench {

namespace {

/// A Python that has matplotlib and scipy: the one in PATH need not be the distribution's, for which they are packaged.
std::string find_python() {
  for (const char* python : {"python3", "/usr/bin/python3"}) {
    const std::string probe =
        "import importlib.util, sys; sys.exit(None in map(importlib.util.find_spec, ['matplotlib', 'scipy']))";
    if (run_program({python, "-c", probe}, true) == 0) return python;
  }
  throw Error(ErrorKind::failure, "report",
              "no python3 with matplotlib and scipy; install them (Debian: apt-get install python3-matplotlib "
              "python3-scipy)");
}

}  // namespace

int report(const ReportOptions& options) {
  (void)read_results(options.folder);  // says what is wrong with it better than a Python trace would
  check_writable(std::filesystem::path(options.folder) / "index.html");
  std::vector<std::string> command{options.python.empty() ? find_python() : options.python,
                                   bench_script("report/report.py").string(), options.folder};
  if (options.png) command.push_back("--png");
  return run_program(command, false);
}

}  // namespace raylab::bench
