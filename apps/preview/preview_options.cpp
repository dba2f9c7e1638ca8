#include "preview_options.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "keys.hpp"
#include "raylab/apps/program.hpp"

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
  app.add_option("scene", command.scene, "Scene file (TOML), or a model (OBJ, PLY, STL or glTF)")->required();
  add_picture_options(app, command);
  app.add_option("--view", command.view, "View to start with: raster or traced")
      ->check(CLI::IsMember({"raster", "traced"}))
      ->capture_default_str();
  app.add_option("--script", command.script, "Do what this file says (keys, mouse, waits, screenshots), then leave");
  app.add_option("--frames", command.frames, "Leave after so many frames")->check(CLI::Range(1, 1 << 30));
  app.add_option("--screenshot", command.screenshot,
                 "Write the window as a PNG at the end; alone, after the first frame or the still picture");
  app.add_flag("!--no-hud", command.hud, "Show nothing but the picture");
  app.add_option("--scale", command.scale,
                 "Text so many times as large as 13 pixels (default: what the monitor asks for)")
      ->check(CLI::Range(0.5f, 8.0f));
  if (!parse_or_tell(app, argc, argv, exit_code)) return std::nullopt;
  return command;
}

void tell_warnings(const LoadedScene& loaded) {
  for (const std::string& warning : loaded.warnings)
    std::fprintf(stderr, "raylab-preview: warning: %s\n", warning.c_str());
}

RenderOptions preview_render_options(const PreviewCommand& command, const LoadedScene& loaded) {
  RenderCommand render;
  static_cast<PictureCommand&>(render) = command;
  RenderOptions options = session_options(render, loaded);
  if (!command.width && !command.height) {
    const double shrink = std::min({1.0, static_cast<double>(kWidestWindow) / options.width,
                                    static_cast<double>(kHighestWindow) / options.height});
    options.width = std::max(1, static_cast<int>(std::lround(options.width * shrink)));
    options.height = std::max(1, static_cast<int>(std::lround(options.height * shrink)));
  }
  return options;
}

}  // namespace raylab
