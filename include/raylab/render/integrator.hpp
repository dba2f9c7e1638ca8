#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>

#include "raylab/accel/accelerator.hpp"
#include "raylab/core/check.hpp"
#include "raylab/render/sampler.hpp"
#include "raylab/scene/camera.hpp"
#include "raylab/scene/needs.hpp"
#include "raylab/scene/scene.hpp"

namespace raylab {

enum class IntegratorKind : std::uint8_t {
  path,       ///< light sampling, multiple importance sampling, Russian roulette
  book,       ///< BSDF sampling alone to the fixed depth, as in Ray Tracing in One Weekend
  reference,  ///< `path` ray by ray and path by path: the same bits, from code that reads like the book
};

/// Throws Error (usage) for an unknown name.
IntegratorKind parse_integrator(std::string_view name);
std::string_view integrator_name(IntegratorKind kind);

/// How a continued ray keeps off the surface it starts on.
enum class RayOffset : std::uint8_t {
  bounds,  ///< starts outside the hit point's error bound (see SurfacePoint)
  book,    ///< starts at the hit point with t_min = 0.001, for comparison
};

/// How light is looked for: by scattering always, and in what other ways.
struct Strategies {
  bool light = true;   ///< points of lights are sampled
  bool mirror = true;  ///< and points of lights as seen over plane mirrors, where a scene has some
  bool sphere = true;  ///< and over spheres of glass or smooth metal
};
/// From "auto" (all that the scene needs), or names from bsdf, light, mirror and sphere with commas between them.
/// Throws Error (usage).
Strategies parse_strategies(std::string_view names);

struct IntegratorSettings {
  IntegratorKind kind = IntegratorKind::path;
  RayOffset ray_offset = RayOffset::bounds;
  Strategies strategies;   ///< of `path` and `reference`; the mean of a picture is the same with each
  int max_depth = 7;       ///< path segments, the camera ray included; at least 1
  std::optional<Isa> isa;  ///< absent: the newest the processor has; changes no result
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

/// Emitters that light samples are taken of, and the bytes kept for it.
struct LightStatistics {
  std::size_t count, bytes;
};
LightStatistics light_statistics(const Scene& scene, const SceneNeeds& needs);

/// Paths to trace together, up to kMost.
struct PathBatch {
  static constexpr std::size_t kMost = 512;

  std::size_t count = 0;
  SamplerKind sampler = SamplerKind::sobol;
  std::array<float, kMost> x, y;                         ///< pixel, from the upper left
  std::array<std::uint32_t, kMost> seed_low, seed_high;  ///< of the pixel, see PixelSeed
  std::array<std::uint32_t, kMost> sample;               ///< index of the sample

  /// Samples of one pixel, from index `first_sample` on.
  void add(int px, int py, const PixelSeed& seed, std::uint32_t first_sample, std::uint32_t samples = 1) {
    RAYLAB_CHECK(samples <= kMost - count);
    for (std::uint32_t i = 0; i < samples; ++i) {
      x[count + i] = static_cast<float>(px);
      y[count + i] = static_cast<float>(py);
      seed_low[count + i] = seed.low;
      seed_high[count + i] = seed.high;
      sample[count + i] = first_sample + i;
    }
    count += samples;
  }
};

/// Radiance of each path of a batch: red, green, blue.
using BatchRadiance = std::array<std::array<float, PathBatch::kMost>, 3>;

struct ShadingScene;
using TraceKernel = void (*)(const ShadingScene&, const PathBatch&, BatchRadiance&, RayCounts&);

/// Estimates the radiance that arrives at the camera. Immutable once made and safe to use from many threads. Views
/// the scene, the camera and the accelerator, which must outlive it.
///
/// All paths of a batch advance by one segment together: their rays go to the accelerator as a batch, and shading
/// runs on vectors of paths, which is several times as fast as path after path (the wavefront of Laine, Karras and
/// Aila 2013, "Megakernels Considered Harmful", with the processor's vectors for a GPU's warps).
class Integrator {
 public:
  Integrator(const Scene& scene, const Camera& camera, const Accelerator& accelerator, const SceneNeeds& needs,
             const IntegratorSettings& settings);
  ~Integrator();

  /// One sample for each path of the batch. Radiance may be infinite or NaN where arithmetic overflows: the caller
  /// drops and counts those. A path's radiance does not depend on the others in its batch.
  void trace(const PathBatch& paths, BatchRadiance& radiance, RayCounts& counts) const;

  /// Dimensions of the sampler.
  static constexpr std::uint32_t kPixelDimension = 0;
  static constexpr std::uint32_t kLensDimension = 1;
  static constexpr std::uint32_t kFirstDimension = 2;  ///< of the first segment

  /// Russian roulette ends a path only once it has less than 1 / kFullSurvival of the power that the first surface left
  /// it. relMSE times seconds, against roulette by throughput from segment 5 on (128 pixels wide, 64 samples a pixel,
  /// of mirror-room and lamps 16): bunny 0.57, mirror-room 0.68, forest 0.73, cornell 0.79, globe 0.93, lamps 0.94,
  /// dragon 0.97, one-weekend 1.00; 2 or 4 in place of 3 change it by up to 7%.
  static constexpr float kFullSurvival = 3.0f;

  LightStatistics lights() const;
  /// Chains of plane mirrors over which lights are sampled.
  std::size_t mirror_chains() const;
  /// Ways over single spheres that are sampled: off a sphere of smooth metal, off and through one of glass.
  std::size_t sphere_chains() const;

 private:
  std::unique_ptr<const ShadingScene> shading_;
  TraceKernel kernel_;
};

}  // namespace raylab
