#pragma once
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "accelerator_shelf.hpp"
#include "raylab/core/timing.hpp"
#include "raylab/render/render_session.hpp"

namespace raylab {

/// What is to be seen.
struct TraceRequest {
  std::string accel;
  RenderOptions options;  ///< camera, size, samples, seed, integrator: as raylab-render would have them
};

/// What has been traced of a request so far.
struct TracedPicture {
  std::uint64_t request = 0;  ///< number of the request it answers, see LiveRender::ask
  std::string accel;          ///< that traced it
  Image image;                ///< linear; where no sample is yet, what the coarse picture says
  std::uint32_t samples = 0;  ///< that every pixel has; 0 for the coarse picture
  bool complete = false;      ///< all samples asked for: the picture raylab-render makes
  RenderStats stats;
  double seconds = 0.0;  ///< spent on it
  double estimated_relmse = 0.0;
  std::vector<std::uint8_t> srgb;  ///< the image as a PNG of it has it: three bytes a pixel
};

/// What a session has gathered so far, as a picture: sets image, samples and estimated_relmse.
void take_snapshot(const RenderSession& session, const Image& coarse, TracedPicture& picture);

/// The image as a PNG of it has it: three bytes a pixel. `exposure`: brighter by so many stops.
std::vector<std::uint8_t> encode_srgb(const Image& image, double exposure = 0.0);

/// What an image has at a place of a width x height picture that shows it, in pixels from the upper left corner;
/// nothing beside the picture.
std::optional<Rgb> color_at(const Image& image, int width, int height, const glm::dvec2& place);

/// Traces what was asked for last, on threads of its own: first a coarse picture that is there in a moment, then
/// all samples. No call waits for tracing. A new request ends what is going on; only a coarse picture that will
/// soon be complete is kept, or there would be nothing to see while moving.
class LiveRender {
 public:
  /// The scene and the shelf must outlive it; any number of LiveRenders may share them.
  LiveRender(const Scene& scene, AcceleratorShelf& shelf);
  ~LiveRender();  ///< ends tracing and waits for it
  LiveRender(const LiveRender&) = delete;
  LiveRender& operator=(const LiveRender&) = delete;

  /// Returns the number of the request.
  std::uint64_t ask(const TraceRequest& request);

  /// Ends tracing until the next request.
  void rest();

  /// The newest picture; null where there is none yet.
  std::shared_ptr<const TracedPicture> latest() const;

  /// Why the last request came to nothing; empty where it did not.
  std::string failure() const;

  /// Longest time so far from a new request to the end of the tracing it ended.
  double longest_stop_seconds() const;

  /// Coarse pictures are to take about this long; a request that comes while one is traced waits for it.
  static constexpr double kCoarseSeconds = 0.025;

 private:
  void work();
  void serve(const TraceRequest& request, std::uint64_t number);
  Image trace_coarse(const TraceRequest& request, const Accelerator& accelerator, std::uint64_t number);
  void trace_all(const TraceRequest& request, const Accelerator& accelerator, std::uint64_t number,
                 const Image& coarse);
  bool outdated(std::uint64_t number) const;
  /// Waits this long, or until the request is outdated, and returns whether it is.
  bool wait_outdated(std::uint64_t number, double seconds);
  void publish(TracedPicture picture);
  void note_stop();

  const Scene& scene_;
  AcceleratorShelf& shelf_;

  mutable std::mutex mutex_;  // guards what follows, up to the thread
  std::condition_variable changed_;
  std::optional<TraceRequest> wanted_;
  std::uint64_t number_ = 0;
  Stopwatch since_request_;
  bool quit_ = false;
  std::shared_ptr<const TracedPicture> latest_;
  std::string failure_;
  double longest_stop_ = 0.0;

  int coarseness_ = 8;  // pixels of the picture to one of the coarse one, either way; of the worker alone
  std::thread thread_;
};

}  // namespace raylab
