#include "raylab/apps/bench_main.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <functional>
#include <new>

#include "commands.hpp"
#include "options.hpp"
#include "raylab/core/error.hpp"
#include "suite.hpp"

namespace raylab {

namespace {

using namespace bench;

void add_common(CLI::App& command, CommonOptions& options) {
  command
      .add_option("--out", options.out, "Folder of the results; what it holds stays, but for rows measured anew")
      ->capture_default_str();
  command.add_option("--accel", options.accels, "Accelerators, comma separated (default: all but exact)")
      ->delimiter(',');
  command.add_option("--intersector", options.intersectors, "Triangle tests, comma separated (default: all)")
      ->delimiter(',');
  command.add_option("--repeats", options.repeats, "Repeats of each measurement")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command.add_option("--seed", options.seed, "Seed of all random numbers")->capture_default_str();
}

CLI::App* add_rays(CLI::App& app, RaysOptions& options) {
  CLI::App* command = app.add_subcommand("rays", "Speed and accuracy of single rays, one thread");
  command->add_option("scene", options.scenes, "Scene files")->required();
  add_common(*command, options);
  command->add_option("--rays", options.rays, "Rays of each kind that are timed")
      ->check(CLI::Range(1, 1 << 26))
      ->capture_default_str();
  command->add_option("--checked", options.checked, "Rays of each kind whose hits are checked")
      ->check(CLI::Range(1, 1 << 26))
      ->capture_default_str();
  return command;
}

int run(int argc, char** argv) {
  CLI::App app{"Measures accelerators and renders: speed and accuracy together."};
  app.name("raylab-bench");
  app.set_version_flag("--version", std::string("raylab-bench ") + RAYLAB_VERSION);
  app.require_subcommand(1);
  RaysOptions rays_options;
  CLI::App* rays_command = add_rays(app, rays_options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);  // --help or --version
    std::fprintf(stderr, "raylab-bench: %s\nRun with --help for the options.\n", e.what());
    return static_cast<int>(ErrorKind::usage);
  }
  if (*rays_command) {
    rays_options.command_line = command_line("raylab-bench", argc, argv);
    return rays(rays_options);
  }
  return 0;
}

}  // namespace

int bench_main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const Interrupted&) {
    std::fprintf(stderr, "raylab-bench: interrupted; what was measured is written\n");
    return kInterrupted;
  } catch (const Error& e) {
    std::fprintf(stderr, "raylab-bench: %s\n", e.what());
    return e.exit_code();
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "raylab-bench: out of memory\n");
  } catch (const std::exception& e) {
    std::fprintf(stderr, "raylab-bench: %s\n", e.what());
  }
  return static_cast<int>(ErrorKind::failure);
}

}  // namespace raylab
