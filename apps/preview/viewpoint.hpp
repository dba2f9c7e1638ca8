#pragma once
#include "raylab/geometry/geometry.hpp"
#include "raylab/scene/camera.hpp"

namespace raylab {

/// Where a camera stands and looks, as one flies it. Kept in double, so that many small steps add up; unmoved, it
/// gives back the very settings it was made from.
class Viewpoint {
 public:
  explicit Viewpoint(const CameraSettings& settings);

  /// Moves by so much along the view's right, the up vector and the view direction, in scene units.
  void move(const dvec3& right_up_forward);

  /// Turns the view by angles in radians: to the right around the up vector, and upwards. Stops short of looking
  /// along the up vector, where there is no camera.
  void turn(double yaw, double pitch);

  /// Turns eye and view around a point: the eye goes to the right and upwards, and what was seen of the point
  /// stays at its place in the picture.
  void orbit(const dvec3& pivot, double yaw, double pitch);

  /// Goes where these settings stand and look, with the lens as it is.
  void go_to(const CameraSettings& settings);

  void set_focus_distance(double distance);  ///< clamped to what a camera accepts
  void set_defocus_angle(double degrees);    ///< the same
  void set_vfov(double degrees);             ///< the same

  const CameraSettings& settings() const { return settings_; }
  dvec3 position() const { return position_; }
  dvec3 forward() const;  ///< unit

 private:
  void rotate_view(const dvec3& axis, double angle);
  double allowed_pitch(double pitch) const;
  void update();

  CameraSettings settings_;
  dvec3 position_, target_;
  dvec3 up_;  ///< unit
};

/// Scene units a second that feel neither slow nor fast: a quarter of the scene's diagonal, or half the distance
/// to what the camera looks at where that is less, as with a ground sphere of radius 1000 under a table's worth of
/// balls.
double natural_speed(const Geometry& geometry, const CameraSettings& camera);

}  // namespace raylab
