#pragma once
#include <cstdint>
#include <string_view>
#include <utility>

#include "raylab/accel/accelerator.hpp"
#include "raylab/render/lights.hpp"
#include "raylab/render/sampler.hpp"
#include "raylab/scene/needs.hpp"
#include "raylab/scene/scene.hpp"

namespace raylab {

enum class IntegratorKind : std::uint8_t {
  path,  ///< light sampling, multiple importance sampling, Russian roulette
  book,  ///< BSDF sampling alone to the fixed depth, as in Ray Tracing in One Weekend
};

/// Throws Error (usage) for an unknown name.
IntegratorKind parse_integrator(std::string_view name);
std::string_view integrator_name(IntegratorKind kind);

/// How a continued ray keeps off the surface it starts on.
enum class RayOffset : std::uint8_t {
  bounds,  ///< starts outside the hit point's error bound (see SurfacePoint)
  book,    ///< starts at the hit point with t_min = 0.001, for comparison
};

struct IntegratorSettings {
  IntegratorKind kind = IntegratorKind::path;
  RayOffset ray_offset = RayOffset::bounds;
  int max_depth = 7;  ///< path segments, the camera ray included; at least 1
};

/// Rays traced, by what for.
struct RayCounts {
  std::uint64_t camera = 0;     ///< also the number of paths
  std::uint64_t scattered = 0;  ///< continuing a path
  std::uint64_t shadow = 0;     ///< occlusion queries

  std::uint64_t total() const { return camera + scattered + shadow; }
  void add(const RayCounts& o) {
    camera += o.camera;
    scattered += o.scattered;
    shadow += o.shadow;
  }
};

/// Estimates the radiance along camera rays. Immutable once made and safe to use from many threads. Views the scene
/// and the accelerator, which must outlive it.
class Integrator {
 public:
  Integrator(const Scene& scene, const Accelerator& accelerator, const SceneNeeds& needs,
             const IntegratorSettings& settings);

  /// One sample of the radiance that arrives along `ray`. `sampler` gives the path's random numbers from dimension
  /// kFirstDimension on. May be infinite or NaN where arithmetic overflows: the caller drops and counts those.
  Rgb radiance(const Ray& ray, const Sampler& sampler, RayCounts& counts) const {
    return estimate_(*this, ray, sampler, counts);
  }

  /// Dimensions below are the camera's.
  static constexpr std::uint32_t kFirstDimension = 2;

  const Lights& lights() const { return lights_; }

 private:
  using Estimate = Rgb (*)(const Integrator&, const Ray&, const Sampler&, RayCounts&);

  template <unsigned kFeatures>
  static Rgb estimate(const Integrator& self, const Ray& ray, const Sampler& sampler, RayCounts& counts);
  template <std::size_t... kIndex>
  static Estimate choose(unsigned features, std::index_sequence<kIndex...>);

  const Scene& scene_;
  const Accelerator& accelerator_;
  IntegratorSettings settings_;
  Lights lights_;
  Estimate estimate_;
};

}  // namespace raylab
