#include "raylab/apps/render_main.hpp"

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <filesystem>

#include "options.hpp"
#include "raylab/apps/program.hpp"
#include "raylab/core/atomic_file.hpp"
#include "raylab/core/error.hpp"
#include "raylab/core/interrupt.hpp"
#include "raylab/core/parallel.hpp"
#include "raylab/core/progress.hpp"
#include "raylab/core/text.hpp"
#include "raylab/image/image_file.hpp"
#include "raylab/render/features.hpp"
#include "raylab/render/view_warnings.hpp"
#include "report.hpp"
#include "shots.hpp"

namespace raylab {

namespace {

void list_accelerators() {
  for (const AcceleratorEntry& entry : accelerators()) {
    std::printf("%-14s %s\n", entry.name.c_str(), entry.description.c_str());
  }
}

bool wants(const RenderCommand& command, const char* layer) {
  return std::find(command.layers.begin(), command.layers.end(), layer) != command.layers.end();
}

void add_rgb(std::vector<Layer>& layers, const std::string& name, const char* channels, bool as_float,
             const Image& image) {
  for (int c = 0; c < 3; ++c) {
    Layer layer{name + "." + channels[c], as_float, {}};
    layer.values.reserve(image.pixels.size());
    for (const Rgb& p : image.pixels) layer.values.push_back(p[c]);
    layers.push_back(std::move(layer));
  }
}

std::vector<Layer> make_layers(const RenderCommand& command, const Scene& scene, const Accelerator& accelerator,
                               const RenderOptions& options, const Film& film) {
  std::vector<Layer> layers;
  if (wants(command, "albedo") || wants(command, "normal") || wants(command, "depth")) {
    constexpr std::uint32_t kFeatureSamples = 16;
    FirstHitFeatures features =
        first_hit_features(scene, accelerator, options, std::min(kFeatureSamples, options.samples_per_pixel));
    if (wants(command, "albedo")) add_rgb(layers, "albedo", "RGB", false, features.albedo);
    if (wants(command, "normal")) add_rgb(layers, "N", "XYZ", false, features.normal);
    if (wants(command, "depth")) layers.push_back({"Z", true, std::move(features.depth)});
  }
  if (wants(command, "variance")) {
    Image variance(film.width(), film.height());
    for (int y = 0; y < film.height(); ++y) {
      for (int x = 0; x < film.width(); ++x) variance.at(x, y) = Rgb(film.variance_of_mean(x, y));
    }
    add_rgb(layers, "variance", "RGB", true, variance);
  }
  if (wants(command, "samples")) {
    Layer layer{"sampleCount", true, {}};
    for (int y = 0; y < film.height(); ++y) {
      for (int x = 0; x < film.width(); ++x) layer.values.push_back(static_cast<float>(film.samples(x, y)));
    }
    layers.push_back(std::move(layer));
  }
  return layers;
}

Attributes make_attributes(const RenderReport& r) {
  return {{"raylab.version", RAYLAB_VERSION},
          {"raylab.command", r.command.command_line},
          {"raylab.sceneHash", format("%016" PRIx64, r.loaded.hash)},
          {"raylab.seed", std::to_string(r.options.seed)},
          {"raylab.firstSample", std::to_string(r.options.first_sample)},
          {"raylab.samplesPerPixel", std::to_string(r.options.samples_per_pixel)},
          {"raylab.accelerator", r.command.accel},
          {"raylab.seconds", std::to_string(r.stats.seconds)},
          {"raylab.estimatedRelmse", std::to_string(r.estimated_relmse)},
          {"raylab.partial", r.partial ? "true" : "false"}};
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

/// What all pictures of one command share.
struct Job {
  const RenderCommand& command;
  const LoadedScene& loaded;
  const Accelerator& accelerator;
  double load_seconds;

  void warn(const std::string& warning) const {
    if (!command.quiet) std::fprintf(stderr, "raylab-render: warning: %s\n", warning.c_str());
  }
};

using Files = std::vector<std::filesystem::path>;

void check_all_writable(const RenderCommand& command, const Files& outputs, const std::string& suffix) {
  for (const auto& file : outputs) check_writable_image(with_suffix(file, suffix));
  if (!command.stats_file.empty()) check_writable(with_suffix(command.stats_file, suffix));
}

/// Renders one picture and writes it. False when it was interrupted, and the picture is partial.
bool render_shot(const Job& job, const Shot& shot, const Files& outputs) {
  const RenderCommand& command = job.command;
  const Scene& scene = job.loaded.scene;
  RenderOptions options = session_options(command, job.loaded);
  options.camera = shot.camera;
  RenderSession session(scene, job.accelerator, options);
  const std::vector<std::string> warnings = view_warnings(scene, job.accelerator, session.options());
  for (const std::string& warning : warnings) job.warn(warning);
  Progress progress(command.progress);
  session.start();
  while (!session.wait_for(0.05)) {
    progress.update(session.progress());
    if (InterruptGuard::interrupted()) session.request_stop();
  }
  session.stop();
  progress.finish(session.progress());

  const Film film = session.snapshot();
  const RenderStats stats = session.stats();
  const bool partial = !session.finished();
  const RenderReport report{command,
                            job.loaded,
                            session.options(),
                            job.accelerator.build_report(),
                            stats,
                            session.needs(),
                            session.integrator().lights().count,
                            session.integrator().lights().bytes,
                            job.load_seconds,
                            film.estimated_relmse(),
                            partial};
  const Image image = film.image();
  if (!partial && warnings.empty() && is_black(image)) {
    job.warn("the picture is black: no light reaches what the camera sees");
  }
  const std::vector<Layer> layers = make_layers(command, scene, job.accelerator, session.options(), film);
  for (const auto& file : outputs) write_image(with_suffix(file, shot.suffix), image, layers, make_attributes(report));
  if (!command.stats_file.empty()) {
    AtomicFile file(with_suffix(command.stats_file, shot.suffix));
    file.stream() << report_json(report);
    file.commit();
  }
  if (!command.quiet) {
    if (!command.fly) std::fputs(report_text(report).c_str(), stdout);
    if (job.loaded.made_for_model && command.write_scene.empty()) {
      std::printf("scene      made for the model; --write-scene FILE.toml keeps it, to go on from there\n");
    }
    for (const auto& file : outputs) {
      std::printf("wrote      %s%s\n", with_suffix(file, shot.suffix).c_str(),
                  partial ? " (partial: interrupted)" : "");
    }
  }
  return !partial;
}

int render(const RenderCommand& command) {
  if (command.list_accels) {
    list_accelerators();
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
    std::fputs(check_text(loaded, load_seconds).c_str(), stdout);
    return 0;
  }
  const std::vector<Shot> shots = shots_of(command, loaded);
  if (!one_picture) {
    for (const Shot& shot : shots) check_all_writable(command, outputs, shot.suffix);
  }

  const auto accelerator = make_accelerator(command.accel, loaded.scene.geometry, accel_options);
  const Job job{command, loaded, *accelerator, load_seconds};
  const bool is_exr =
      std::any_of(outputs.begin(), outputs.end(), [](const auto& file) { return lowercase_ending(file) == ".exr"; });
  if (!command.layers.empty() && !is_exr) {
    job.warn("--layers: nothing is written of them, as only EXR files hold layers and none is asked for");
  }
  const InterruptGuard guard;
  for (const Shot& shot : shots) {
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
