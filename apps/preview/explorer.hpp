#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "accelerator_shelf.hpp"
#include "keys.hpp"
#include "picking.hpp"
#include "raylab/io/camera_file.hpp"
#include "raylab/io/scene_file.hpp"
#include "viewpoint.hpp"

namespace raylab {

enum class View : std::uint8_t { raster, traced };

/// What is shown of two accelerators.
enum class Compare : std::uint8_t {
  off,
  split,         ///< one left, the other right
  difference,    ///< of their pictures
  disagreement,  ///< of their answers to the camera rays
};
std::string_view compare_name(Compare compare);

/// What keys and mouse do, without a window: the state of the preview and all that changes it.
class Explorer {
 public:
  /// The first of `accels` that is `accel` is chosen, and
  /// the next one is what it is compared with. Everything must outlive the explorer.
  Explorer(const Scene& scene, const CameraSettings& camera, CameraFile& file, AcceleratorShelf& shelf,
           std::vector<std::string> accels, const std::string& accel);

  void key_down(Key key);
  void key_up(Key key);
  /// Lets all keys go, as when the window loses the keyboard.
  void release_keys() { held_.fill(false); }

  /// The mouse moved by so many pixels while looking.
  void drag(double dx, double dy);
  /// Where the pointer is, in pixels of the picture from its upper left corner.
  void point(double x, double y);
  /// Focuses on what is there.
  void click(double x, double y);
  void scroll(double notches);
  void resize(int width, int height);

  /// Moves on by so many seconds with the keys that are held.
  void step(double seconds);

  /// The scene is another one now, with this camera in its file: goes there if the file's camera has changed.
  void change_scene(const CameraSettings& camera);

  /// The scene's views, which keys go to.
  void set_views(std::vector<NamedView> views) {
    views_ = std::move(views);
    at_view_.reset();
  }

  const CameraSettings& camera() const { return viewpoint_.settings(); }
  const Viewpoint& viewpoint() const { return viewpoint_; }
  bool moved() const { return moved_; }  ///< in the last step
  View view() const { return view_; }
  Compare compare() const { return compare_; }
  const std::string& accel() const { return accels_[accel_]; }
  const std::string& other_accel() const { return accels_[other_]; }
  const std::vector<std::string>& accels() const { return accels_; }
  bool shows_focus_plane() const { return focus_plane_; }
  double exposure() const { return exposure_; }  ///< stops by which the traced picture is shown brighter than it is
  const glm::dvec2& pointer() const { return pointer_; }  ///< in pixels of the picture from its upper left corner
  bool shows_help() const { return help_; }
  bool shows_hud() const { return hud_; }
  bool captures_mouse() const { return captured_; }
  bool leaves() const { return leaves_; }
  double speed() const { return speed_; }                        ///< scene units a second, before Shift and Ctrl
  const std::optional<Picked>& pivot() const { return pivot_; }  ///< of the orbit; absent: flying
  const std::string& message() const { return message_; }
  void say(std::string message) { message_ = std::move(message); }
  void set_view(View view) { view_ = view; }

  /// Whether a picture was asked for since the last call.
  bool take_save_request() { return std::exchange(save_, false); }
  /// Whether the scene is to be read again, the same.
  bool take_reload_request() { return std::exchange(reload_, false); }
  /// Whether the camera was written to the scene file, the same.
  bool take_written() { return std::exchange(written_, false); }

 private:
  bool held(Key key) const { return held_[static_cast<std::size_t>(key)]; }
  std::optional<Picked> pick_at(double x, double y);
  void change_exposure(double stops);
  void choose_accel(std::size_t index);
  void toggle_orbit();
  void write_camera();
  void add_view();
  void go_to_view(int step);

  const Scene& scene_;
  CameraSettings first_camera_;
  CameraFile& file_;
  AcceleratorShelf& shelf_;
  std::vector<std::string> accels_;
  std::size_t accel_ = 0, other_ = 0;
  Viewpoint viewpoint_;
  std::vector<NamedView> views_;
  std::optional<std::size_t> at_view_;  ///< gone to last
  double speed_;
  std::array<bool, kKeyCount> held_{};
  View view_ = View::raster;
  Compare compare_ = Compare::off;
  bool focus_plane_ = false, help_ = false, hud_ = true, captured_ = false, leaves_ = false, save_ = false,
       reload_ = false, written_ = false;
  bool moved_ = false, changed_ = false;
  std::optional<Picked> pivot_;
  int width_ = 1, height_ = 1;
  glm::dvec2 pointer_{-1.0};
  double exposure_ = 0.0;
  std::string message_;
};

}  // namespace raylab
