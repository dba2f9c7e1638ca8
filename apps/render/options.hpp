#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "raylab/core/progress.hpp"
#include "raylab/image/film_file.hpp"
#include "raylab/io/scene_file.hpp"
#include "raylab/render/render_session.hpp"

namespace CLI {
class App;
}

namespace raylab {

/// What raylab-render and raylab-preview both take: a scene, and how its picture is made.
struct PictureCommand {
  std::string scene;
  std::string accel = kDefaultAccelerator;
  std::string quality;  ///< empty: the default
  bool compact = false;
  std::string integrator = "path";
  std::string sampler = "sobol";
  std::optional<int> spp, width, height, max_depth;
  std::uint32_t seed = 0;
  int threads = 0;
  std::vector<std::string> overrides;
  std::string up;       ///< of a model: the axis that points up; empty: by its format
  bool ground = false;  ///< of a model

  /// How the scene is loaded. Throws Error (usage).
  LoadOptions load_options() const;
};

/// Adds the options of all that but the scene.
void add_picture_options(CLI::App& app, PictureCommand& command);

/// What the accelerator is to be built with. Throws Error (usage).
AcceleratorOptions accelerator_options(const PictureCommand& command);

/// The command line of raylab-render.
struct RenderCommand : PictureCommand {
  std::vector<std::string> outputs;
  std::string intersector;
  std::string isa;
  std::string strategies = "auto";
  std::string ray_offset = "bounds";
  std::string needs = "scene";
  std::optional<SampleRange> samples;
  bool film = false;
  bool resume = false;
  std::optional<double> checkpoint_every, write_every, time_limit;  ///< seconds
  std::optional<double> target_error;
  bool adaptive = false;
  std::string exr;  ///< half or float; empty: half where it holds the picture
  int tile_size = 16;
  std::string crop;
  std::vector<std::string> layers;
  std::string stats_file;
  std::string write_scene;
  bool views = false;
  std::optional<int> fly;  ///< frames
  ProgressKind progress = ProgressKind::automatic;
  bool check = false;
  bool list_accels = false;
  bool quiet = false;
  std::string command_line;  ///< as typed, for file attributes
};

/// Parses argv. Returns nothing when there is nothing left to do (--help, --version), with the exit code set.
std::optional<RenderCommand> parse_command(int argc, char** argv, int& exit_code);

/// What the session is to do: the scene's settings with the command line's on top. Throws Error (usage).
RenderOptions session_options(const RenderCommand& command, const LoadedScene& loaded);

/// "A:B", samples A to B - 1. Throws Error (usage).
SampleRange parse_samples(const std::string& text);

/// "10s", "5m", "2h", or seconds; more than none. Throws Error (usage) at the option.
double parse_seconds(const std::string& option, const std::string& text);

/// "X,Y,WIDTH,HEIGHT" in pixels. Throws Error (usage).
PixelRect parse_crop(const std::string& text);

}  // namespace raylab
