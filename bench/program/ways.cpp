#include "ways.hpp"

#include <algorithm>
#include <cmath>

namespace raylab::bench {

namespace {

double mean_of(const std::vector<double>& values, std::size_t begin, std::size_t end) {
  double sum = 0.0;
  for (std::size_t i = begin; i < end; ++i) sum += values[i];
  return sum / static_cast<double>(end - begin);
}

/// Returns the relMSE that each of the peer's pictures has against their mean. Where its model is not quite ours this
/// is noise alone, with no share of the difference.
std::vector<double> noise_of(const std::vector<PeerRun>& runs, const Image& reference) {
  const auto n = static_cast<float>(runs.size());
  Image mean = reference;
  for (std::size_t i = 0; i < mean.pixels.size(); ++i) {
    mean.pixels[i] = Rgb(0.0f);
    for (const PeerRun& run : runs) mean.pixels[i] += run.image.pixels[i] / n;
  }
  std::vector<double> noise;
  for (const PeerRun& run : runs) {
    Image off = reference;
    for (std::size_t i = 0; i < mean.pixels.size(); ++i) off.pixels[i] += run.image.pixels[i] - mean.pixels[i];
    noise.push_back(image_error(off, reference).relmse * n / (n - 1.0));  // each has a share in the mean
  }
  return noise;
}

/// What the runs' own samples say of their errors, where they say anything.
void add_estimates(Row& row, const std::vector<RelmseEstimate>& estimates) {
  RelmseEstimate mean{0.0, 0.0, 0.0, true};
  const auto n = static_cast<double>(estimates.size());
  for (const RelmseEstimate& estimate : estimates) {
    mean.relmse += estimate.relmse / n;
    mean.low += estimate.low / n;
    mean.high += estimate.high / n;
    mean.reliable = mean.reliable && estimate.reliable;
  }
  if (!std::isfinite(mean.relmse)) return;
  row["estimated_relmse"] = mean.relmse;
  if (std::isfinite(mean.high)) row["estimated_relmse_95"] = {{"low", mean.low}, {"high", mean.high}};
  row["estimated_relmse_reliable"] = mean.reliable;
}

}  // namespace

std::string name_of(const Row& row) {
  std::string name = row.contains("renderer") ? row["renderer"].get<std::string>() : variant_name(row);
  for (const char* field : {"integrator", "sampler"}) {
    const std::string value = row.value(field, "");
    if (!value.empty() && value != "path" && value != "sobol") name += std::string(", ") + field + " " + value;
  }
  return row.contains("ray_offset") ? name + ", offset of the book" : name;
}

void Way::begin(Suite&, int) { runs_ = {}; }

std::vector<ErrorAtTime> Way::points() const {
  std::vector<ErrorAtTime> points;
  for (auto runs = kept_.rbegin(); runs != kept_.rend(); ++runs)
    points.push_back({spread_of(runs->seconds).median, mean_of(runs->relmse, 0, runs->relmse.size())});
  return points;
}

std::size_t Way::rounds() const {
  std::size_t fewest = kept_.empty() ? 0 : kept_.front().seconds.size();
  for (const Runs& runs : kept_) fewest = std::min(fewest, runs.seconds.size());
  return fewest;
}

std::vector<double> Way::times_by_round(std::size_t rounds, double target) const {
  std::vector<double> times;
  for (std::size_t round = 0; round < rounds; ++round) {
    std::vector<ErrorAtTime> points;
    for (auto runs = kept_.rbegin(); runs != kept_.rend(); ++runs) {
      const std::size_t n = runs->seconds.size(), begin = round * n / rounds, end = (round + 1) * n / rounds;
      points.push_back({mean_of(runs->seconds, begin, end), mean_of(runs->relmse, begin, end)});
    }
    times.push_back(time_to_error(points, target).seconds);
  }
  return times;
}

void Way::finish_row(Row row, double work) {
  add_times(row, runs_.seconds, work);
  row["cpu_seconds"] = spread_of(runs_.cpu_seconds).median;
  add_fields(row, combine(runs_.errors, context_.reference), context_.reference);
  last_row_ = std::move(row);
}

void OwnWay::begin(Suite& suite, int spp) {
  Way::begin(suite, spp);
  estimates_.clear();
  render_once(suite, context_.loaded.scene, *built_.accelerator, options_for(context_, configuration_, 1, 0));  // warm
}

void OwnWay::render(Suite& suite, int spp, int run) {
  const Rendered rendered =
      render_once(suite, context_.loaded.scene, *built_.accelerator, options_for(context_, configuration_, spp, run));
  runs_.seconds.push_back(rendered.seconds);
  runs_.cpu_seconds.push_back(rendered.cpu_seconds);
  runs_.errors.push_back(image_error(rendered.image, context_.reference.image));
  runs_.relmse.push_back(own_relmse(runs_.errors.back().relmse, context_.reference));  // as a peer's noise is its own
  rays_ = rendered.rays;
  estimates_.push_back(rendered.error);
}

bool OwnWay::end(Suite&, int spp) {
  const RenderOptions o = options_for(context_, configuration_, spp, 0);
  Row row = scene_row(context_);
  add_fields(row, configuration_.variant, context_.loaded.scene.geometry, built_);
  add_fields(row, o);
  if (o.integrator.ray_offset == RayOffset::book) row["ray_offset"] = "book";
  const Spread seconds = spread_of(runs_.seconds);
  const double rays = 1e-6 * static_cast<double>(rays_.total());
  row["mrays_per_second"] = to_row({rays / seconds.median, rays / seconds.max, rays / seconds.min});
  add_estimates(row, estimates_);
  finish_row(std::move(row), work_of(o));
  keep();
  return true;
}

PeerWay::PeerWay(const SceneContext& context, const Peer& peer, Suite& suite)
    : Way(context),
      peer_(peer),
      process_(std::make_unique<PeerProcess>(peer, context.options.peer_python, context.file,
                                             options_for(context, Configuration(), 1, 0), context.threads,
                                             context.options.peer_minutes, [&suite] { suite.check(); })) {}

void PeerWay::begin(Suite& suite, int spp) {
  Way::begin(suite, spp);
  pictures_.clear();
}

void PeerWay::render(Suite& suite, int spp, int run) {
  const RenderOptions o = options_for(context_, Configuration(), spp, run);
  PeerRun rendered = process_->run(o.seed, o.samples_per_pixel);
  // More than this would take part of the processors that others are measured on.
  constexpr double kBusy = 0.02;
  if (rendered.waited_cpu_seconds > kBusy * std::max(1.0, rendered.waited_seconds)) {
    suite.note(format("%s took %.2f s of the processors in %.1f s of waiting for its turn", peer_.name.c_str(),
                      rendered.waited_cpu_seconds, rendered.waited_seconds));
  }
  runs_.seconds.push_back(rendered.seconds);
  runs_.cpu_seconds.push_back(rendered.cpu_seconds);
  runs_.errors.push_back(image_error(rendered.image, context_.reference.image));
  pictures_.push_back(std::move(rendered));
}

bool PeerWay::end(Suite& suite, int spp) {
  if (const double median = spread_of(runs_.seconds).median; median < kPeerSeconds) {
    suite.note(format("%s: %s with %d samples a pixel takes %.2f s, less than %g: not taken",
                      context_.loaded.scene.name.c_str(), peer_.name.c_str(), spp, median, kPeerSeconds));
    leave_out();
    return false;
  }
  runs_.relmse = noise_of(pictures_, context_.reference.image);
  const PeerSettings& settings = process_->settings();
  RenderOptions o = options_for(context_, Configuration(), spp, 0);
  o.samples_per_pixel = pictures_.front().samples_per_pixel;
  Row row = scene_row(context_);
  row["renderer"] = peer_.name + " " + settings.version + " " + settings.variant;
  row["accel"] = peer_.name;
  row["peer"] = peer_.name;
  row["version"] = settings.version;
  row["settings"] = settings.settings;
  row["differences"] = settings.differences;
  add_size(row, o);
  row["start_up_seconds"] = pictures_.front().start_up_seconds;
  row["relmse_noise"] = mean_of(runs_.relmse, 0, runs_.relmse.size());
  finish_row(std::move(row), work_of(o));
  keep();
  return true;
}

void PeerWay::leave_out() {
  Way::leave_out();
  process_.reset();
}

}  // namespace raylab::bench
