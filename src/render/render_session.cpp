#include "raylab/render/render_session.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <limits>
#include <string>
#include <tuple>
#include <vector>

#include "raylab/core/check.hpp"
#include "raylab/core/error.hpp"
#include "raylab/core/parallel.hpp"
#include "raylab/core/timing.hpp"

namespace raylab {

namespace {

std::string describe(const PixelRect& r) {
  return std::to_string(r.x) + "," + std::to_string(r.y) + "," + std::to_string(r.width) + "," +
         std::to_string(r.height);
}

PixelRect region_of(const RenderOptions& o) {
  if (o.width < 1 || o.height < 1) {
    throw Error(ErrorKind::input, "render",
                "a picture of " + std::to_string(o.width) + "x" + std::to_string(o.height) + " pixels has none");
  }
  if (o.integrator.max_depth < 1) {
    throw Error(ErrorKind::input, "render.max_depth",
                "found " + std::to_string(o.integrator.max_depth) + ", expected at least 1 segment");
  }
  if (o.tile_size < 1 || o.pass_samples < 1 || o.samples_per_pixel < 1) {
    throw Error(ErrorKind::usage, "render", "tile size, pass size and samples per pixel must be at least 1");
  }
  if (0xffffffffu - o.first_sample < o.samples_per_pixel) {
    throw Error(ErrorKind::usage, "--samples", "sample indices end at 4294967295");
  }
  if (o.adaptive && o.first_sample != 0) {
    throw Error(ErrorKind::usage, "--adaptive",
                "takes samples where the error of the whole picture is, and no part of them: --samples cannot be used");
  }
  if (o.adaptive && 0xffffffffu / SampleMap::kMost < o.samples_per_pixel) {
    throw Error(ErrorKind::usage, "--adaptive",
                "takes up to " + std::to_string(0xffffffffu / SampleMap::kMost) + " samples per pixel");
  }
  const PixelRect all{0, 0, o.width, o.height};
  if (!o.crop) return all;
  const PixelRect& c = *o.crop;
  if (c.width < 1 || c.height < 1 || c.x < 0 || c.y < 0 || c.width > o.width - c.x || c.height > o.height - c.y) {
    throw Error(ErrorKind::usage, "--crop",
                describe(c) + " does not lie inside a picture of " + std::to_string(o.width) + "x" +
                    std::to_string(o.height) + " pixels; expected X,Y,WIDTH,HEIGHT");
  }
  return c;
}

std::array<const float*, 3> from(const BatchRadiance& radiance, std::size_t first) {
  return {radiance[0].data() + first, radiance[1].data() + first, radiance[2].data() + first};
}

/// Whether the film keeps all of some samples: each channel is 0 or within its range.
bool in_range(const BatchRadiance& radiance, std::size_t first, std::size_t count) {
  int outside = 0;
  for (const float* const samples : from(radiance, first)) {
    for (std::size_t i = 0; i < count; ++i) {
      outside |= static_cast<int>(samples[i] != 0.0f) &
                 static_cast<int>(!(samples[i] >= ExactSum::kLeast && samples[i] <= ExactSum::kLargest));
    }
  }
  return outside == 0;
}

/// Counts a sample that is too bright or too dark for the film. Returns false for one that is to be dropped: negative
/// or not finite.
bool count_range(const Rgb& sample, RenderStats& stats) {
  const float least = std::min({sample.r, sample.g, sample.b}), most = max_component(sample);
  if (!(least >= 0.0f && most < kInfinity) || !is_finite(sample)) return false;
  stats.too_bright += most > ExactSum::kLargest ? 1 : 0;
  stats.too_dark += most > 0.0f && most < ExactSum::kLeast ? 1 : 0;
  return true;
}

}  // namespace

CameraSample camera_sample(const Camera& camera, const RenderOptions& options, int x, int y, std::uint32_t sample) {
  const Sampler sampler(options.sampler, options.seed, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y),
                        sample);
  const vec2 jitter = sampler.get2(Integrator::kPixelDimension);
  const vec2 lens = camera.has_lens() ? sampler.get2(Integrator::kLensDimension) : vec2(0.5f);
  return {sampler, camera.ray(static_cast<float>(x) + jitter.x, static_cast<float>(y) + jitter.y, lens)};
}

void RenderStats::add(const RenderStats& other) {
  rays.add(other.rays);
  dropped += other.dropped;
  too_bright += other.too_bright;
  too_dark += other.too_dark;
  seconds += other.seconds;
  if (other.first_dropped) {
    const auto key = [](const DroppedSample& d) { return std::tuple(d.y, d.x, d.sample); };
    if (!first_dropped || key(*other.first_dropped) < key(*first_dropped)) first_dropped = other.first_dropped;
  }
}

RenderSession::RenderSession(const Scene& scene, const Accelerator& accelerator, const RenderOptions& options,
                             std::optional<Film> film)
    : options_(options),
      region_(region_of(options)),
      needs_(options.needs ? *options.needs : scene_needs(scene)),
      camera_(options.camera, options.width, options.height),
      integrator_(scene, camera_, accelerator, needs_, options.integrator),
      tiles_(centre_out_tiles(region_, options.tile_size)),
      film_(film ? std::move(*film) : Film(options.width, options.height)) {
  RAYLAB_CHECK(film_.width() == options.width && film_.height() == options.height);
  std::uint64_t all_taken = 0;
  const std::uint32_t most =
      options.adaptive ? SampleMap::kMost * options.samples_per_pixel : options.samples_per_pixel;
  fewest_taken_ = options.samples_per_pixel;
  for (int y = region_.y; y < region_.y + region_.height; ++y) {
    for (int x = region_.x; x < region_.x + region_.width; ++x) {
      const std::uint32_t taken = std::min(film_.taken(x, y), most);
      all_taken += taken;
      fewest_taken_ = std::min(fewest_taken_, taken);
    }
  }
  samples_taken_ = all_taken;
  samples_wanted_ = static_cast<std::uint64_t>(region_.width) * static_cast<std::uint64_t>(region_.height) *
                    options.samples_per_pixel;
  work_.set_left(samples_left());
}

RenderSession::~RenderSession() { stop(); }

void RenderSession::start() {
  RAYLAB_CHECK(!thread_.joinable());
  thread_ = std::thread([this] {
    std::exception_ptr failure;
    try {
      run();
    } catch (...) {
      failure = std::current_exception();
    }
    const std::lock_guard lock(mutex_);
    failure_ = failure;
    ended_ = true;
    ended_changed_.notify_all();
  });
}

bool RenderSession::wait_for(double seconds) {
  std::unique_lock lock(mutex_);
  const bool ended = ended_changed_.wait_for(lock, std::chrono::duration<double>(seconds), [this] { return ended_; });
  if (failure_) std::rethrow_exception(failure_);
  return ended;
}

void RenderSession::stop() {
  request_stop();
  if (thread_.joinable()) thread_.join();
}

void RenderSession::run() {
  {
    const std::lock_guard lock(mutex_);
    running_.emplace();
  }
  bool enough = false;
  // Passes end at the same numbers of samples wherever the film began, and with them the target of error.
  for (std::uint32_t done = 0; done < options_.samples_per_pixel && !stop_.load(std::memory_order_relaxed);) {
    // As many as all passes before: few of them, while at no time one pixel has over twice the samples of another.
    const std::uint32_t wanted = std::max(options_.pass_samples, std::min(done, options_.most_pass_samples));
    const bool decides = options_.adaptive && !map_ && options_.samples_per_pixel > SampleMap::kPilot &&
                         done < SampleMap::kPilot && done + wanted >= SampleMap::kPilot;
    done = decides ? SampleMap::kPilot : done + std::min(wanted, options_.samples_per_pixel - done);
    if (map_) counts_ = map_->counts(done);
    if (!decides && !map_ && done < fewest_taken_) continue;
    render_pass(done, film_);
    if (decides) make_map();
    enough = options_.target_error && reached(done);
    if (enough) break;
  }
  const std::lock_guard lock(mutex_);
  stats_.seconds += running_->seconds();
  running_.reset();
  finished_.store(enough || !stop_.load(std::memory_order_relaxed) || progress() >= 1.0, std::memory_order_release);
}

/// Whether all pixels have exactly so many samples as the pass gives, and the error is reliably no more than asked for:
/// of a film that was gone on from, pixels that have more say that at this place it was not.
bool RenderSession::reached(std::uint32_t pass) const {
  for (int y = region_.y; y < region_.y + region_.height; ++y) {
    for (int x = region_.x; x < region_.x + region_.width; ++x) {
      if (film_.taken(x, y) != target(x, y, pass)) return false;
    }
  }
  const RelmseEstimate error = estimated_error();
  return error.reliable && error.relmse <= *options_.target_error;
}

/// Once all pixels have the samples that decide. Where a film was gone on from that has more, they are rendered again.
void RenderSession::make_map() {
  bool has_more = false;
  for (int y = region_.y; y < region_.y + region_.height; ++y) {
    for (int x = region_.x; x < region_.x + region_.width; ++x) has_more |= film_.taken(x, y) != SampleMap::kPilot;
  }
  std::optional<Film> pilot;
  if (has_more) render_pass(SampleMap::kPilot, pilot.emplace(film_.width(), film_.height()));
  if (stop_.load(std::memory_order_relaxed)) return;
  map_.emplace(pilot ? *pilot : film_, region_);
  samples_wanted_ = map_->counts(options_.samples_per_pixel).total;
  const std::lock_guard lock(mutex_);
  work_.set_left(samples_left());
}

std::vector<std::uint64_t> RenderSession::samples_left() const {
  std::optional<SampleMap::Counts> counts;
  if (map_) counts = map_->counts(options_.samples_per_pixel);
  std::vector<std::uint64_t> left;
  for (const PixelRect& tile : tiles_) {
    left.push_back(0);
    for (int y = tile.y; y < tile.y + tile.height; ++y) {
      for (int x = tile.x; x < tile.x + tile.width; ++x) {
        const std::uint32_t wanted = counts ? map_->samples(*counts, x, y) : options_.samples_per_pixel;
        left.back() += wanted - std::min(film_.taken(x, y), wanted);
      }
    }
  }
  return left;
}

void RenderSession::render_pass(std::uint32_t pass, Film& film) {
  parallel_for(tiles_.size(), [&](std::size_t i) {
    if (!stop_.load(std::memory_order_relaxed)) render_tile(i, pass, film);
  });
}

void RenderSession::render_tile(std::size_t index, std::uint32_t pass, Film& film) {
  const PixelRect& tile = tiles_[index];
  const Stopwatch watch;
  // Gathered apart and added at the end: the film is locked once a tile, and a snapshot never sees half a sample.
  Film gathered(tile.width, tile.height);
  RenderStats stats;
  std::uint64_t taken = 0;
  PathBatch paths;
  paths.sampler = options_.sampler;
  struct Run {
    int x, y;  ///< in the tile
    std::size_t first, count;
  };
  std::vector<Run> runs;  // of samples of one pixel
  BatchRadiance radiance;
  const auto trace = [&] {
    integrator_.trace(paths, radiance, stats.rays);
    for (const Run& run : runs) {
      if (in_range(radiance, run.first, run.count)) [[likely]] {
        gathered.add(run.x, run.y, from(radiance, run.first), run.count, paths.sample[run.first]);
        continue;
      }
      for (std::size_t i = run.first; i < run.first + run.count; ++i) {
        if (count_range({radiance[0][i], radiance[1][i], radiance[2][i]}, stats)) {
          gathered.add(run.x, run.y, from(radiance, i), 1, paths.sample[i]);
        } else {
          gathered.drop(run.x, run.y, 1);
          RenderStats dropped;
          dropped.dropped = 1;
          dropped.first_dropped = DroppedSample{tile.x + run.x, tile.y + run.y, paths.sample[i]};
          stats.add(dropped);
        }
      }
    }
    taken += paths.count;
    paths.count = 0;
    runs.clear();
  };
  for (int pixel = 0; pixel < tile.width * tile.height; ++pixel) {
    const int x = pixel % tile.width, y = pixel / tile.width;
    const PixelSeed seed(options_.seed, static_cast<std::uint32_t>(tile.x + x), static_cast<std::uint32_t>(tile.y + y));
    // No other thread writes to this tile's pixels.
    const std::uint32_t wanted = target(tile.x + x, tile.y + y, pass);
    for (std::uint32_t done = film.taken(tile.x + x, tile.y + y); done < wanted;) {
      const std::uint32_t room = static_cast<std::uint32_t>(PathBatch::kMost - paths.count);
      const std::uint32_t taking = std::min(room, wanted - done);
      runs.push_back({x, y, paths.count, taking});
      paths.add(tile.x + x, tile.y + y, seed, options_.first_sample + done, taking);
      done += taking;
      if (paths.count < PathBatch::kMost) continue;
      trace();
      if (stop_.load(std::memory_order_relaxed)) break;
    }
    if (stop_.load(std::memory_order_relaxed)) break;
  }
  if (paths.count != 0) trace();
  if (taken == 0) return;
  const std::lock_guard lock(mutex_);
  film.add(gathered, tile.x, tile.y);
  if (&film != &film_) {
    stats_.rays.add(stats.rays);
    return;
  }
  work_.add(index, taken, watch.seconds());
  stats_.add(stats);
  samples_taken_.fetch_add(taken, std::memory_order_relaxed);  // after their work, as who sees them asks for that next
}

double RenderSession::progress() const {
  const auto taken = static_cast<double>(samples_taken_.load(std::memory_order_relaxed));
  return std::min(taken / static_cast<double>(samples_wanted_.load(std::memory_order_relaxed)), 1.0);
}

double RenderSession::time_share() const {
  const std::lock_guard lock(mutex_);
  return work_.share();
}

Film RenderSession::snapshot() const {
  const std::lock_guard lock(mutex_);
  return film_;
}

Film RenderSession::snapshot_rows(int first, int count) const {
  const std::lock_guard lock(mutex_);
  return film_.rows(first, count);
}

RenderStats RenderSession::stats() const {
  const std::lock_guard lock(mutex_);
  RenderStats stats = stats_;
  if (running_) stats.seconds += running_->seconds();
  return stats;
}

}  // namespace raylab
