#include "options.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <map>

#include "raylab/apps/program.hpp"
#include "raylab/core/error.hpp"
#include "raylab/core/text.hpp"
#include "raylab/image/image_file.hpp"

namespace raylab {

namespace {

const std::vector<std::string> kLayers{"albedo", "normal", "depth", "variance", "samples"};

}  // namespace

void add_picture_options(CLI::App& app, PictureCommand& command) {
  app.add_option("--accel", command.accel, "Accelerator by name, see raylab-render --list-accels")
      ->type_name(accelerator_choice())
      ->capture_default_str();
  app.add_option("--quality", command.quality,
                 "How much building may cost, of bvh and Embree: fast (less time, a worse tree), balanced (the "
                 "default) or best (several times the time, for scenes of large or long triangles)")
      ->type_name("{fast,balanced,best}");
  app.add_option("--bvh-quality", command.quality)->group("");  // the old name, not shown
  app.add_flag("--compact", command.compact, "A tree of Embree that takes less memory, and more time");
  app.add_option("--integrator", command.integrator,
                 "path, book, or reference: path ray by ray, for reading and checking")
      ->type_name("{path,book,reference}")
      ->capture_default_str();
  app.add_option("--sampler", command.sampler, "Sampler")->type_name("{independent,sobol}")->capture_default_str();
  app.add_option("--spp", command.spp, "Samples per pixel")->check(CLI::Range(1, 1 << 30));
  app.add_option("--width", command.width, "Width in pixels; alone, it keeps the scene's aspect ratio")->take_last();
  app.add_option("--height", command.height, "Height in pixels; alone, it keeps the scene's aspect ratio")->take_last();
  app.add_option("--max-depth", command.max_depth, "Path segments, the camera ray included");
  app.add_option("--seed", command.seed, "Seed of all random numbers")->capture_default_str();
  app.add_option("--threads", command.threads, "Threads for building and rendering; 0: all")
      ->check(CLI::Range(0, 4096))
      ->capture_default_str();
  app.add_option("--set", command.overrides, "KEY=VALUE for any key of the scene file; repeatable")
      ->allow_extra_args(false);
  app.add_option("--up", command.up,
                 "Of a model: the file's axis that points up, x, y or z (default: z for STL, else y)")
      ->check(CLI::IsMember({"x", "y", "z"}));
  app.add_flag("--ground", command.ground, "Of a model: put a ground under it");
}

LoadOptions PictureCommand::load_options() const {
  LoadOptions options;
  options.overrides = overrides;
  if (!up.empty()) options.model.up = up.front();
  options.model.ground = ground;
  // The model is framed in the shape of the picture; sizes that make none are told of where the session's are checked.
  ModelOptions& model = options.model;
  const double aspect = static_cast<double>(model.width) / model.height;
  const double wide = width ? *width : height ? std::round(*height * aspect) : model.width;
  const double high = height ? *height : width ? std::round(*width / aspect) : model.height;
  if (wide >= 1.0 && high >= 1.0 && wide * high <= static_cast<double>(kMostPixels)) {
    model.width = static_cast<int>(wide);
    model.height = static_cast<int>(high);
  }
  return options;
}

std::optional<RenderCommand> parse_command(int argc, char** argv, int& exit_code) {
  RenderCommand command;
  command.command_line = command_line("raylab-render", argc, argv);

  CLI::App app{"Renders a scene file, or a model as it is, to EXR or PNG pictures."};
  app.name("raylab-render");
  app.set_version_flag("--version", std::string("raylab-render ") + RAYLAB_VERSION);
  app.add_option("scene", command.scene, "Scene file (TOML), or a model (OBJ, PLY, STL or glTF)");
  app.add_option(
         "-o,--output", command.outputs,
         "Picture to write, .exr or .png; repeatable (default: the scene's name with .exr, a model's with .png)")
      ->allow_extra_args(false);
  add_picture_options(app, command);
  app.add_option("--intersector", command.intersector,
                 "Triangle test of the hand-written accelerators: book, fast or watertight")
      ->type_name("{book,fast,watertight}");
  app.add_option("--isa", command.isa,
                 "Instruction set of bvh: sse4.2, avx2, avx512 or neon (default: the newest there is)")
      ->type_name("{sse4.2,avx2,avx512,neon}");
  app.add_option(
         "--strategies", command.strategies,
         "How light is looked for: auto (all that the scene needs), or of bsdf, light (points of lights), mirror "
         "(the same over plane mirrors) and sphere (the same over a sphere of glass or smooth metal) those named, "
         "comma separated; the mean stays the same")
      ->capture_default_str();
  app.add_option("--ray-offset", command.ray_offset,
                 "How rays leave a surface: bounds (error bounds) or book (t_min = 0.001)")
      ->check(CLI::IsMember({"bounds", "book"}))
      ->capture_default_str();
  app.add_option("--needs", command.needs, "Store and branch on what the scene needs, or on all there is")
      ->check(CLI::IsMember({"scene", "all"}))
      ->capture_default_str();
  std::string samples, checkpoint_every, write_every, time_limit;
  app.add_option("--samples", samples,
                 "Take samples A to B - 1 of each pixel, a part of the picture that raylab-image merge joins with "
                 "others; implies --film")
      ->type_name("A:B")
      ->take_last();  // as the command that makes a dropped sample again asks for
  std::string first_sample;
  app.add_option("--first-sample", first_sample)->group("");  // an earlier one, told what took its place
  app.add_flag("--film", command.film,
               "EXR files hold the exact sums too, 108 bytes a pixel: --resume takes more samples of them, "
               "raylab-image merge joins them");
  app.add_option("--checkpoint-every", checkpoint_every,
                 "Write the render's state to OUTPUT.checkpoint.exr so often, such as 30s, 10m or 1h (default: of "
                 "renders over five minutes each minute, or less often for under 1% of the time)")
      ->type_name("TIME");
  app.add_flag("--resume", command.resume,
               "Go on from OUTPUT.checkpoint.exr, or else from an output with --film, where there is one: to the same "
               "picture as without a stop");
  app.add_option("--write-every", write_every, "Write the picture so far to the outputs so often")->type_name("TIME");
  app.add_option("--time-limit", time_limit, "Stop after so long a time of rendering, such as 30s, 10m or 1h")
      ->type_name("TIME");
  app.add_option(
         "--target-error", command.target_error,
         "Stop after the first pass of which the estimated relMSE is reliable and no more; --spp remains the limit")
      ->check(CLI::PositiveNumber);
  app.add_flag("--adaptive", command.adaptive,
               "Take samples where the error is: --spp is the mean of a pixel, which has a quarter of it or more, by "
               "the noise of the first 16 samples of its neighbours; without bias, and not with --samples");
  bool even = false;
  app.add_flag("--no-adaptive", even)->group("");  // as the command that makes a dropped sample again asks for
  app.add_option("--exr", command.exr,
                 "Values of EXR pictures: half or float (default: half, and float where half would lose values "
                 "beyond 65504 or near 0)")
      ->check(CLI::IsMember({"half", "float"}));
  app.add_option("--tile-size", command.tile_size, "Tile size in pixels; changes no result")
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
  app.add_option("--crop", command.crop, "Render only X,Y,WIDTH,HEIGHT (pixels from the upper left)")->take_last();
  app.add_option("--layers", command.layers,
                 "EXR layers beside the picture, comma separated: albedo, normal, depth, variance, samples")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember(kLayers));
  app.add_option("--stats", command.stats_file, "Write what was measured to this JSON file");
  app.add_option("--write-scene", command.write_scene, "Of a model: write the scene made for it to this file (TOML)")
      ->excludes("--set");  // which would not be in the file
  CLI::Option* views =
      app.add_flag("--views", command.views, "A picture of each [[view]] of the scene, NAME-VIEW.png of -o NAME.png");
  app.add_option("--fly", command.fly,
                 "So many frames, NAME-0001.png and on, of a flight through the views, and by ffmpeg a film")
      ->check(CLI::Range(1, 9999))
      ->excludes(views);
  const std::map<std::string, ProgressKind> progress_names{{"auto", ProgressKind::automatic},
                                                           {"lines", ProgressKind::lines},
                                                           {"json", ProgressKind::json},
                                                           {"none", ProgressKind::none}};
  std::string progress = "auto";
  app.add_option("--progress", progress, "On standard error: auto, lines, json or none")
      ->check(CLI::IsMember({"auto", "lines", "json", "none"}))
      ->capture_default_str();
  app.add_flag("--check", command.check, "Load the scene, say how it was understood and what it needs, render nothing");
  app.add_flag("--list-accels", command.list_accels, "List the accelerators");
  app.add_flag("-q,--quiet", command.quiet, "Print nothing but errors, and where an unfinished render is kept");

  if (!parse_or_tell(app, argc, argv, exit_code)) return std::nullopt;
  command.progress = progress_names.at(progress);
  if (!first_sample.empty()) {
    throw Error(ErrorKind::usage, "--first-sample", "is no more: --samples A:B takes samples A to B - 1");
  }
  if (!samples.empty()) command.samples = parse_samples(samples);
  command.adaptive &= !even;
  if (command.samples && command.adaptive) {
    throw Error(ErrorKind::usage, "--adaptive",
                "counts the samples of each pixel by those of all others, which a part of them, --samples, does not "
                "have");
  }
  if (!checkpoint_every.empty()) command.checkpoint_every = parse_seconds("--checkpoint-every", checkpoint_every);
  if (!write_every.empty()) command.write_every = parse_seconds("--write-every", write_every);
  if (!time_limit.empty()) command.time_limit = parse_seconds("--time-limit", time_limit);
  if (command.quiet && command.progress == ProgressKind::automatic) command.progress = ProgressKind::none;
  if (command.scene.empty() && !command.list_accels) {
    std::fprintf(stderr, "raylab-render: a scene file or a model is missing (--help lists the options)\n");
    exit_code = static_cast<int>(ErrorKind::usage);
    return std::nullopt;
  }
  return command;
}

SampleRange parse_samples(const std::string& text) {
  SampleRange range;
  const char* const end = text.data() + text.size();
  const auto [colon, error] = std::from_chars(text.data(), end, range.first);
  if (error == std::errc() && colon != end && *colon == ':') {
    const auto [rest, error_of_end] = std::from_chars(colon + 1, end, range.end);
    if (error_of_end == std::errc() && rest == end && range.first < range.end) return range;
  }
  throw Error(ErrorKind::usage, "--samples", "found \"" + text + "\", expected A:B, of which A is less than B");
}

double parse_seconds(const std::string& option, const std::string& text) {
  double number = 0.0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  const std::string unit(rest, end);
  const double scale = unit.empty() || unit == "s" ? 1.0 : unit == "m" ? 60.0 : unit == "h" ? 3600.0 : 0.0;
  if (error == std::errc() && number * scale > 0.0 && number * scale < 1e9) return number * scale;
  throw Error(ErrorKind::usage, option, "found \"" + text + "\", expected a time such as 30s, 10m or 1h");
}

PixelRect parse_crop(const std::string& text) {
  PixelRect rect;
  const char* at = text.data();
  const char* const end = at + text.size();
  for (int* const number : {&rect.x, &rect.y, &rect.width, &rect.height}) {
    const auto [rest, error] = std::from_chars(at, end, *number);
    const bool last = number == &rect.height;
    if (error != std::errc() || (last ? rest != end : rest == end || *rest != ',')) {
      throw Error(ErrorKind::usage, "--crop", "found \"" + text + "\", expected X,Y,WIDTH,HEIGHT in pixels");
    }
    at = rest + 1;
  }
  return rect;
}

AcceleratorOptions accelerator_options(const PictureCommand& command) {
  AcceleratorOptions options;
  options.threads = command.threads;
  if (!command.quality.empty()) options.quality = parse_quality(command.quality);
  options.compact = command.compact;
  return options;
}

RenderOptions session_options(const RenderCommand& command, const LoadedScene& loaded) {
  RenderOptions options;
  options.camera = loaded.camera;
  const RenderSettings& settings = loaded.scene.render;
  const auto checked = [](const char* option, int value, int largest) {
    if (value >= 1 && value <= largest) return value;
    throw Error(ErrorKind::usage, option,
                "found " + std::to_string(value) + ", expected a number from 1 to " + std::to_string(largest));
  };
  constexpr int kLargestSide = 65536;
  options.width = command.width ? checked("--width", *command.width, kLargestSide) : settings.width;
  options.height = command.height ? checked("--height", *command.height, kLargestSide) : settings.height;
  const double aspect = static_cast<double>(settings.width) / settings.height;
  double width = options.width, height = options.height;
  if (command.width && !command.height) {
    height = std::max(1.0, std::round(width / aspect));
  } else if (command.height && !command.width) {
    width = std::max(1.0, std::round(height * aspect));
  }
  if (width * height > static_cast<double>(kMostPixels)) {
    throw Error(ErrorKind::usage, command.width ? "--width" : "--height",
                format("%.0f pixels are too many: found %.0f x %.0f, expected at most %" PRId64, width * height, width,
                       height, kMostPixels));
  }
  options.width = static_cast<int>(width);
  options.height = static_cast<int>(height);
  options.samples_per_pixel = static_cast<std::uint32_t>(command.spp.value_or(settings.samples_per_pixel));
  options.integrator.max_depth =
      command.max_depth ? checked("--max-depth", *command.max_depth, 1 << 20) : settings.max_depth;
  options.integrator.kind = parse_integrator(command.integrator);
  options.integrator.strategies = parse_strategies(command.strategies);
  options.integrator.ray_offset = command.ray_offset == "book" ? RayOffset::book : RayOffset::bounds;
  options.sampler = parse_sampler(command.sampler);
  options.seed = command.seed;
  options.target_error = command.target_error;
  options.adaptive = command.adaptive;
  if (command.samples) {
    if (command.spp && command.samples->end > static_cast<std::uint32_t>(*command.spp)) {
      throw Error(ErrorKind::usage, "--samples",
                  format("%s goes beyond the %d samples of --spp", to_string(*command.samples).c_str(), *command.spp));
    }
    options.first_sample = command.samples->first;
    options.samples_per_pixel = command.samples->end - command.samples->first;
  }
  options.tile_size = command.tile_size;
  if (!command.crop.empty()) options.crop = parse_crop(command.crop);
  if (command.needs == "all") options.needs = all_needs();
  return options;
}

}  // namespace raylab
