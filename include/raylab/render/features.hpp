#pragma once
#include <vector>

#include "raylab/render/render_session.hpp"

namespace raylab {

/// Means over a pixel's camera rays of what they meet first. Where a ray meets nothing it adds 0; depth is the mean
/// over the rays that hit, infinite where none does.
struct FirstHitFeatures {
  Image albedo;              ///< colour of the material; white for glass; radiance of a light, clamped to [0, 1]
  Image normal;              ///< unit shading normal in world space, facing the camera
  std::vector<float> depth;  ///< distance along the view direction, in world units
};

/// Features of the pixels that a session with these options renders, from the first `samples` of its samples.
FirstHitFeatures first_hit_features(const Scene& scene, const Accelerator& accelerator, const RenderOptions& options,
                                    std::uint32_t samples);

}  // namespace raylab
