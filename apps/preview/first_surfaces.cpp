#include "first_surfaces.hpp"

#include <chrono>

#include "raylab/core/parallel.hpp"

namespace raylab {

std::vector<float> first_depths(const Accelerator& accelerator, const CameraSettings& settings, int width, int height) {
  CameraSettings pinhole = settings;
  pinhole.defocus_angle = 0.0f;
  const Camera camera(pinhole, width, height);
  std::vector<float> depths(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), kInfinity);
  parallel_for(static_cast<std::size_t>(height), [&](std::size_t y) {
    float* row = &depths[y * static_cast<std::size_t>(width)];
    for (int x = 0; x < width; ++x) {
      const Ray ray = camera.ray(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, vec2(0.5f));
      const std::optional<Hit> hit = accelerator.intersect(ray);
      if (hit) row[x] = hit->t * settings.focus_distance;  // t = 1 lies in the plane of focus
    }
  });
  return depths;
}

FirstSurfaces::Seen FirstSurfaces::seen(const CameraSettings& c, int width, int height) {
  return {c.look_from, c.look_at, c.up, c.vfov, width, height};
}

bool FirstSurfaces::known(const CameraSettings& camera, int width, int height) const {
  return known_ == seen(camera, width, height);
}

bool FirstSurfaces::update(const CameraSettings& camera, int width, int height) {
  const bool came = finding_.valid() && finding_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  if (came) {
    depths_ = finding_.get();
    known_ = sought_;
  }
  if (finding_.valid() || known(camera, width, height)) return came;
  sought_ = seen(camera, width, height);
  // With one that is fast, whichever traces the picture: the slow ones would take minutes.
  finding_ = std::async(std::launch::async, [this, camera, width, height] {
    return first_depths(shelf_.get(kDefaultAccelerator), camera, width, height);
  });
  return came;
}

}  // namespace raylab
