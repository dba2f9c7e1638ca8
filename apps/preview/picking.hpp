#pragma once
#include <optional>

#include "raylab/accel/accelerator.hpp"
#include "raylab/scene/camera.hpp"
#include "raylab/scene/scene.hpp"

namespace raylab {

/// What lies at a place of the picture.
struct Picked {
  vec3 point;
  float focus_distance;  ///< along the view direction, as a camera's
  std::uint32_t geometry, primitive;
  std::uint32_t material;
};

/// What the camera sees at (x, y), in pixels of a width x height picture from its upper left corner, from the
/// middle of the lens; nothing where there is only background.
std::optional<Picked> pick(const Scene& scene, const Accelerator& accelerator, const CameraSettings& camera, int width,
                           int height, double x, double y);

}  // namespace raylab
