#include "live_render.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>

#include "raylab/core/parallel.hpp"

namespace raylab {

namespace {

constexpr double kPollSeconds = 0.005;
constexpr double kFirstPictureSeconds = 0.1;
// A snapshot rounds every sum of the film: it may take up to this share of the time.
constexpr double kSnapshotShare = 0.1;
// Copied at a time: what fits the cache, and locks the film for a moment only.
constexpr int kSnapshotRows = 8;
constexpr int kCoarsest = 32;
// Small units of work end soon after they are asked to: 16 x 16 pixels at one sample are one batch of paths, some
// milliseconds. Accelerators that the scene is too large for take far longer for the same.
constexpr int kTile = 16;
constexpr int kSlowTile = 2;
constexpr std::uint32_t kPassSamples = 1;

RenderOptions for_live(RenderOptions options, const std::string& accel, const Geometry& geometry) {
  const AcceleratorCapabilities can = find_accelerator(accel).capabilities;
  const bool is_slow = can.is_exact || geometry.primitive_count() > can.largest_primitives;
  options.tile_size = is_slow ? kSlowTile : kTile;
  options.pass_samples = options.most_pass_samples = kPassSamples;
  return options;
}

int coarse_size(int size, int coarseness) { return (size + coarseness - 1) / coarseness; }

}  // namespace

void take_snapshot(const RenderSession& session, const Image& coarse, TracedPicture& picture) {
  const int width = session.options().width, height = session.options().height;
  picture.image = Image(width, height);
  picture.samples = 0xffffffffu;
  RelmseEstimator error = session.error_estimator();
  for (int first = 0; first < height; first += kSnapshotRows) {
    // One row more at either side, as the estimate of error looks at neighbours.
    const int above = std::min(first, 1), count = std::min(kSnapshotRows, height - first);
    const int below = std::min(height - first - count, 1);
    const Film film = session.snapshot_rows(first - above, above + count + below);
    for (int row = above; row < above + count; ++row) {
      const int y = first - above + row;
      for (int x = 0; x < width; ++x) {
        const std::uint32_t samples = film.samples(x, row);
        picture.samples = std::min(picture.samples, samples);
        picture.image.at(x, y) =
            samples != 0 ? film.mean(x, row) : coarse.at(x * coarse.width / width, y * coarse.height / height);
      }
    }
    error.add(film, above, count);
  }
  picture.estimated_relmse = error.estimate().relmse;
}

std::vector<std::uint8_t> encode_srgb(const Image& image, double exposure) {
  const auto gain = static_cast<float>(std::exp2(exposure));
  std::vector<std::uint8_t> bytes(image.pixels.size() * 3);
  const auto width = static_cast<std::size_t>(image.width);
  parallel_for(static_cast<std::size_t>(image.height), [&](std::size_t y) {
    for (std::size_t i = y * width; i < (y + 1) * width; ++i) {
      for (int c = 0; c < 3; ++c) {
        bytes[3 * i + static_cast<std::size_t>(c)] = linear_to_srgb_byte(gain * image.pixels[i][c]);
      }
    }
  });
  return bytes;
}

std::optional<Rgb> color_at(const Image& image, int width, int height, const glm::dvec2& place) {
  if (!(place.x >= 0.0 && place.y >= 0.0 && place.x < width && place.y < height)) return std::nullopt;
  return image.at(static_cast<int>(place.x * image.width / width), static_cast<int>(place.y * image.height / height));
}

LiveRender::LiveRender(const Scene& scene, AcceleratorShelf& shelf)
    : scene_(scene), shelf_(shelf), thread_([this] { work(); }) {}

LiveRender::~LiveRender() {
  {
    const std::lock_guard lock(mutex_);
    quit_ = true;
    ++number_;
  }
  changed_.notify_all();
  thread_.join();
}

std::uint64_t LiveRender::ask(const TraceRequest& request) {
  const std::lock_guard lock(mutex_);
  wanted_ = request;
  failure_.clear();
  since_request_ = Stopwatch();
  changed_.notify_all();
  return ++number_;
}

void LiveRender::rest() {
  const std::lock_guard lock(mutex_);
  if (!wanted_) return;
  wanted_.reset();
  since_request_ = Stopwatch();
  ++number_;
  changed_.notify_all();
}

std::shared_ptr<const TracedPicture> LiveRender::latest() const {
  const std::lock_guard lock(mutex_);
  return latest_;
}

std::string LiveRender::failure() const {
  const std::lock_guard lock(mutex_);
  return failure_;
}

double LiveRender::longest_stop_seconds() const {
  const std::lock_guard lock(mutex_);
  return longest_stop_;
}

bool LiveRender::outdated(std::uint64_t number) const {
  const std::lock_guard lock(mutex_);
  return number_ != number;
}

bool LiveRender::wait_outdated(std::uint64_t number, double seconds) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, std::chrono::duration<double>(seconds), [&] { return number_ != number; });
}

void LiveRender::publish(TracedPicture picture) {
  picture.srgb = encode_srgb(picture.image);
  auto made = std::make_shared<const TracedPicture>(std::move(picture));
  const std::lock_guard lock(mutex_);
  latest_ = std::move(made);
}

void LiveRender::note_stop() {
  const std::lock_guard lock(mutex_);
  longest_stop_ = std::max(longest_stop_, since_request_.seconds());
}

void LiveRender::work() {
  std::unique_lock lock(mutex_);
  std::uint64_t served = 0;
  while (!quit_) {
    if (!wanted_ || number_ == served) {
      changed_.wait(lock);
      continue;
    }
    const TraceRequest request = *wanted_;
    served = number_;
    lock.unlock();
    std::string failure;
    try {
      serve(request, served);
    } catch (const std::exception& e) {
      failure = e.what();
    }
    lock.lock();
    if (number_ == served) failure_ = failure;
  }
}

void LiveRender::serve(const TraceRequest& request, std::uint64_t number) {
  const Accelerator& accelerator = shelf_.get(request.accel);
  if (outdated(number)) return;
  const Image coarse = trace_coarse(request, accelerator, number);
  if (!outdated(number)) trace_all(request, accelerator, number, coarse);
}

Image LiveRender::trace_coarse(const TraceRequest& request, const Accelerator& accelerator, std::uint64_t number) {
  RenderOptions options = for_live(request.options, request.accel, scene_.geometry);
  options.width = coarse_size(request.options.width, coarseness_);
  options.height = coarse_size(request.options.height, coarseness_);
  options.crop.reset();
  options.samples_per_pixel = 1;
  const Stopwatch watch;
  RenderSession coarse(scene_, accelerator, options);
  coarse.start();
  while (!coarse.wait_for(kPollSeconds)) {
    if (watch.seconds() > 2.0 * kCoarseSeconds && outdated(number)) coarse.request_stop();
  }
  coarse.stop();
  const double seconds = std::max(watch.seconds(), 1e-4);
  // Half a picture taken in twice the time is worth nothing, but its time is: the next one is coarser.
  const double per_pixel = seconds / (std::max(coarse.progress(), 1e-3) * options.width * options.height);
  const double pixels = static_cast<double>(request.options.width) * request.options.height;
  coarseness_ = std::clamp(static_cast<int>(std::ceil(std::sqrt(pixels * per_pixel / kCoarseSeconds))), 1, kCoarsest);

  TracedPicture picture;
  picture.request = number;
  picture.accel = request.accel;
  picture.image = coarse.snapshot().image();
  picture.stats = coarse.stats();
  picture.seconds = seconds;
  picture.estimated_relmse = kInfinity;
  Image image = picture.image;
  if (coarse.finished()) publish(std::move(picture));
  if (outdated(number)) note_stop();
  return image;
}

void LiveRender::trace_all(const TraceRequest& request, const Accelerator& accelerator, std::uint64_t number,
                           const Image& coarse) {
  const Stopwatch watch;
  RenderSession all(scene_, accelerator, for_live(request.options, request.accel, scene_.geometry));
  all.start();
  double next = kFirstPictureSeconds;
  for (bool ended = false; !ended;) {
    while (!ended && watch.seconds() < next) {
      if (wait_outdated(number, kPollSeconds)) {
        all.stop();
        note_stop();
        return;
      }
      ended = all.wait_for(0.0);
    }
    const Stopwatch snapshot_watch;
    TracedPicture picture;
    picture.request = number;
    picture.accel = request.accel;
    picture.stats = all.stats();
    picture.seconds = watch.seconds();
    take_snapshot(all, coarse, picture);
    picture.complete = ended && all.finished();
    publish(std::move(picture));
    next = watch.seconds() + snapshot_watch.seconds() / kSnapshotShare;
  }
}

}  // namespace raylab
