#pragma once
#include <memory>
#include <string>

#include "explorer.hpp"
#include "live_render.hpp"

struct GLFWwindow;

namespace raylab {

/// What the head-up display shows besides the explorer's own state.
struct HudFigures {
  double longest_stop_seconds = 0.0;  ///< LiveRender's
  int width = 0, height = 0;
  std::size_t triangles_drawn = 0;               ///< of the raster view
  std::shared_ptr<const TracedPicture> picture;  ///< of the traced view, or null
  std::shared_ptr<const TracedPicture> other;    ///< of the accelerator compared with, or null
  std::uint32_t samples_wanted = 0;
  std::string comparison;  ///< a few lines about it
  std::string failure;
};

/// The head-up display, drawn with Dear ImGui.
class Hud {
 public:
  /// `scale`: text is so many times 13 pixels high. `units_per_pixel`: of the window.
  Hud(GLFWwindow* window, float scale, float units_per_pixel);
  ~Hud();
  Hud(const Hud&) = delete;
  Hud& operator=(const Hud&) = delete;

  /// Draws over the framebuffer bound for drawing.
  void draw(const Scene& scene, const AcceleratorShelf& shelf, const Explorer& explorer, const HudFigures& figures);
};

}  // namespace raylab
