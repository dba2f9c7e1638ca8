#include "raylab/apps/program.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include "generated_text.hpp"
#include "raylab/core/error.hpp"
#include "raylab/core/text.hpp"

namespace raylab {

namespace {

/// Quotes an argument so that a shell reads it back as it was.
std::string shell_word(const std::string& word) {
  const bool plain = !word.empty() && word.find_first_not_of(
                                          "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                          "0123456789_-./=,:+@%") == std::string::npos;
  if (plain) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

/// The nearest of the names where one is near, else all of them.
std::string known_names(const std::string& name, const std::vector<std::string>& known, const std::string& kind) {
  const std::string nearest = nearest_name(name, known);
  if (nearest.empty()) return {};
  if (2 * edit_distance(name, nearest) <= name.size()) return ": the nearest " + kind + " is " + nearest;
  std::string list;
  for (const std::string& other : known) list += (list.empty() ? "" : ", ") + other;
  return kind == "command" ? ": the commands are " + list : std::string();
}

/// What is wrong with the arguments, told of the first that is. CLI11 names those that it does not know from the last
/// to the first, and a command that it does not know as none.
std::string mistake(const CLI::App& app, int argc, char** argv, const CLI::ParseError& error) {
  const CLI::App* used = &app;
  while (!used->get_subcommands().empty()) used = used->get_subcommands().front();
  const std::vector<std::string> unknown = app.remaining(true);
  std::vector<std::string> commands;
  for (const CLI::App* command : used->get_subcommands(nullptr)) commands.push_back(command->get_name());
  const bool wants_command = dynamic_cast<const CLI::RequiredError*>(&error) != nullptr && !commands.empty();
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (std::find(unknown.begin(), unknown.end(), argument) == unknown.end()) continue;
    if (argument.starts_with("-")) {
      std::vector<std::string> options;
      for (const CLI::Option* option : used->get_options()) {
        for (const std::string& name : option->get_lnames()) options.push_back("--" + name);
      }
      return "unknown option " + argument + known_names(argument, options, "option");
    }
    if (!wants_command) return "unexpected argument " + argument;
    return "unknown command " + argument + known_names(argument, commands, "command");
  }
  return wants_command ? "a command is missing" + known_names("", commands, "command") : error.what();
}

}  // namespace

std::string command_line(const std::string& program, int argc, char** argv) {
  std::string line = program;
  for (int i = 1; i < argc; ++i) line += " " + shell_word(argv[i]);
  return line;
}

bool parse_or_tell(CLI::App& app, int argc, char** argv, int& exit_code) {
  if (argc > 1 && std::string_view(argv[1]) == "--generate") {  // for packagers, and not in --help
    std::fputs(generated_text(app, argc == 3 ? argv[2] : "").c_str(), stdout);
    exit_code = 0;
    return false;
  }
  try {
    app.parse(argc, argv);
    return true;
  } catch (const CLI::ParseError& e) {
    const bool asked = e.get_exit_code() == 0;  // --help or --version
    if (asked) {
      exit_code = app.exit(e);
    } else {
      std::fprintf(stderr, "%s: %s (--help lists the options)\n", app.get_name().c_str(),
                   mistake(app, argc, argv, e).c_str());
      exit_code = static_cast<int>(ErrorKind::usage);
    }
    return false;
  }
}

int run_and_tell(const char* program, const std::function<int()>& run) {
  // Libraries run out of memory in functions that may not throw, too.
  static const char* name;
  name = program;
  std::set_terminate([] {
    try {
      if (const std::exception_ptr exception = std::current_exception()) std::rethrow_exception(exception);
    } catch (const std::bad_alloc&) {
      std::fprintf(stderr, "%s: out of memory\n", name);
      std::_Exit(static_cast<int>(ErrorKind::failure));
    } catch (...) {
    }
    std::abort();
  });
  try {
    return run();
  } catch (const Error& e) {
    std::fprintf(stderr, "%s: %s\n", program, e.what());
    return e.exit_code();
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "%s: out of memory\n", program);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s: %s\n", program, e.what());
  }
  return static_cast<int>(ErrorKind::failure);
}

void check_printed() {
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    throw Error(ErrorKind::output, "standard output", "cannot be written");
  }
}

}  // namespace raylab
