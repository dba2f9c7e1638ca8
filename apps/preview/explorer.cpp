#include "explorer.hpp"

#include <algorithm>
#include <cmath>

#include "raylab/core/error.hpp"
#include "raylab/core/text.hpp"
#include "raylab/scene/framing.hpp"

namespace raylab {

namespace {

constexpr double kFast = 5.0;
constexpr double kSlow = 0.2;
constexpr double kNotch = 1.25;             // speed by one notch of the wheel
constexpr double kRadiansPerPixel = 0.004;  // of mouse movement
constexpr double kFocusRate = 0.7;          // a second, of the logarithm of the distance
constexpr double kApertureRate = 1.0;       // the same of the defocus angle
constexpr double kFieldRate = 0.7;          // the same of the tangent of half the field of view
constexpr double kExposureStep = 0.5;       // stops by one press
constexpr double kMostExposure = 20.0;      // stops, either way
constexpr double kLeastAperture = 0.02;     // degrees: below, the lens closes to a pinhole

std::string number(double value) { return format("%.5g", value); }

}  // namespace

std::string_view compare_name(Compare compare) {
  switch (compare) {
    case Compare::off:
      return "off";
    case Compare::split:
      return "split";
    case Compare::difference:
      return "difference";
    case Compare::disagreement:
      return "disagreement";
  }
  return "";
}

Explorer::Explorer(const Scene& scene, const CameraSettings& camera, CameraFile& file, AcceleratorShelf& shelf,
                   std::vector<std::string> accels, const std::string& accel)
    : scene_(scene),
      first_camera_(camera),
      file_(file),
      shelf_(shelf),
      accels_(std::move(accels)),
      viewpoint_(camera),
      speed_(natural_speed(scene.geometry, camera)) {
  const auto chosen = std::find(accels_.begin(), accels_.end(), accel);
  if (chosen != accels_.end()) accel_ = static_cast<std::size_t>(chosen - accels_.begin());
  other_ = (accel_ + 1) % accels_.size();
  shelf_.want(accels_[accel_]);
}

void Explorer::key_down(Key key) {
  held_[static_cast<std::size_t>(key)] = true;
  const int digit = static_cast<int>(key) - static_cast<int>(Key::digit1);
  if (digit >= 0 && digit < 9) return choose_accel(static_cast<std::size_t>(digit));
  switch (key) {
    case Key::v:
      view_ = view_ == View::raster ? View::traced : View::raster;
      break;
    case Key::f:
      focus_plane_ = !focus_plane_;
      break;
    case Key::h:
      help_ = !help_;
      hud_ = true;
      break;
    case Key::u:
      hud_ = !hud_;
      break;
    case Key::m:
      captured_ = !captured_;
      break;
    case Key::p:
      save_ = true;
      break;
    case Key::f5:
      reload_ = true;
      break;
    case Key::escape:
      leaves_ = true;
      break;
    case Key::enter:
      write_camera();
      break;
    case Key::tab:
      toggle_orbit();
      break;
    case Key::c:
      compare_ = static_cast<Compare>((static_cast<int>(compare_) + 1) % 4);
      if (compare_ != Compare::off) view_ = View::traced;
      break;
    case Key::b:
      do other_ = (other_ + 1) % accels_.size();
      while (other_ == accel_ && accels_.size() > 1);
      break;
    case Key::minus:
      change_exposure(-kExposureStep);
      break;
    case Key::equal:
      change_exposure(kExposureStep);
      break;
    case Key::n:
      add_view();
      break;
    case Key::page_up:
      go_to_view(-1);
      break;
    case Key::page_down:
      go_to_view(1);
      break;
    case Key::home:
      viewpoint_.go_to(frame_scene(scene_, camera(), width_, height_));
      changed_ = true;
      break;
    case Key::backspace:
      viewpoint_ = Viewpoint(first_camera_);
      pivot_.reset();
      changed_ = true;
      break;
    default:
      break;
  }
}

void Explorer::key_up(Key key) { held_[static_cast<std::size_t>(key)] = false; }

void Explorer::change_exposure(double stops) {
  exposure_ = std::clamp(exposure_ + stops, -kMostExposure, kMostExposure);
  say(format("exposure %+g stops, of the path traced picture on the screen alone", exposure_));
}

void Explorer::choose_accel(std::size_t index) {
  if (index >= accels_.size()) return say("there is no accelerator " + std::to_string(index + 1));
  if (index == other_) other_ = accel_;
  accel_ = index;
  shelf_.want(accels_[accel_]);
  say("accelerator " + accels_[accel_]);
}

std::optional<Picked> Explorer::pick_at(double x, double y) {
  // Any accelerator that is there will do to find a point: waiting for one to be built would stop the window.
  const Accelerator* accelerator = shelf_.find(accel());
  for (std::size_t i = 0; accelerator == nullptr && i < accels_.size(); ++i) accelerator = shelf_.find(accels_[i]);
  if (accelerator == nullptr) {
    say("no accelerator is built yet");
    return std::nullopt;
  }
  const auto picked = pick(scene_, *accelerator, camera(), width_, height_, x, y);
  if (!picked) say("nothing there but background");
  return picked;
}

void Explorer::click(double x, double y) {
  const auto picked = pick_at(x, y);
  if (!picked) return;
  viewpoint_.set_focus_distance(picked->focus_distance);
  changed_ = true;
  say("focus on " + scene_.materials[picked->material].name + " at " + number(picked->focus_distance));
}

void Explorer::toggle_orbit() {
  if (pivot_) {
    pivot_.reset();
    return say("flying");
  }
  const bool at_pointer = !captured_;
  pivot_ = pick_at(at_pointer ? pointer_.x : 0.5 * width_, at_pointer ? pointer_.y : 0.5 * height_);
  if (pivot_) {
    const vec3& p = pivot_->point;
    say("orbiting around " + number(p.x) + ", " + number(p.y) + ", " + number(p.z));
  }
}

void Explorer::write_camera() {
  try {
    const bool wrote = file_.write(camera());
    say(wrote ? "camera written to " + file_.file().string() : "the file has this camera already");
    first_camera_ = camera();
    written_ = true;
  } catch (const Error& e) {
    say(std::string(e.what()) + "; Enter again writes the camera into it");
  }
}

void Explorer::add_view() {
  try {
    const std::string name = file_.add_view(camera());
    say("view " + name + " added to " + file_.file().string());
    views_.push_back({name, camera()});
    at_view_ = views_.size() - 1;
    written_ = true;
  } catch (const Error& e) {
    say(std::string(e.what()) + "; the same key again adds the view to it");
  }
}

void Explorer::go_to_view(int step) {
  if (views_.empty()) return say("the scene has no views yet");
  const auto count = static_cast<int>(views_.size());
  const int from = at_view_ ? static_cast<int>(*at_view_) : step > 0 ? -1 : 0;
  at_view_ = static_cast<std::size_t>((from + step + count) % count);
  viewpoint_ = Viewpoint(views_[*at_view_].camera);
  pivot_.reset();
  changed_ = true;
  say("view " + views_[*at_view_].name);
}

void Explorer::drag(double dx, double dy) {
  if (dx == 0.0 && dy == 0.0) return;
  const double yaw = dx * kRadiansPerPixel, pitch = -dy * kRadiansPerPixel;
  if (pivot_) {
    viewpoint_.orbit(dvec3(pivot_->point), -yaw, -pitch);
  } else {
    viewpoint_.turn(yaw, pitch);
  }
  changed_ = true;
}

void Explorer::point(double x, double y) { pointer_ = {x, y}; }

void Explorer::scroll(double notches) {
  speed_ *= std::pow(kNotch, notches);
  say("speed " + number(speed_) + " a second");
}

void Explorer::change_scene(const CameraSettings& camera) {
  if (camera != first_camera_) viewpoint_ = Viewpoint(camera);
  first_camera_ = camera;
  pivot_.reset();
  shelf_.want(accel());
  changed_ = true;
}

void Explorer::resize(int width, int height) {
  width_ = std::max(width, 1);
  height_ = std::max(height, 1);
}

void Explorer::step(double seconds) {
  const auto axis = [&](bool more, bool less) { return static_cast<double>(more) - static_cast<double>(less); };
  const dvec3 way(axis(held(Key::d), held(Key::a)),
                  axis(held(Key::space) || held(Key::r), held(Key::e) || held(Key::q)),
                  axis(held(Key::w), held(Key::s)));
  if (way != dvec3(0.0)) {
    const double pace = (held(Key::shift) ? kFast : 1.0) * (held(Key::control) ? kSlow : 1.0);
    viewpoint_.move(way * (speed_ * pace * seconds));
    changed_ = true;
  }
  const double focus = axis(held(Key::up), held(Key::down));
  if (focus != 0.0) {
    viewpoint_.set_focus_distance(camera().focus_distance * std::exp(focus * kFocusRate * seconds));
    changed_ = true;
  }
  const double aperture = axis(held(Key::right_bracket), held(Key::left_bracket));
  if (aperture != 0.0) {
    const double now = std::max<double>(camera().defocus_angle, kLeastAperture);
    const double next = now * std::exp(aperture * kApertureRate * seconds);
    viewpoint_.set_defocus_angle(next < kLeastAperture ? 0.0 : next);
    changed_ = true;
  }
  const double field = axis(held(Key::x), held(Key::z));
  if (field != 0.0) {
    const double half = std::tan(0.5 * camera().vfov * kPi / 180.0) * std::exp(field * kFieldRate * seconds);
    viewpoint_.set_vfov(2.0 * std::atan(half) * 180.0 / kPi);
    changed_ = true;
  }
  moved_ = changed_;
  changed_ = false;
}

}  // namespace raylab
