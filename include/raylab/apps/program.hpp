#pragma once
// What the main functions of all programs do.
#include <functional>
#include <string>

namespace CLI {
class App;
}

namespace raylab {

/// A command line, quoted so that a shell reads it back as it was typed; the program by its name alone.
std::string command_line(const std::string& program, int argc, char** argv);

/// Parses argv. False where there is nothing left to do: --help, --version, and `--generate man`, `bash`, `zsh` or
/// `fish`, which prints the program's manual page or a shell's completions; or a mistake, which is told.
bool parse_or_tell(CLI::App& app, int argc, char** argv, int& exit_code);

/// Runs a program and returns its exit code; what it throws is told on standard error, after the program's name.
int run_and_tell(const char* program, const std::function<int()>& run);

/// Throws Error (output) where standard output, a full disk for one, has not taken all that was printed.
void check_printed();

}  // namespace raylab
