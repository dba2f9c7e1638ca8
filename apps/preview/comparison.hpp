#pragma once
#include <cstdint>
#include <string>

#include "raylab/accel/accelerator.hpp"
#include "raylab/image/image.hpp"
#include "raylab/scene/camera.hpp"

namespace raylab {

/// How the camera rays of a picture, one through the middle of each pixel, fare in two accelerators.
struct RayComparison {
  /// Linear: dark grey where both say the same, else the colours below; the worse, the larger, up to 7 pixels square.
  Image picture = Image(1, 1);
  std::uint64_t rays = 0;
  std::uint64_t presence = 0;   ///< one hits and the other does not: red
  std::uint64_t distance = 0;   ///< t differs by more than 8 ulp: orange
  std::uint64_t primitive = 0;  ///< t agrees, the primitive does not: yellow
  std::uint64_t last_bits = 0;  ///< t, u or v differ otherwise: dim blue

  std::string text() const;  ///< three lines
};

RayComparison compare_rays(const Accelerator& a, const Accelerator& b, const CameraSettings& camera, int width,
                           int height);

}  // namespace raylab
