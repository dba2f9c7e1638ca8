#pragma once
#include <future>
#include <vector>

#include "accelerator_shelf.hpp"
#include "raylab/scene/camera.hpp"

namespace raylab {

/// How far along the view direction the first surface lies, seen from the middle of the lens through the middle of
/// each pixel; infinity where there is only background. From the upper left.
std::vector<float> first_depths(const Accelerator& accelerator, const CameraSettings& camera, int width, int height);

/// Finds the depths of a view on threads of its own: what the focus plane hides in the traced view. They are kept
/// until the view changes, so that the plane can move through them.
class FirstSurfaces {
 public:
  /// The shelf must outlive it.
  explicit FirstSurfaces(AcceleratorShelf& shelf) : shelf_(shelf) {}

  /// Starts finding the depths of a view, unless they are known or others are being found. Never waits. Returns
  /// whether depths have come in since the last call.
  bool update(const CameraSettings& camera, int width, int height);

  /// Whether depths() are those of this view.
  bool known(const CameraSettings& camera, int width, int height) const;

  /// Forgets all depths, after waiting for those that are being found.
  void clear() {
    finding_ = {};
    known_ = {};
  }

  int width() const { return known_.width; }
  int height() const { return known_.height; }
  const std::vector<float>& depths() const { return depths_; }

 private:
  /// What depths depend on: not on focus and aperture.
  struct Seen {
    vec3 from{}, at{}, up{};
    float vfov = 0.0f;
    int width = 0, height = 0;
    bool operator==(const Seen&) const = default;
  };
  static Seen seen(const CameraSettings& camera, int width, int height);

  AcceleratorShelf& shelf_;
  Seen known_, sought_;
  std::vector<float> depths_;
  std::future<std::vector<float>> finding_;
};

}  // namespace raylab
