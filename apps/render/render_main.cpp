#include "raylab/apps/render_main.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "options.hpp"
#include "raylab/apps/program.hpp"
#include "raylab/core/atomic_file.hpp"
#include "raylab/core/error.hpp"
#include "raylab/core/interrupt.hpp"
#include "raylab/core/parallel.hpp"
#include "raylab/core/text.hpp"
#include "raylab/image/image_file.hpp"
#include "render_shot.hpp"
#include "report.hpp"
#include "shots.hpp"

namespace raylab {

namespace fs = std::filesystem;

namespace {

void list_accelerators() {
  for (const AcceleratorEntry& entry : accelerators()) {
    std::printf("%-14s %s\n", entry.name.c_str(), entry.description.c_str());
  }
}

/// A file that is there may hold work, and is left alone.
void write_made_scene(const LoadedScene& loaded, const std::filesystem::path& file) {
  if (std::filesystem::exists(file)) {
    throw Error(ErrorKind::output, file.string(), "is there already, so the scene was not written over it");
  }
  AtomicFile out(file);
  out.stream() << loaded.text;
  out.commit();
}

bool is_exr_file(const fs::path& file) { return lowercase_ending(file) == ".exr"; }

void check_all_writable(const RenderCommand& command, const Files& outputs, const std::string& suffix) {
  for (const auto& file : outputs) check_writable_image(with_suffix(file, suffix));
  if (!command.stats_file.empty()) check_writable(with_suffix(command.stats_file, suffix));
}

/// Only a new file can take a name's place at once.
void warn_of_other_names(const Job& job, const Files& outputs, const std::string& suffix) {
  for (const auto& output : outputs) {
    const fs::path file = with_suffix(output, suffix);
    std::error_code none;  // where it is not there
    if (fs::is_regular_file(file, none) && fs::hard_link_count(file, none) > 1) {
      job.warn(file.string() + " has other names, hard links, which keep what they have");
    }
  }
}

/// Throws where a file is to be written twice, or over one that the scene is read from.
void check_distinct(const RenderCommand& command, const Files& outputs, const std::string& suffix, const Files& read) {
  Files written;
  for (const auto& file : outputs) written.push_back(with_suffix(file, suffix));
  if (!command.stats_file.empty()) written.push_back(with_suffix(command.stats_file, suffix));
  const auto is_same = [](const fs::path& a, const fs::path& b) {
    std::error_code none;  // of files, one of which is not there
    return fs::weakly_canonical(a, none) == fs::weakly_canonical(b, none) || fs::equivalent(a, b, none);
  };
  for (auto file = written.begin(); file != written.end(); ++file) {
    if (std::any_of(written.begin(), file, [&](const auto& other) { return is_same(*file, other); })) {
      throw Error(ErrorKind::usage, file->string(), "would be written twice: each output needs a name of its own");
    }
    if (std::any_of(read.begin(), read.end(), [&](const auto& other) { return is_same(*file, other); })) {
      throw Error(ErrorKind::usage, file->string(),
                  "is read by the scene, and would be written over; -o names another");
    }
  }
}

int render(const RenderCommand& command) {
  if (command.list_accels) {
    list_accelerators();
    check_printed();
    return 0;
  }
  Files outputs(command.outputs.begin(), command.outputs.end());
  if (outputs.empty()) {
    // A model is looked at before it is worked on, and every viewer shows PNG; so is a flight.
    const char* ending = command.fly || is_model_file(command.scene) ? ".png" : ".exr";
    outputs.push_back(std::filesystem::path(command.scene).filename().replace_extension(ending));
  }
  // Known before the work starts, and not after: names of options, and files that cannot be written.
  (void)parse_integrator(command.integrator);
  (void)parse_sampler(command.sampler);
  AcceleratorOptions accel_options = accelerator_options(command);
  if (!command.intersector.empty()) accel_options.intersector = parse_intersector(command.intersector);
  if (!command.isa.empty()) accel_options.isa = parse_isa(command.isa);
  check_options(find_accelerator(command.accel), accel_options);
  const bool one_picture = !command.views && !command.fly;
  if (!command.check && one_picture) check_all_writable(command, outputs, "");

  if (command.samples && std::none_of(outputs.begin(), outputs.end(), is_exr_file)) {
    throw Error(ErrorKind::usage, "--samples", "a part of a picture is kept in an EXR file, and -o names none");
  }

  const QuestionGuard question;  // from here on, as one that comes early must not end the program
  const ThreadLimit limit(command.threads);
  const Stopwatch load_watch;
  LoadOptions load_options = command.load_options();
  load_options.keep_unneeded = command.needs == "all";
  if (!command.write_scene.empty()) {
    const std::filesystem::path folder = std::filesystem::path(command.write_scene).parent_path();
    load_options.model.folder = folder.empty() ? "." : folder;
  }
  const LoadedScene loaded = load_scene(command.scene, load_options);
  const double load_seconds = load_watch.seconds();
  if (!command.write_scene.empty()) write_made_scene(loaded, command.write_scene);
  for (const std::string& warning : loaded.warnings) {
    if (!command.quiet) std::fprintf(stderr, "raylab-render: warning: %s\n", warning.c_str());
  }
  if (command.check) {
    std::fputs(check_text(command, loaded, session_options(command, loaded), load_seconds).c_str(), stdout);
    check_printed();
    return 0;
  }
  const std::vector<Shot> shots = shots_of(command, loaded);
  for (const Shot& shot : shots) check_distinct(command, outputs, shot.suffix, loaded.files);
  if (!one_picture) {
    for (const Shot& shot : shots) check_all_writable(command, outputs, shot.suffix);
  }

  const auto accelerator = make_accelerator(command.accel, loaded.scene.geometry, accel_options);
  const Job job{command, loaded, *accelerator, load_seconds};
  if (std::none_of(outputs.begin(), outputs.end(), is_exr_file)) {
    if (!command.layers.empty()) {
      job.warn("--layers: nothing is written of them, as only EXR files hold layers and none is asked for");
    }
    if (command.film) job.warn("--film: nothing is written of it, as only EXR files hold one and none is asked for");
  }
  const InterruptGuard guard;
  for (const Shot& shot : shots) {
    warn_of_other_names(job, outputs, shot.suffix);
    if (!render_shot(job, shot, outputs)) return kInterrupted;
  }
  if (command.fly) {
    for (const auto& file : outputs) {
      const std::string said = make_film(file);
      if (!command.quiet) std::printf("film       %s\n", said.c_str());
    }
  }
  return 0;
}

}  // namespace

int render_main(int argc, char** argv) {
  return run_and_tell("raylab-render", [&] {
    int exit_code = 0;
    const auto command = parse_command(argc, argv, exit_code);
    return command ? render(*command) : exit_code;
  });
}

}  // namespace raylab
