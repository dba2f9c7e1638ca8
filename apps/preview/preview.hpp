#pragma once
#include <future>
#include <optional>

#include "comparison.hpp"
#include "explorer.hpp"
#include "first_surfaces.hpp"
#include "hud.hpp"
#include "live_render.hpp"
#include "picture_view.hpp"
#include "preview_options.hpp"
#include "raster_view.hpp"
#include "raylab/io/scene_file.hpp"
#include "script.hpp"
#include "watched_files.hpp"
#include "window.hpp"

namespace raylab {

/// The running program: each frame it hears what happened, asks for what is to be traced, and draws.
class Preview {
 public:
  /// Opens the window. Throws Error: input and usage before anything is shown, failure without OpenGL 3.3.
  Preview(const PreviewCommand& command, LoadedScene loaded);
  ~Preview();

  /// Until the user leaves, or the script or the number of frames ends.
  void run();

 private:
  /// What a picture of the comparison was made from; a new one is made when it changes.
  struct Compared {
    Compare kind = Compare::off;
    std::uint64_t left = 0, right = 0;  // samples and requests of the two pictures
    std::uint64_t left_request = 0, right_request = 0;
    double exposure = 0.0;
    bool operator==(const Compared&) const = default;
  };
  struct ComparedPicture {
    int width = 0, height = 0;
    std::vector<std::uint8_t> srgb;
    std::string text;
  };

  /// Reads the scene again where that is asked for or its files have changed. Returns whether there is news to draw.
  bool reload(double now);
  void change_scene(LoadedScene loaded);
  void run_script();
  void ask_for_pictures();
  bool is_still() const;
  bool has_accelerators() const;
  bool has_plane_in_traced() const;
  void draw();
  void draw_traced();
  void update_comparison();
  void end_frame();
  void save_picture(const std::string& file);
  void save_under_new_names();
  TraceRequest request_for(const std::string& accel) const;

  const PreviewCommand& command_;
  LoadedScene loaded_;
  const Scene& scene_;
  WatchedFiles watched_;
  double next_look_ = 0.0;  // at the files, in seconds since the start
  RenderOptions options_;
  CameraFile camera_file_;
  AcceleratorShelf shelf_;
  Explorer explorer_;
  Window window_;
  std::optional<RasterView> raster_;
  PictureView picture_view_;
  Hud hud_;
  ScriptRunner script_;

  std::optional<LiveRender> live_, other_;
  std::optional<TraceRequest> asked_, asked_other_;
  std::uint64_t number_ = 0, other_number_ = 0;
  std::shared_ptr<const TracedPicture> shown_, shown_other_;
  double shown_exposure_ = 0.0;

  FirstSurfaces first_surfaces_;
  std::future<LoadedScene> loading_;
  std::future<ComparedPicture> comparing_;
  Compared comparing_what_, compared_;
  std::string compared_text_;

  int width_ = 0, height_ = 0;
  double frame_seconds_ = 0.0;
  int frames_ = 0;
  double last_move_ = -1.0;  // seconds since the start
  bool moves_ = false;
  int quiet_frames_ = 0;                             // drawn still since anything was heard of
  bool drawn_still_ = false;                         // the frame before was drawn with nothing left to come
  std::vector<std::string> screenshots_, pictures_;  // to be made at the end of this frame
};

}  // namespace raylab
