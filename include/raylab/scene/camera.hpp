#pragma once
#include "raylab/core/ray.hpp"
#include "raylab/core/vec.hpp"

namespace raylab {

/// The camera as a scene file gives it.
struct CameraSettings {
  vec3 look_from = vec3(0.0f, 0.0f, 0.0f);
  vec3 look_at = vec3(0.0f, 0.0f, -1.0f);
  vec3 up = vec3(0.0f, 1.0f, 0.0f);
  float vfov = 90.0f;            ///< degrees, vertical, in (0, 180)
  float defocus_angle = 0.0f;    ///< degrees, full angle of the cone from the lens to the point in focus; 0: pinhole
  float focus_distance = 10.0f;  ///< along the view direction; > 0

  bool operator==(const CameraSettings&) const = default;
};

/// Thin-lens camera (Ray Tracing in One Weekend §12-13): makes the rays of a width x height picture.
class Camera {
 public:
  /// Throws Error (input) when look_from = look_at, the view runs along up, or a value is out of range.
  Camera(const CameraSettings& settings, int width, int height);

  /// Ray through picture position (x, y) in pixels, (0, 0) the upper left corner of the picture, from the point of
  /// the lens that `lens` in [0,1)² chooses. Direction not normalised: t = 1 lies in the plane of focus.
  Ray ray(float x, float y, const vec2& lens) const;

  /// What rays are made of.
  struct Rays {
    vec3 origin;
    vec3 corner;          ///< from the eye to the upper left corner of the picture in the plane of focus
    vec3 step_x, step_y;  ///< of one pixel
    vec3 lens_x, lens_y;  ///< from the centre of the lens to its rim
    bool has_lens;
    bool narrow;  ///< a pixel is so small that rounding would move it: corner and steps are read from `exact`
    struct {
      dvec3 corner, step_x, step_y;
    } exact;
  };
  const Rays& rays() const { return rays_; }

  bool has_lens() const { return rays_.has_lens; }

  vec3 origin() const { return rays_.origin; }
  vec3 forward() const { return forward_; }  ///< unit
  vec3 right() const { return right_; }      ///< unit
  vec3 up() const { return up_; }            ///< unit, perpendicular to the view

 private:
  Rays rays_;
  vec3 forward_, right_, up_;
};

}  // namespace raylab
