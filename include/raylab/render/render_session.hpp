#pragma once
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "raylab/core/timing.hpp"
#include "raylab/image/film.hpp"
#include "raylab/image/film_error.hpp"
#include "raylab/render/integrator.hpp"
#include "raylab/render/pixel_rect.hpp"
#include "raylab/render/sample_map.hpp"
#include "raylab/render/tile_work.hpp"
#include "raylab/scene/camera.hpp"

namespace raylab {

/// What to render of a scene and how.
struct RenderOptions {
  CameraSettings camera;
  int width = 0;
  int height = 0;
  std::optional<PixelRect> crop;   ///< part of the picture to render; absent: all of it
  std::uint32_t first_sample = 0;  ///< of the range of sample indices to take
  std::uint32_t samples_per_pixel = 64;
  std::uint32_t seed = 0;
  SamplerKind sampler = SamplerKind::sobol;
  IntegratorSettings integrator;
  int tile_size = 16;                    ///< pixels; changes no result
  std::uint32_t pass_samples = 16;       ///< of the first pass; changes no result
  std::uint32_t most_pass_samples = 64;  ///< later passes take as many as all before, up to this
  bool adaptive = false;                 ///< samples_per_pixel is the mean of what a SampleMap gives each pixel
  std::optional<double> target_error;    ///< ends after the first pass whose error is no more, by a reliable estimate
  std::optional<SceneNeeds> needs;       ///< absent: what scene_needs() says
};

/// The camera ray of one sample and the numbers its path goes on with.
struct CameraSample {
  Sampler sampler;
  Ray ray;
};
CameraSample camera_sample(const Camera& camera, const RenderOptions& options, int x, int y, std::uint32_t sample);

/// A sample that was not finite, as needed to make it again.
struct DroppedSample {
  int x = 0;
  int y = 0;
  std::uint32_t sample = 0;
};

struct RenderStats {
  RayCounts rays;
  std::uint64_t dropped = 0;                   ///< samples that were NaN, infinite or negative
  std::optional<DroppedSample> first_dropped;  ///< the first in picture order, then sample order
  std::uint64_t too_bright = 0;                ///< samples that the film has clamped to ExactSum::kLargest
  std::uint64_t too_dark = 0;                  ///< samples, not black, of which it keeps little or nothing
  double seconds = 0.0;                        ///< wall clock spent rendering so far

  void add(const RenderStats& other);
};

/// Renders one scene with one accelerator, in the background or not. The scene and the accelerator must outlive it.
/// The film is the same to the bit for any number of threads, tile size and pass size, and for any number of sessions
/// of which each goes on from the film that the one before left.
class RenderSession {
 public:
  /// Throws Error (input or usage) for a camera or options that make no picture. Goes on from `film`, if there is one:
  /// of the same options but samples_per_pixel, which may be more; each pixel goes on after the samples taken.
  RenderSession(const Scene& scene, const Accelerator& accelerator, const RenderOptions& options,
                std::optional<Film> film = std::nullopt);
  ~RenderSession();  ///< stops
  RenderSession(const RenderSession&) = delete;
  RenderSession& operator=(const RenderSession&) = delete;

  /// Renders all samples that are left, on this thread and TBB's. Returns early after stop() from another thread.
  void run();

  /// The same on a thread of its own.
  void start();

  /// Asks run() to end after the pixels in hand. Returns at once.
  void request_stop() { stop_.store(true, std::memory_order_relaxed); }

  /// Waits for a started run to end, at most this long. Returns whether it has ended. Rethrows what it threw.
  bool wait_for(double seconds);

  /// Ends rendering and waits for it.
  void stop();

  /// Whether all samples are taken, or as many as the target of error needs.
  bool finished() const { return finished_.load(std::memory_order_acquire); }

  /// Samples taken so far over samples asked for, in [0, 1].
  double progress() const;

  /// Share of the time that this run takes, by what each tile has taken so far: where tiles differ, samples mislead.
  /// Above 0 once progress() has grown.
  double time_share() const;

  /// What has been gathered. Only while nothing is rendered.
  const Film& film() const { return film_; }

  /// Copy of what has been gathered so far. Safe while rendering.
  Film snapshot() const;

  /// The same of `count` rows from `first` on, for whom the whole, a hundred bytes a pixel, would be too much.
  Film snapshot_rows(int first, int count) const;

  /// Of the film's error. Only while nothing is rendered.
  RelmseEstimate estimated_error() const { return estimate_relmse(film_, is_net()); }
  /// To gather the same from snapshot_rows().
  RelmseEstimator error_estimator() const { return RelmseEstimator(is_net()); }

  RenderStats stats() const;

  const RenderOptions& options() const { return options_; }
  const SceneNeeds& needs() const { return needs_; }
  const Integrator& integrator() const { return integrator_; }

 private:
  /// Whether the samples of a pixel are points of a net.
  bool is_net() const { return options_.sampler == SamplerKind::sobol && options_.first_sample == 0; }
  bool reached(std::uint32_t pass) const;
  /// Samples that a pixel is to have after the pass that ends at so many, of the film that is rendered.
  std::uint32_t target(int x, int y, std::uint32_t pass) const {
    return counts_ ? map_->samples(*counts_, x, y) : pass;
  }
  void render_pass(std::uint32_t pass, Film& film);
  void render_tile(std::size_t index, std::uint32_t pass, Film& film);
  /// Samples that each tile is yet to have.
  std::vector<std::uint64_t> samples_left() const;
  void make_map();

  RenderOptions options_;
  PixelRect region_;
  SceneNeeds needs_;
  Camera camera_;
  Integrator integrator_;
  std::vector<PixelRect> tiles_;
  std::uint32_t fewest_taken_ = 0;           // of the film that was gone on from
  std::optional<SampleMap> map_;             // of an adaptive render, once it is known
  std::optional<SampleMap::Counts> counts_;  // and what it says of the pass

  mutable std::mutex mutex_;  // guards film_, stats_ and work_
  Film film_;
  RenderStats stats_;
  TileWork work_;
  std::optional<Stopwatch> running_;  // guarded by mutex_
  std::atomic<std::uint64_t> samples_taken_{0};
  std::atomic<std::uint64_t> samples_wanted_{0};  // in all
  std::atomic<bool> stop_{false};
  std::atomic<bool> finished_{false};
  std::condition_variable ended_changed_;
  bool ended_ = false;          // of the started run; guarded by mutex_
  std::exception_ptr failure_;  // what it threw; guarded by mutex_
  std::thread thread_;
};

/// The tiles of a region, in rings from its middle outwards, so that what matters most is seen first.
std::vector<PixelRect> centre_out_tiles(const PixelRect& region, int tile_size);

}  // namespace raylab
