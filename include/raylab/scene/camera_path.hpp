#pragma once
#include <span>

#include "raylab/scene/camera.hpp"

namespace raylab {

/// The camera at a place of the path through others: `place` 0 is at the first, 1 at the second, and so on. Eye and
/// target follow Catmull-Rom splines (Catmull and Rom 1974), which pass through all of them without a corner; the rest
/// changes evenly. `cameras` holds one or more; places beyond its ends are the ends.
CameraSettings camera_on_path(std::span<const CameraSettings> cameras, double place);

}  // namespace raylab
