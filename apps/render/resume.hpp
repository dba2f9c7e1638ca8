#pragma once
// Renders that are never lost: what a film is of, where it is kept, and going on from it.
#include <atomic>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>

#include "options.hpp"
#include "raylab/core/timing.hpp"
#include "raylab/image/film_file.hpp"

namespace raylab {

/// All that determines the picture, and the samples that are to be taken of it.
FilmInfo film_info(const RenderCommand& command, const LoadedScene& loaded, const RenderOptions& options,
                   const BuildReport& build);

/// Where the checkpoint of a render with this first output is kept: "a.exr" has "a.exr.checkpoint.exr".
std::filesystem::path checkpoint_of(const std::filesystem::path& output);

/// A film to go on from, and where it came from.
struct ResumedFilm {
  Film film;
  std::filesystem::path file;
  SampleRange taken;  ///< the fewest and the most of a pixel
  double seconds;     ///< that it took
};

/// With --resume the film of the checkpoint or, where there is none, of the first output with one. Nothing where
/// neither has one. Throws Error (input) where it is of another picture, naming the difference, or cannot be gone on
/// from.
std::optional<ResumedFilm> resumed_film(const std::vector<std::filesystem::path>& outputs, const FilmInfo& wanted);

/// Writes a file, or does other such work, again and again while a render goes on, in a thread of its own, one write
/// at a time.
class RepeatedWriter {
 public:
  /// `write` may throw Error: `warn` is told, and the render goes on.
  RepeatedWriter(std::function<void()> write, std::function<void(const std::string&)> warn)
      : write_(std::move(write)), warn_(std::move(warn)) {}
  ~RepeatedWriter() { finish(); }
  RepeatedWriter(const RepeatedWriter&) = delete;
  RepeatedWriter& operator=(const RepeatedWriter&) = delete;

  /// Starts a write where the last one ended so many seconds ago; call often.
  void write_every(double seconds);

  /// Seconds that the last write took.
  double last_seconds() const { return seconds_; }

  /// Waits for a write in progress.
  void finish();

 private:
  std::function<void()> write_;
  std::function<void(const std::string&)> warn_;
  std::thread thread_;
  std::atomic<bool> ended_{false};
  std::string failure_;  // of the thread, until it has ended
  std::atomic<double> seconds_{0.0};
  Stopwatch since_last_;
};

/// Seconds between checkpoints: as asked for; or none, infinity, for a render that is expected to end in five minutes,
/// and else a minute or so much that writing takes less than a hundredth of the time.
double checkpoint_interval(const RenderCommand& command, double expected_seconds, double write_seconds);

}  // namespace raylab
