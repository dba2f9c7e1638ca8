#pragma once
#include "raylab/core/ray.hpp"
#include "raylab/core/warp.hpp"

namespace raylab {

/// The camera as a scene file gives it.
struct CameraSettings {
  vec3 look_from = vec3(0.0f, 0.0f, 0.0f);
  vec3 look_at = vec3(0.0f, 0.0f, -1.0f);
  vec3 up = vec3(0.0f, 1.0f, 0.0f);
  float vfov = 90.0f;           ///< degrees, vertical, in (0, 180)
  float defocus_angle = 0.0f;   ///< degrees, full angle of the cone from the lens to the point in focus; 0: pinhole
  float focus_distance = 10.0f;  ///< along the view direction; > 0
};

/// Thin-lens camera (Ray Tracing in One Weekend §12-13): makes the rays of a width x height picture.
class Camera {
 public:
  /// Throws Error (input) when look_from = look_at, the view runs along up, or a value is out of range.
  Camera(const CameraSettings& settings, int width, int height);

  /// Ray through picture position (x, y) in pixels, (0, 0) the upper left corner of the picture, from the point of
  /// the lens that `lens` in [0,1)² chooses. Direction not normalised: t = 1 lies in the plane of focus.
  Ray ray(float x, float y, const vec2& lens) const;

  /// The same for lanes of type F (core/lanes.hpp).
  template <class F>
  void ray(const F& x, const F& y, const Vec2Of<F>& lens, Vec3Of<F>& origin, Vec3Of<F>& direction) const {
    using Vec3 = Vec3Of<F>;
    direction = Vec3(corner_) + x * Vec3(step_x_) + y * Vec3(step_y_);
    origin = Vec3(origin_);
    if (!has_lens_) return;
    F disk_x, disk_y;
    concentric_disk<F>(lens.x, lens.y, disk_x, disk_y);
    const Vec3 shift = disk_x * Vec3(lens_x_) + disk_y * Vec3(lens_y_);
    origin = origin + shift;
    direction = direction - shift;
  }

  bool has_lens() const { return has_lens_; }

  vec3 origin() const { return origin_; }
  vec3 forward() const { return forward_; }  ///< unit
  vec3 right() const { return right_; }      ///< unit
  vec3 up() const { return up_; }            ///< unit, perpendicular to the view

 private:
  vec3 origin_, forward_, right_, up_;
  vec3 corner_;  ///< from the eye to the upper left corner of the picture in the plane of focus
  vec3 step_x_, step_y_;  ///< of one pixel
  vec3 lens_x_, lens_y_;
  bool has_lens_;
};

}  // namespace raylab
