#pragma once
// The rays that a scene's own paths send, and rays at the edges and vertices of its meshes.
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "raylab/accel/accelerator.hpp"
#include "raylab/render/render_session.hpp"
#include "raylab/scene/scene.hpp"

namespace raylab {

enum class RayKind { primary, diffuse, shadow, edge, vertex };
std::string_view ray_kind_name(RayKind kind);

/// Rays of one kind; `shadow` rays ask for occlusion, the others for the closest hit.
struct RaySet {
  RayKind kind;
  std::vector<Ray> rays;
};

/// `count` of the rays, evenly spaced in their order, or all if there are fewer.
std::vector<Ray> evenly_spaced(std::span<const Ray> rays, std::size_t count);

/// Up to `count` rays each of kind primary (from the camera), diffuse (continuing a path, whatever the material) and
/// shadow (to a sampled light), as a RenderSession sends them for a picture of about `count` pixels: spread evenly
/// over it, in its order. A kind that the scene's paths never send is empty.
std::vector<RaySet> path_ray_sets(const Scene& scene, const CameraSettings& camera, const Accelerator& accelerator,
                                  const IntegratorSettings& settings, std::size_t count, std::uint32_t seed);

/// Up to `count` rays aimed at edges that two triangles share, and at their ends, which nothing in front hides
/// according to `accelerator`. They start where `origins` do. Empty where no triangles share an edge.
std::vector<RaySet> outline_ray_sets(const Geometry& geometry, const Accelerator& accelerator,
                                     std::span<const Ray> origins, std::size_t count, std::uint64_t seed);

}  // namespace raylab
