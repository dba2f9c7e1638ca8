#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace raylab::bench {

/// Runs a program found by PATH and waits for its end, its standard output going nowhere if `quiet`. Returns its
/// exit code, 127 when it cannot be started, 128 + the signal's number when a signal ended it. Where asked for, tells
/// the processor seconds of all its threads.
int run_program(const std::vector<std::string>& command, bool quiet, double* cpu_seconds = nullptr);

/// A Python program of bench/, such as "report/report.py": the one installed beside this program, or else the one
/// of the source tree.
std::filesystem::path bench_script(const std::filesystem::path& name);

}  // namespace raylab::bench
