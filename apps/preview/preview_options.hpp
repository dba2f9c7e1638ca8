#pragma once
#include <optional>
#include <string>

#include "options.hpp"
#include "raylab/render/render_session.hpp"

namespace raylab {

/// The command line of raylab-preview.
struct PreviewCommand : PictureCommand {
  std::string view = "raster";
  std::string script;
  std::optional<int> frames;
  std::string screenshot;
  bool hud = true;
  std::optional<float> scale;  ///< of the text; absent: the monitor's

  /// Whether it runs by itself: no one is there to wait for, and frames follow each other by a fixed time.
  bool headless() const { return !script.empty() || frames || !screenshot.empty(); }
};

/// Parses argv. Returns nothing when there is nothing left to do (--help, --version), with the exit code set.
std::optional<PreviewCommand> parse_preview_command(int argc, char** argv, int& exit_code);

/// What raylab-render would do with the same options, at the size the window starts with: the scene's own, made
/// smaller in proportion where it would not fit a screen. Throws Error (usage).
RenderOptions preview_render_options(const PreviewCommand& command, const LoadedScene& loaded);

/// Writes the loading's warnings to the error stream.
void tell_warnings(const LoadedScene& loaded);

}  // namespace raylab
