#include "preview.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "raylab/core/error.hpp"
#include "raylab/image/image_file.hpp"
#include "raylab/image/metrics.hpp"

namespace raylab {

namespace {

constexpr double kScriptFrame = 1.0 / 60.0;  // seconds: what a script does must not depend on the machine
constexpr double kIdleSeconds = 0.03;        // to wait for events where only a traced picture may change
constexpr double kRestingSeconds = 0.5;      // the same where nothing will change by itself
constexpr double kLookSeconds = 0.5;         // between two looks at the scene's files
constexpr int kSettlingFrames = 4;           // after an event: the display takes some to answer the pointer
// A full raster picture may take a second, which must not come between two moves.
constexpr double kRestSeconds = 0.25;
constexpr double kLongestStep = 0.1;  // seconds: a frame that took longer must not throw the camera far

std::vector<ScriptStep> read_script(const std::string& file) {
  if (file.empty()) return {};
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw Error(ErrorKind::input, file, "cannot be read");
  return parse_script(std::string(std::istreambuf_iterator<char>(stream), {}), file);
}

std::vector<std::string> accelerator_names() {
  std::vector<std::string> names;
  for (const AcceleratorEntry& entry : accelerators()) names.push_back(entry.name);
  return names;
}

CameraFile camera_file(const PreviewCommand& command, const LoadedScene& loaded) {
  if (!loaded.made_for_model) return CameraFile(command.scene);
  return CameraFile(std::filesystem::path(command.scene).replace_extension(".toml"), loaded.text);
}

bool same_view(const TraceRequest& a, const TraceRequest& b) {
  const auto view = [](const TraceRequest& r) {
    const CameraSettings& c = r.options.camera;
    return std::tuple(c.look_from.x, c.look_from.y, c.look_from.z, c.look_at.x, c.look_at.y, c.look_at.z, c.up.x,
                      c.up.y, c.up.z, c.vfov, c.defocus_angle, c.focus_distance, r.options.width, r.options.height);
  };
  return view(a) == view(b) && a.accel == b.accel;
}

}  // namespace

Preview::Preview(const PreviewCommand& command, LoadedScene loaded)
    : command_(command),
      loaded_(std::move(loaded)),
      scene_(loaded_.scene),
      watched_(loaded_.files),
      options_(preview_render_options(command, loaded_)),
      camera_file_(camera_file(command, loaded_)),
      shelf_(scene_.geometry, accelerator_options(command)),
      explorer_(scene_, loaded_.camera, camera_file_, shelf_, accelerator_names(), command.accel),
      window_("Raylab: " + scene_.name, options_.width, options_.height, !command.headless(), explorer_),
      raster_(scene_),
      hud_(window_.handle(), command.scale.value_or(window_.text_scale()), window_.units_per_pixel()),
      script_(read_script(command.script)),
      first_surfaces_(shelf_) {
  explorer_.set_views(loaded_.views);
  if (command.view == "traced") explorer_.set_view(View::traced);
  live_.emplace(scene_, shelf_);
}

Preview::~Preview() = default;

TraceRequest Preview::request_for(const std::string& accel) const {
  TraceRequest request{accel, options_};
  request.options.camera = explorer_.camera();
  request.options.width = width_;
  request.options.height = height_;
  return request;
}

void Preview::ask_for_pictures() {
  const bool traced = explorer_.view() == View::traced && width_ > 0;
  const auto ask = [&](LiveRender& live, std::optional<TraceRequest>& asked, std::uint64_t& number, bool wanted,
                       const std::string& accel) {
    if (!wanted) {
      live.rest();
      asked.reset();
      return;
    }
    TraceRequest request = request_for(accel);
    if (asked && same_view(*asked, request)) return;
    number = live.ask(request);
    asked = std::move(request);
  };
  ask(*live_, asked_, number_, traced, explorer_.accel());
  const bool both = traced && explorer_.compare() != Compare::off;
  if (both && !other_) other_.emplace(scene_, shelf_);
  if (other_) ask(*other_, asked_other_, other_number_, both, explorer_.other_accel());
}

bool Preview::has_plane_in_traced() const {
  const Compare compare = explorer_.compare();  // what differs is no picture of the scene
  return explorer_.shows_focus_plane() && (compare == Compare::off || compare == Compare::split);
}

bool Preview::is_still() const {
  if (moves_ || width_ == 0 || loading_.valid()) return false;
  if (explorer_.view() == View::raster) return true;
  const auto done = [](const LiveRender& live, std::uint64_t number) {
    const auto picture = live.latest();
    return !live.failure().empty() || (picture && picture->request == number && picture->complete);
  };
  if (!done(*live_, number_)) return false;
  if (has_plane_in_traced() && !first_surfaces_.known(explorer_.camera(), width_, height_)) return false;
  if (explorer_.compare() == Compare::off) return true;
  const bool compared = explorer_.compare() == Compare::split || (!comparing_.valid() && compared_ == comparing_what_);
  return done(*other_, other_number_) && compared;
}

bool Preview::reload(double now) {
  bool wanted = explorer_.take_reload_request();
  if (explorer_.take_written()) watched_.remember();  // that was no one else
  if (now >= next_look_) {
    next_look_ = now + kLookSeconds;
    wanted |= watched_.changed();
  }
  if (wanted && !loading_.valid()) {
    watched_.remember();
    loading_ = std::async(std::launch::async, [this] { return load_scene(command_.scene, command_.load_options()); });
  }
  if (!loading_.valid()) return false;
  if (loading_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return true;
  try {
    change_scene(loading_.get());
    explorer_.say("read the scene again");
  } catch (const Error& e) {
    explorer_.say(std::string(e.what()) + "; the scene stays as it was");
  }
  return true;
}

void Preview::change_scene(LoadedScene loaded) {
  options_ = preview_render_options(command_, loaded);
  tell_warnings(loaded);
  // Whoever reads the scene ends first.
  live_.reset();
  other_.reset();
  comparing_ = {};
  first_surfaces_.clear();
  shelf_.clear();
  raster_.reset();
  loaded_ = std::move(loaded);
  watched_ = WatchedFiles(loaded_.files);
  // What was written for a model is from then on the user's.
  if (!loaded_.made_for_model || !std::filesystem::exists(camera_file_.file())) {
    camera_file_ = camera_file(command_, loaded_);
  }
  explorer_.change_scene(loaded_.camera);
  explorer_.set_views(loaded_.views);
  raster_.emplace(scene_);
  live_.emplace(scene_, shelf_);
  asked_.reset();
  asked_other_.reset();
  shown_.reset();
  shown_other_.reset();
  compared_ = comparing_what_ = {};
}

/// Whether no display of building one is on the screen.
bool Preview::has_accelerators() const {
  return shelf_.find(explorer_.accel()) != nullptr &&
         (explorer_.compare() == Compare::off || shelf_.find(explorer_.other_accel()) != nullptr);
}

void Preview::run_script() {
  using Kind = ScriptStep::Kind;
  while (const ScriptStep* step = script_.next(drawn_still_)) {
    switch (step->kind) {
      case Kind::down:
        explorer_.key_down(step->key);
        break;
      case Kind::up:
        explorer_.key_up(step->key);
        break;
      case Kind::mouse:
        window_.move_mouse(step->x, step->y);
        break;
      case Kind::drag:
        explorer_.drag(step->x, step->y);
        break;
      case Kind::click:
        explorer_.click(step->x, step->y);
        break;
      case Kind::point:
        explorer_.point(step->x, step->y);
        break;
      case Kind::scroll:
        explorer_.scroll(step->x);
        break;
      case Kind::resize:
        window_.resize(static_cast<int>(step->x), static_cast<int>(step->y));
        break;
      case Kind::minimise:
        window_.minimise();
        break;
      case Kind::restore:
        window_.restore();
        break;
      case Kind::close:
        window_.ask_to_close();
        break;
      case Kind::screenshot:
        screenshots_.push_back(step->file);
        break;
      case Kind::picture:
        pictures_.push_back(step->file);
        break;
      case Kind::wait:
      case Kind::wait_still:
        break;  // the runner's own
    }
  }
}

void Preview::update_comparison() {
  const Compare kind = explorer_.compare();
  if (comparing_.valid() && comparing_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
    const ComparedPicture made = comparing_.get();
    compared_ = comparing_what_;
    compared_text_ = made.text;
    picture_view_.set_right(made.width, made.height, made.srgb);
  }
  if (comparing_.valid() || !shown_ || !shown_other_) return;
  const Compared what{
      kind, shown_->samples, shown_other_->samples, shown_->request, shown_other_->request, explorer_.exposure()};
  if (what == compared_) return;
  if (kind == Compare::split) {
    const Image& image = shown_other_->image;
    picture_view_.set_right(image.width, image.height,
                            what.exposure == 0.0 ? shown_other_->srgb : encode_srgb(image, what.exposure));
    compared_ = comparing_what_ = what;
    compared_text_ = "left " + shown_->accel + ", right " + shown_other_->accel;
    return;
  }
  comparing_what_ = what;
  comparing_ = std::async(
      std::launch::async, [kind, exposure = what.exposure, a = shown_, b = shown_other_, request = *asked_,
                           names = explorer_.accel() + " and " + explorer_.other_accel() + ", ",
                           left = shelf_.find(explorer_.accel()), right = shelf_.find(explorer_.other_accel())] {
        ComparedPicture made;
        Image image(1, 1);
        if (kind == Compare::disagreement && left != nullptr && right != nullptr) {
          RayComparison d =
              compare_rays(*left, *right, request.options.camera, request.options.width, request.options.height);
          made.text = names + d.text();
          image = std::move(d.picture);
        } else if (kind == Compare::difference && a->image.width == b->image.width &&
                   a->image.height == b->image.height) {
          const ImageError error = image_error(b->image, a->image);
          made.text = a->accel + " and " + b->accel + ": " + std::to_string(error.different_pixels) +
                      " pixels differ, relMSE " + std::to_string(error.relmse);
          image = error_picture(b->image, a->image);
        }
        made.width = image.width;
        made.height = image.height;
        // The colours of a disagreement are names, and no light.
        made.srgb = encode_srgb(image, kind == Compare::difference ? exposure : 0.0);
        return made;
      });
}

void Preview::draw_traced() {
  const auto picture = live_->latest();
  const double exposure = explorer_.exposure();
  const bool is_new = picture && (picture != shown_ || exposure != shown_exposure_);
  shown_ = picture;
  shown_exposure_ = exposure;
  if (is_new) {
    picture_view_.set_left(picture->image.width, picture->image.height,
                           exposure == 0.0 ? picture->srgb : encode_srgb(picture->image, exposure));
  }
  const Compare compare = explorer_.compare();
  if (compare != Compare::off) {
    shown_other_ = other_->latest();
    update_comparison();
  }
  const CameraSettings& camera = explorer_.camera();
  if (!shown_) return raster_->draw(camera, width_, height_, {moves_, explorer_.shows_focus_plane()});
  picture_view_.draw(width_, height_, compare == Compare::off ? 1.0f : compare == Compare::split ? 0.5f : 0.0f);
  if (!has_plane_in_traced()) return;
  if (!moves_ && first_surfaces_.update(camera, width_, height_)) {
    picture_view_.set_depths(first_surfaces_.width(), first_surfaces_.height(), first_surfaces_.depths());
  }
  // Without the depths of this very view the plane would cut through the wrong places.
  if (first_surfaces_.known(camera, width_, height_)) picture_view_.draw_plane(camera.focus_distance);
}

void Preview::draw() {
  if (explorer_.view() == View::traced) {
    draw_traced();
  } else {
    raster_->draw(explorer_.camera(), width_, height_, {moves_, explorer_.shows_focus_plane()});
  }
  // Before the display goes over it.
  for (const std::string& file : pictures_) save_picture(file);
  pictures_.clear();
  if (explorer_.take_save_request()) save_under_new_names();
  if (!command_.hud || !explorer_.shows_hud()) return;
  HudFigures figures;
  figures.longest_stop_seconds = live_->longest_stop_seconds();
  figures.width = width_;
  figures.height = height_;
  figures.triangles_drawn = raster_->triangles_drawn();
  figures.picture = shown_;
  figures.other = shown_other_;
  figures.samples_wanted = options_.samples_per_pixel;
  figures.comparison = compared_text_;
  figures.failure = live_->failure();
  hud_.draw(scene_, shelf_, explorer_, figures);
}

void Preview::save_picture(const std::string& file) {
  const bool traced = explorer_.view() == View::traced && shown_ && explorer_.compare() == Compare::off;
  write_image(file, traced ? shown_->image : read_framebuffer(width_, height_));
}

void Preview::save_under_new_names() {
  namespace fs = std::filesystem;
  std::string stem;
  for (int i = 1; stem.empty() || fs::exists(stem + ".png") || fs::exists(stem + ".exr"); ++i) {
    stem = scene_.name + "-preview-" + std::to_string(i);
  }
  try {
    save_picture(stem + ".png");
    save_picture(stem + ".exr");
    explorer_.say("saved " + stem + ".png and .exr");
  } catch (const Error& e) {
    explorer_.say(e.what());
  }
}

void Preview::end_frame() {
  const bool last = window_.closing() || explorer_.leaves();
  for (const std::string& file : screenshots_) write_image(file, read_framebuffer(width_, height_));
  screenshots_.clear();
  window_.swap();
  ++frames_;
  // By itself it leaves once there is nothing left to do.
  const bool script_ends = !command_.script.empty() && script_.finished();
  const bool frames_end = command_.frames && frames_ >= *command_.frames;
  const bool only_screenshot = command_.script.empty() && !command_.frames && !command_.screenshot.empty();
  if (last || script_ends || frames_end || (only_screenshot && drawn_still_)) window_.ask_to_close();
}

void Preview::run() {
  Stopwatch since_start;
  double before = since_start.seconds();
  while (!window_.closing() && !explorer_.leaves()) {
    const bool idle = (drawn_still_ || explorer_.view() == View::traced || loading_.valid()) && !command_.headless() &&
                      !explorer_.moved();
    const bool rests = idle && drawn_still_ && quiet_frames_ >= kSettlingFrames && has_accelerators();
    const bool heard = window_.poll(rests ? kRestingSeconds : idle ? kIdleSeconds : 0.0);
    quiet_frames_ = heard || !drawn_still_ ? 0 : quiet_frames_ + 1;
    const double now = since_start.seconds();
    frame_seconds_ = now - before;
    before = now;
    const bool reloads = reload(now);
    if (rests && !heard && !reloads) {  // what is on the screen stays right
      before = now;
      continue;
    }
    window_.size(width_, height_);
    explorer_.resize(width_, height_);
    run_script();
    explorer_.step(command_.headless() ? kScriptFrame : std::min(frame_seconds_, kLongestStep));
    if (explorer_.moved()) last_move_ = now;
    moves_ = explorer_.moved() || (!command_.headless() && now - last_move_ < kRestSeconds);
    ask_for_pictures();
    if (width_ > 0) {
      const bool still = is_still();  // before drawing: what comes in later is not in this frame
      draw();
      drawn_still_ = still;
    } else if (!command_.headless()) {
      window_.poll(kIdleSeconds);
    }
    end_frame();
  }
  if (command_.screenshot.empty()) return;
  draw();  // the back buffer's content is undefined after a swap
  write_image(command_.screenshot, read_framebuffer(width_, height_));
}

}  // namespace raylab
