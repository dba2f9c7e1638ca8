#include "raylab/apps/bench_main.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <functional>

#include "commands.hpp"
#include "peer.hpp"
#include "raylab/apps/program.hpp"
#include "suite.hpp"

namespace raylab {

namespace {

using namespace bench;

void add_folder(CLI::App& command, CommonOptions& options) {
  command.add_option("--out", options.out, "Folder of the results; what it holds stays, but for rows measured anew")
      ->capture_default_str();
  command.add_flag("--resume", options.resume,
                   "Go on with the run of this command that was interrupted: what it measured is not measured again");
}

void add_common(CLI::App& command, CommonOptions& options) {
  add_folder(command, options);
  command.add_option("--repeats", options.repeats, "Repeats of each measurement")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command.add_option("--seed", options.seed, "Seed of all random numbers")->capture_default_str();
}

/// `unnamed` says what is measured when no accelerator and no triangle test is named.
void add_choice(CLI::App& command, CommonOptions& options, const std::string& unnamed) {
  command.add_option("--accel", options.accels, "Accelerators, comma separated " + unnamed)
      ->type_name(accelerator_choice())
      ->delimiter(',');
  command.add_option("--intersector", options.intersectors, "Triangle tests, comma separated " + unnamed)
      ->type_name("{book,fast,watertight}")
      ->delimiter(',');
  command
      .add_option("--quality", options.qualities,
                  "Build qualities, comma separated, of those that have a choice: fast, balanced, best (default: "
                  "balanced)")
      ->type_name("{fast,balanced,best}")
      ->delimiter(',');
  command.add_option("--bvh-quality", options.qualities)->delimiter(',')->group("");  // the old name, not shown
  command.add_flag("--compact", options.compact, "Compact trees, of those that have a choice");
}

/// Options of the suites that send rays one by one and in batches.
void add_ray_counts(CLI::App& command, RaysOptions& options) {
  command.add_option("--rays", options.rays, "Rays of each kind that are timed")
      ->check(CLI::Range(1, 1 << 26))
      ->capture_default_str();
  command.add_option("--checked", options.checked, "Rays of each kind whose hits are checked")
      ->check(CLI::Range(1, 1 << 26))
      ->capture_default_str();
}

template <class Options>
void add_verdicts(CLI::App& command, Options& options, const std::string& what) {
  command.add_option("--fail-on", options.fail_on, what)->delimiter(',');
  command.add_option("--junit", options.junit, "File for what passed and what failed, in the XML of JUnit");
}

CLI::App* add_rays(CLI::App& app, RaysOptions& options) {
  CLI::App* command = app.add_subcommand("rays", "Speed and accuracy of single rays and batches, one thread");
  command->add_option("scene", options.scenes, "Scene files")->required();
  add_common(*command, options);
  add_choice(*command, options, "(default: all but exact)");
  add_ray_counts(*command, options);
  add_verdicts(*command, options, "wrong: exit with 1 if an answer is wrong, single or in a batch");
  return command;
}

CLI::App* add_embree(CLI::App& app, RaysOptions& options) {
  CLI::App* command =
      app.add_subcommand("embree", "Speed of our Embree backends beside bare loops over the same library");
  command->add_option("scene", options.scenes, "Scene files")->required();
  add_common(*command, options);
  command->add_option("--rays", options.rays, "Rays of each kind that are timed")
      ->check(CLI::Range(16, 1 << 26))
      ->capture_default_str();
  return command;
}

CLI::App* add_ladder(CLI::App& app, RaysOptions& options) {
  CLI::App* command = app.add_subcommand(
      "ladder", "What each step buys from the book's tree to bvh: speed, accuracy, memory, building time");
  command->add_option("scene", options.scenes, "Scene files")->required();
  add_common(*command, options);
  add_ray_counts(*command, options);
  return command;
}

/// Options of the suites that make pictures.
template <class Options>
void add_pictures(CLI::App& command, Options& options) {
  command.add_option("--width", options.width, "Picture width in pixels; 0: the scene's")
      ->check(CLI::Range(0, 65536))
      ->capture_default_str();
  command.add_option("--threads", options.threads, "Threads for building and rendering; 0: all")
      ->check(CLI::Range(0, 4096))
      ->capture_default_str();
  command.add_option("--reference-spp", options.reference_spp, "Samples per pixel of the reference")
      ->check(CLI::Range(2, 1 << 24))
      ->capture_default_str();
  command.add_option("--cache", options.cache, "Folder of the references (default: references in that of the results)");
  command.add_option("--target-error", options.target_error, "relMSE aimed at")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
}

CLI::App* add_needs(CLI::App& app, NeedsOptions& options) {
  CLI::App* command = app.add_subcommand("needs", "How little a scene can be rendered with for a given error");
  command->add_option("scene", options.scenes, "Scene files")->required();
  add_common(*command, options);
  add_choice(*command, options, "(default: all but exact)");
  command->add_option("--spp", options.spp, "Samples per pixel of the measurements that choose")
      ->check(CLI::Range(2, 1 << 20))
      ->capture_default_str();
  add_pictures(*command, options);
  return command;
}

CLI::App* add_render(CLI::App& app, RenderSuiteOptions& options) {
  CLI::App* command = app.add_subcommand("render",
                                         "Whole pictures: error against time. Ways to render are all combinations "
                                         "of what is named; by default the usual "
                                         "one (bvh, path, sobol), and those that differ from it in one thing");
  command->add_option("scene", options.scenes, "Scene files")->required();
  add_common(*command, options);
  add_choice(*command, options, "(default: those of the usual ways)");
  command->add_option("--integrator", options.integrators, "Integrators, comma separated: path, book")->delimiter(',');
  command->add_option("--sampler", options.samplers, "Samplers, comma separated: sobol, independent")->delimiter(',');
  command->add_option("--ray-offset", options.ray_offsets, "How rays leave a surface, comma separated: bounds, book")
      ->delimiter(',')
      ->check(CLI::IsMember({"bounds", "book"}));
  command->add_option("--spp", options.spp, "Samples per pixel, comma separated")
      ->delimiter(',')
      ->check(CLI::Range(1, 1 << 20))
      ->capture_default_str();
  add_pictures(*command, options);
  command
      ->add_option("--peer-python", options.peer_python,
                   "A Python that has the package mitsuba, bpy or pyluxcore: Mitsuba 3, Cycles or LuxCore is then "
                   "measured too, in pictures at least 400 pixels wide")
      ->envname("RAYLAB_PEER_PYTHON");
  options.peers = peer_names();
  command
      ->add_option("--peers", options.peers,
                   "Which of them, comma separated: NAME in its best way for the scene, or NAME:VARIANT, such as "
                   "mitsuba:scalar_rgb or luxcore:BIDIRCPU")
      ->delimiter(',')
      ->capture_default_str();
  command
      ->add_option("--peer-minutes", options.peer_minutes,
                   "Leave out a renderer that takes longer to read the scene or to render one picture")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  return command;
}

/// Options of the suites that render at full size.
template <class Options>
void add_size(CLI::App& command, Options& options) {
  command.add_option("scene", options.scenes, "Scene files")->required();
  add_common(command, options);
  add_choice(command, options, "(default: bvh, its default test)");
  command.add_option("--width", options.width, "Picture width in pixels; 0: the scene's")
      ->check(CLI::Range(0, 65536))
      ->capture_default_str();
  command.add_option("--spp", options.spp, "Samples per pixel; 0: the scene's")
      ->check(CLI::Range(0, 1 << 24))
      ->capture_default_str();
}

/// Options of the suites that run raylab-render.
void add_render_process(CLI::App& command, ProcessOptions& options) {
  add_size(command, options);
  command.add_option("--threads", options.threads, "Threads for building and rendering; 0: all")
      ->check(CLI::Range(0, 4096))
      ->capture_default_str();
  command.add_option("--set", options.overrides, "KEY=VALUE for any key of the scene file; repeatable")
      ->allow_extra_args(false);
  command.add_option("--render-program", options.render_program,
                     "The raylab-render to run (default: the one beside this program)");
}

CLI::App* add_process(CLI::App& app, ProcessOptions& options) {
  CLI::App* command = app.add_subcommand(
      "process", "Whole processes of raylab-render: seconds of loading, building, rendering, and all together");
  add_render_process(*command, options);
  command
      ->add_option("--needs", options.needs,
                   "Comma separated: scene (what the scene needs), all; both are compared with one another")
      ->delimiter(',')
      ->check(CLI::IsMember({"scene", "all"}))
      ->capture_default_str();
  return command;
}

CLI::App* add_threads(CLI::App& app, ProcessOptions& options) {
  CLI::App* command = app.add_subcommand(
      "threads", "Speed-up of a render with threads, beside that of independent processes at the same time");
  add_render_process(*command, options);
  return command;
}

CLI::App* add_profile(CLI::App& app, ProfileOptions& options) {
  CLI::App* command = app.add_subcommand("profile", "Share of a render's time spent in the accelerator, one thread");
  add_size(*command, options);
  return command;
}

CLI::App* add_scale(CLI::App& app, ScaleOptions& options) {
  CLI::App* command = app.add_subcommand("scale", "Growth with triangles and threads, on geometry made by formula");
  add_common(*command, options);
  add_choice(*command, options,
             "(default: each accelerator as it is, but exact and what the largest size is too large for)");
  command
      ->add_option("--family", options.families, "Comma separated: soup, sphere, terrain, thin, stadium (default: all)")
      ->type_name("{soup,sphere,terrain,thin,stadium}")
      ->delimiter(',');
  command->add_option("--largest", options.largest, "Most triangles; sizes are powers of ten from 1000 on")
      ->check(CLI::Range(1000, 100000000))
      ->capture_default_str();
  command->add_option("--rays", options.rays, "Rays that are timed")
      ->check(CLI::Range(1, 1 << 26))
      ->capture_default_str();
  command->add_option("--checked", options.checked, "Rays whose hits are checked")
      ->check(CLI::Range(1, 1 << 26))
      ->capture_default_str();
  return command;
}

CLI::App* add_stability(CLI::App& app, StabilityOptions& options) {
  CLI::App* command =
      app.add_subcommand("stability", "Known failures: how often each method fails, against what breaks it");
  add_folder(*command, options);
  command->add_option("--seed", options.seed, "Seed of all random numbers")->capture_default_str();
  command->add_option("--case", options.cases, "Names or numbers of cases, comma separated (default: all)")
      ->delimiter(',');
  command
      ->add_option("--accel", options.accels,
                   "Accelerators, comma separated (default: all but exact; of cases that make pictures, bvh)")
      ->type_name(accelerator_choice())
      ->delimiter(',');
  command->add_option("--intersector", options.intersectors, "Triangle tests, comma separated (default: all)")
      ->type_name("{book,fast,watertight}")
      ->delimiter(',');
  command->add_option("--isa", options.isas, "Instruction sets of bvh, comma separated (default: the newest)")
      ->type_name("{sse4.2,avx2,avx512,neon}")
      ->delimiter(',');
  command->add_option("--rays", options.rays, "Rays, or paths, of each method at each value")
      ->check(CLI::Range(100, 1 << 26))
      ->capture_default_str();
  command->add_flag("--quick", options.quick, "No more than 1,000 of them");
  return command;
}

CLI::App* add_report(CLI::App& app, ReportOptions& options) {
  CLI::App* command = app.add_subcommand("report", "Charts and index.html of a folder of results");
  command->add_option("folder", options.folder, "Folder of results")->required();
  command->add_flag("--png", options.png, "Charts as PNG too");
  command->add_option("--python", options.python, "A Python that has matplotlib and scipy (default: the one found)");
  return command;
}

CLI::App* add_compare(CLI::App& app, CompareOptions& options) {
  CLI::App* command = app.add_subcommand(
      "compare", "What changed between two folders of results, or from one build to another, beyond their noise");
  CLI::Option* old_folder = command->add_option("old", options.before, "Folder of the old results");
  CLI::Option* new_folder = command->add_option("new", options.after, "Folder of the new results");
  old_folder->needs(new_folder);
  command->add_flag("--any-machine", options.any_machine, "Even if they are of two machines");
  add_verdicts(
      *command, options,
      "Comma separated: slower=PERCENT%, wrong; exit with 1 if a figure is worse by that and beyond its noise");
  CLI::Option* builds =
      command
          ->add_option("--build", options.builds,
                       "Given twice, old and new: a folder with raylab-render, or the program; both render in turns, "
                       "and their processor seconds are compared")
          ->expected(1)
          ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
          ->excludes(old_folder);
  command->add_option("--scene", options.scenes, "Scene file that the builds render; repeatable")
      ->allow_extra_args(false)
      ->needs(builds);
  command->add_option("--width", options.width, "Picture width in pixels")
      ->check(CLI::Range(1, 65536))
      ->capture_default_str()
      ->needs(builds);
  command->add_option("--seconds", options.seconds, "How long builds are compared, at least")
      ->check(CLI::PositiveNumber)
      ->capture_default_str()
      ->needs(builds);
  return command;
}

int run(int argc, char** argv) {
  CLI::App app{"Measures accelerators and renders: speed and accuracy together."};
  app.name("raylab-bench");
  app.set_version_flag("--version", std::string("raylab-bench ") + RAYLAB_VERSION);
  app.require_subcommand(1);
  RaysOptions rays_options, ladder_options, embree_options;
  RenderSuiteOptions render_options;
  NeedsOptions needs_options;
  ScaleOptions scale_options;
  ProcessOptions process_options, threads_options;
  ProfileOptions profile_options;
  StabilityOptions stability_options;
  ReportOptions report_options;
  CompareOptions compare_options;
  // A render takes long enough to time well, and its error needs few seeds to be known.
  render_options.repeats = needs_options.repeats = 3;
  process_options.repeats = profile_options.repeats = 3;
  const CLI::App* rays_command = add_rays(app, rays_options);
  const CLI::App* embree_command = add_embree(app, embree_options);
  const CLI::App* ladder_command = add_ladder(app, ladder_options);
  const CLI::App* render_command = add_render(app, render_options);
  const CLI::App* scale_command = add_scale(app, scale_options);
  const CLI::App* needs_command = add_needs(app, needs_options);
  const CLI::App* process_command = add_process(app, process_options);
  const CLI::App* threads_command = add_threads(app, threads_options);
  const CLI::App* profile_command = add_profile(app, profile_options);
  const CLI::App* stability_command = add_stability(app, stability_options);
  const CLI::App* report_command = add_report(app, report_options);
  const CLI::App* compare_command = add_compare(app, compare_options);
  int exit_code = 0;
  if (!parse_or_tell(app, argc, argv, exit_code)) return exit_code;
  const std::string line = command_line("raylab-bench", argc, argv);
  for (CommonOptions* o :
       {static_cast<CommonOptions*>(&rays_options), static_cast<CommonOptions*>(&ladder_options),
        static_cast<CommonOptions*>(&embree_options), static_cast<CommonOptions*>(&render_options),
        static_cast<CommonOptions*>(&needs_options), static_cast<CommonOptions*>(&scale_options),
        static_cast<CommonOptions*>(&process_options), static_cast<CommonOptions*>(&threads_options),
        static_cast<CommonOptions*>(&profile_options), static_cast<CommonOptions*>(&stability_options)}) {
    o->command_line = line;
  }
  if (*rays_command) return rays(rays_options);
  if (*embree_command) return embree(embree_options);
  if (*ladder_command) return ladder(ladder_options);
  if (*render_command) return bench::render(render_options);
  if (*scale_command) return bench::scale(scale_options);
  if (*needs_command) return needs(needs_options);
  if (*process_command) return process(process_options);
  if (*threads_command) return threads(threads_options);
  if (*profile_command) return bench::profile(profile_options);
  if (*stability_command) return bench::stability(stability_options);
  if (*report_command) return report(report_options);
  if (*compare_command) return compare(compare_options);
  return 0;
}

}  // namespace

int bench_main(int argc, char** argv) {
  return run_and_tell("raylab-bench", [&] {
    try {
      return run(argc, argv);
    } catch (const Interrupted&) {
      std::fprintf(
          stderr, "raylab-bench: interrupted; %s\n",
          Suite::any_written() ? "what was measured is written, and --resume goes on from it" : "nothing was written");
      return kInterrupted;
    }
  });
}

}  // namespace raylab
