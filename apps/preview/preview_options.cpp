#include "preview_options.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "keys.hpp"
#include "options.hpp"
#include "raylab/core/error.hpp"

namespace raylab {

namespace {
constexpr int kWidestWindow = 1280;
constexpr int kHighestWindow = 900;
}  // namespace

std::optional<PreviewCommand> parse_preview_command(int argc, char** argv, int& exit_code) {
  PreviewCommand command;
  CLI::App app{"Flies through a scene, path traced or as an OpenGL raster picture, and writes the camera back."};
  app.name("raylab-preview");
  app.set_version_flag("--version", std::string("raylab-preview ") + RAYLAB_VERSION);
  app.footer("Keys:\n" + key_help_text());
  app.add_option("scene", command.scene, "Scene file (TOML)")->required();
  app.add_option("--accel", command.accel, "Accelerator to start with, see raylab-render --list-accels")
      ->capture_default_str();
  app.add_option("--integrator", command.integrator, "path or book")->capture_default_str();
  app.add_option("--sampler", command.sampler, "independent or sobol")->capture_default_str();
  app.add_option("--view", command.view, "View to start with: raster or traced")
      ->check(CLI::IsMember({"raster", "traced"}))
      ->capture_default_str();
  app.add_option("--spp", command.spp, "Samples per pixel of the still picture")->check(CLI::Range(1, 1 << 30));
  app.add_option("--width", command.width, "Window width in pixels; alone, it keeps the scene's aspect ratio");
  app.add_option("--height", command.height, "Window height in pixels; alone, it keeps the scene's aspect ratio");
  app.add_option("--max-depth", command.max_depth, "Path segments, the camera ray included");
  app.add_option("--seed", command.seed, "Seed of all random numbers")->capture_default_str();
  app.add_option("--threads", command.threads, "Threads for building and tracing; 0: all")
      ->check(CLI::Range(0, 4096))
      ->capture_default_str();
  app.add_option("--set", command.overrides, "KEY=VALUE for any key of the scene file; repeatable")
      ->allow_extra_args(false);
  app.add_option("--script", command.script,
                 "Do what this file says (keys, mouse, waits, screenshots), then leave");
  app.add_option("--frames", command.frames, "Leave after so many frames")->check(CLI::Range(1, 1 << 30));
  app.add_option("--screenshot", command.screenshot,
                 "Write the window as a PNG at the end; alone, after the first frame or the still picture");
  app.add_flag("!--no-hud", command.hud, "Show nothing but the picture");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) {
      exit_code = app.exit(e);
    } else {
      std::fprintf(stderr, "raylab-preview: %s\nRun with --help for the options.\n", e.what());
      exit_code = static_cast<int>(ErrorKind::usage);
    }
    return std::nullopt;
  }
  return command;
}

RenderOptions preview_render_options(const PreviewCommand& command, const Scene& scene) {
  RenderCommand render;
  render.integrator = command.integrator;
  render.sampler = command.sampler;
  render.spp = command.spp;
  render.width = command.width;
  render.height = command.height;
  render.max_depth = command.max_depth;
  render.seed = command.seed;
  RenderOptions options = session_options(render, scene);
  if (!command.width && !command.height) {
    const double shrink = std::min({1.0, static_cast<double>(kWidestWindow) / options.width,
                                    static_cast<double>(kHighestWindow) / options.height});
    options.width = std::max(1, static_cast<int>(std::lround(options.width * shrink)));
    options.height = std::max(1, static_cast<int>(std::lround(options.height * shrink)));
  }
  return options;
}

}  // namespace raylab
