#include "render_shot.hpp"

#include <algorithm>
#include <cinttypes>
#include <cstdio>

#include "raylab/core/atomic_file.hpp"
#include "raylab/core/error.hpp"
#include "raylab/core/interrupt.hpp"
#include "raylab/core/parallel.hpp"
#include "raylab/core/progress.hpp"
#include "raylab/core/text.hpp"
#include "raylab/render/features.hpp"
#include "raylab/render/view_warnings.hpp"
#include "report.hpp"
#include "resume.hpp"

namespace raylab {

namespace {

bool wants(const RenderCommand& command, const char* layer) {
  return std::find(command.layers.begin(), command.layers.end(), layer) != command.layers.end();
}

void add_rgb(std::vector<Layer>& layers, const std::string& name, const char* channels, const Image& image) {
  for (int c = 0; c < 3; ++c) {
    Layer layer{name + "." + channels[c], false, {}};
    layer.values.reserve(image.pixels.size());
    for (const Rgb& p : image.pixels) layer.values.push_back(p[c]);
    layers.push_back(std::move(layer));
  }
}

std::vector<Layer> feature_layers(const Job& job, const RenderOptions& options) {
  const RenderCommand& command = job.command;
  std::vector<Layer> layers;
  if (!wants(command, "albedo") && !wants(command, "normal") && !wants(command, "depth")) return layers;
  constexpr std::uint32_t kFeatureSamples = 16;
  FirstHitFeatures features = first_hit_features(job.loaded.scene, job.accelerator, options,
                                                 std::min(kFeatureSamples, options.samples_per_pixel));
  if (wants(command, "albedo")) add_rgb(layers, "albedo", "RGB", features.albedo);
  if (wants(command, "normal")) add_rgb(layers, "N", "XYZ", features.normal);
  if (wants(command, "depth")) layers.push_back({"Z", true, std::move(features.depth)});
  return layers;
}

Attributes make_attributes(const RenderReport& r) {
  Attributes attributes{{"raylab.version", RAYLAB_VERSION},
                        {"raylab.command", r.command.command_line},
                        {"raylab.sceneHash", format("%016" PRIx64, r.loaded.hash)},
                        {"raylab.seed", std::to_string(r.options.seed)},
                        {"raylab.firstSample", std::to_string(r.options.first_sample)},
                        {"raylab.samplesPerPixel", std::to_string(r.options.samples_per_pixel)},
                        {"raylab.stoppedBy", r.stopped_by},
                        {"raylab.accelerator", r.command.accel},
                        {"raylab.seconds", std::to_string(r.stats.seconds + r.seconds_before)},
                        {"raylab.partial", r.partial ? "true" : "false"}};
  attributes.merge(r.error.attributes());
  if (r.taken.end > 0) attributes["raylab.samplesTaken"] = format("%u to %u", r.taken.first, r.taken.end);
  return attributes;
}

/// The fewest and the most samples taken of a pixel that is rendered.
SampleRange taken_of(const Film& film, const RenderOptions& options) {
  const PixelRect region = options.crop.value_or(PixelRect{0, 0, options.width, options.height});
  SampleRange taken{0xffffffffu, 0};
  for (int y = region.y; y < region.y + region.height; ++y) {
    for (int x = region.x; x < region.x + region.width; ++x) {
      taken.first = std::min(taken.first, film.taken(x, y));
      taken.end = std::max(taken.end, film.taken(x, y));
    }
  }
  return taken;
}

/// One picture, from the film that it goes on from to the files that are written of it.
class ShotRender {
 public:
  ShotRender(const Job& job, const Shot& shot, const Files& outputs) : job_(job), options_(options_of(job, shot)) {
    for (const auto& file : outputs) outputs_.push_back(with_suffix(file, shot.suffix));
    if (!job.command.stats_file.empty()) stats_file_ = with_suffix(job.command.stats_file, shot.suffix);
    checkpoint_ = checkpoint_of(outputs_.front());
    info_ = film_info(job.command, job.loaded, options_, job.accelerator.build_report());
  }

  bool run() {
    RenderSession session(job_.loaded.scene, job_.accelerator, options_, film_to_go_on_from());
    const std::vector<std::string> warnings = view_warnings(job_.loaded.scene, job_.accelerator, options_);
    for (const std::string& warning : warnings) job_.warn(warning);
    const double before = session.progress();
    try {
      wait(session);
    } catch (const std::exception&) {
      // Tiles are added whole or not at all.
      session.stop();
      if (session.progress() > before) keep(session);
      throw;
    }
    // Before the pictures: it holds all that they are made of.
    if (interrupted()) keep(session);
    const Film& film = session.film();
    const RenderReport report = report_of(session, stopped_by_, session.estimated_error(), taken_of(film, options_));
    if (!report.partial && warnings.empty() && is_black(film)) {
      job_.warn("the picture is black: no light reaches what the camera sees");
    }
    try {
      write_outputs(session, report, as_float(film));
      if (stats_file_) {
        const std::string json =
            report_json(report);  // before there is a file, as where memory is out it may not throw
        AtomicFile file(*stats_file_);
        file.stream() << json;
        file.commit();
      }
    } catch (const std::exception&) {
      if (!interrupted()) keep(session);
      throw;
    }
    if (!job_.command.quiet) say(report);
    if (interrupted()) return false;
    std::error_code ignored;
    std::filesystem::remove(checkpoint_, ignored);
    return true;
  }

 private:
  static RenderOptions options_of(const Job& job, const Shot& shot) {
    RenderOptions options = session_options(job.command, job.loaded);
    options.camera = shot.camera;
    return options;
  }

  bool interrupted() const { return stopped_by_ == "interrupt"; }

  std::optional<Film> film_to_go_on_from() {
    if (!job_.command.resume) {
      if (std::filesystem::exists(checkpoint_)) {
        job_.warn(checkpoint_.string() + " is left of an earlier render, and is not gone on from without --resume");
      }
      return std::nullopt;
    }
    std::optional<ResumedFilm> resumed = resumed_film(outputs_, info_);
    if (!job_.command.quiet) {
      if (resumed) {
        std::printf("resumed    %s with %u to %u of %u samples a pixel\n", resumed->file.c_str(), resumed->taken.first,
                    resumed->taken.end, options_.samples_per_pixel);
      } else {
        std::printf("resumed    nothing: there is no %s\n", checkpoint_.c_str());
      }
      std::fflush(stdout);
    }
    if (!resumed) return std::nullopt;
    seconds_before_ = resumed->seconds;
    return std::move(resumed->film);
  }

  /// Until the session has ended by itself, an interrupt or the time limit.
  void wait(RenderSession& session) {
    Progress progress(job_.command.progress, session.progress());
    const auto warn = [this](const std::string& failure) { job_.warn(failure); };
    RepeatedWriter checkpoints([&] { write_checkpoint(session); }, warn);
    RepeatedWriter pictures([&] { write_outputs(session, report_so_far(session), job_.command.exr == "float"); }, warn);
    RepeatedWriter errors([&] { estimate_error(session, progress); }, warn);
    const Stopwatch watch;
    session.start();
    while (!session.wait_for(0.05)) {
      const double done = session.progress(), share = session.time_share();
      progress.update(done, share);
      checkpoints.write_every(
          checkpoint_interval(job_.command, progress.expected_seconds(done, share), checkpoints.last_seconds()));
      errors.write_every(error_interval(errors.last_seconds()));
      if (job_.command.write_every) pictures.write_every(*job_.command.write_every);
      if (QuestionGuard::asked()) progress.say(done, share);
      if (!stopped_by_.empty()) continue;
      if (InterruptGuard::interrupted()) stopped_by_ = "interrupt";
      if (job_.command.time_limit && watch.seconds() >= *job_.command.time_limit) stopped_by_ = "--time-limit";
      if (!stopped_by_.empty()) session.request_stop();
    }
    session.stop();
    progress.finish(session.progress());
    if (session.finished()) stopped_by_ = session.progress() < 1.0 ? "--target-error" : "samples";
  }

  /// Of what is done so far, by rows, as copying the whole would take the film's memory again.
  static void estimate_error(const RenderSession& session, Progress& progress) {
    constexpr int kBand = 16;
    RelmseEstimator estimator = session.error_estimator();
    const int height = session.options().height;
    for (int first = 0; first < height; first += kBand) {
      const int above = std::min(first, 1), count = std::min(kBand, height - first);
      const int below = std::min(height - first - count, 1);  // rows beside, which are seen as neighbours
      estimator.add(session.snapshot_rows(first - above, above + count + below), above, count);
    }
    const RelmseEstimate error = estimator.estimate();
    if (error.relmse < kInfinity) progress.set_error(error.relmse, error.reliable);
  }

  /// Seconds between estimates of the error, so that they take no more than a thousandth of the time of all threads.
  double error_interval(double last_seconds) const {
    constexpr double kSecondsPerPixel = 3e-7;  // before one is measured
    const double each = last_seconds > 0.0 ? last_seconds : kSecondsPerPixel * options_.width * options_.height;
    const int threads = job_.command.threads > 0 ? job_.command.threads : hardware_threads();
    return std::max(1.0, 1000.0 * each / threads);
  }

  FilmPicture picture_of(const RenderSession& session, const RenderReport& report) const {
    FilmPicture picture;
    picture.width = options_.width;
    picture.height = options_.height;
    picture.rows = [&session](int first, int count) { return session.snapshot_rows(first, count); };
    picture.attributes = make_attributes(report);
    picture.film = info_;
    picture.film->seconds = report.stats.seconds + seconds_before_;
    return picture;
  }

  void write_checkpoint(const RenderSession& session) const {
    write_film_picture(checkpoint_, picture_of(session, report_so_far(session)));
  }

  /// Writes the checkpoint where it belongs or, where that cannot be, among the system's temporary files, and says so,
  /// be it quiet or not.
  void keep(const RenderSession& session) {
    const std::filesystem::path usual = checkpoint_;
    try {
      write_checkpoint(session);
    } catch (const std::exception& e) {
      job_.warn_always(e.what());
      std::error_code none;
      checkpoint_ = std::filesystem::temp_directory_path(none) / usual.filename();
      try {
        write_checkpoint(session);
      } catch (const std::exception& second) {
        job_.warn_always(second.what());
        checkpoint_.clear();
        return;
      }
      job_.warn_always("so the render is kept in " + checkpoint_.string() + ": as " + usual.string() +
                       " --resume takes it");
      return;
    }
    // An interrupted render says it with its report, where it is not quiet.
    if (!interrupted() || job_.command.quiet)
      job_.warn_always("the render is kept in " + checkpoint_.string() + ": --resume goes on from it");
  }

  void write_outputs(const RenderSession& session, const RenderReport& report, bool as_float) const {
    FilmPicture picture = picture_of(session, report);
    picture.as_float = as_float;
    picture.variance = wants(job_.command, "variance");
    picture.samples = wants(job_.command, "samples");
    picture.layers = feature_layers(job_, options_);
    if (!job_.command.film && !job_.command.samples) picture.film.reset();
    for (const auto& file : outputs_) write_film_picture(file, picture);
  }

  bool as_float(const Film& film) const {
    if (!job_.command.exr.empty()) return job_.command.exr == "float";
    const auto is_exr = [](const auto& file) { return lowercase_ending(file) == ".exr"; };
    if (std::none_of(outputs_.begin(), outputs_.end(), is_exr) || fits_half(film)) return false;
    job_.warn(
        "the EXR picture holds floats, as half would lose values beyond 65504 or near 0; --exr half or float says "
        "which");
    return true;
  }

  /// For threads that write while this one waits.
  RenderReport report_so_far(const RenderSession& session) const { return report_of(session, "not yet", {}, {}); }

  RenderReport report_of(const RenderSession& session, const std::string& stopped_by, const RelmseEstimate& error,
                         SampleRange taken) const {
    return {job_.command,
            job_.loaded,
            options_,
            job_.accelerator.build_report(),
            session.stats(),
            session.needs(),
            session.integrator().lights().count,
            session.integrator().lights().bytes,
            session.integrator().mirror_chains(),
            session.integrator().sphere_chains(),
            job_.load_seconds,
            error,
            stopped_by == "not yet" || stopped_by == "interrupt",
            stopped_by,
            taken,
            seconds_before_};
  }

  void say(const RenderReport& report) const {
    if (!job_.command.fly) std::fputs(report_text(report).c_str(), stdout);
    if (job_.loaded.made_for_model && job_.command.write_scene.empty()) {
      std::printf("scene      made for the model; --write-scene FILE.toml keeps it, to go on from there\n");
    }
    for (const auto& file : outputs_) {
      std::printf("wrote      %s%s\n", file.c_str(), report.partial ? " (partial: interrupted)" : "");
    }
    if (interrupted() && !checkpoint_.empty())
      std::printf("checkpoint %s; --resume goes on from it\n", checkpoint_.c_str());
  }

  const Job& job_;
  RenderOptions options_;
  Files outputs_;
  std::optional<std::filesystem::path> stats_file_;
  std::filesystem::path checkpoint_;
  FilmInfo info_;
  double seconds_before_ = 0.0;
  std::string stopped_by_;  // empty while it renders
};

}  // namespace

void Job::warn(const std::string& warning) const {
  if (!command.quiet) warn_always(warning);
}

void Job::warn_always(const std::string& warning) const {
  std::fprintf(stderr, "raylab-render: warning: %s\n", warning.c_str());
}

bool render_shot(const Job& job, const Shot& shot, const Files& outputs) {
  return ShotRender(job, shot, outputs).run();
}

}  // namespace raylab
