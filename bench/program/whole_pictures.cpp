#include "whole_pictures.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "raylab/core/error.hpp"
#include "ways.hpp"

namespace raylab::bench {

namespace {

std::string line_of(const Row& row) {
  return format("%-12s %-32s %4d spp  %7.3f s  relMSE %-8.3g ± %-8.2g trimmed %-8.3g mean ratio %.5f ± %.5f",
                row["scene"].get<std::string>().c_str(), name_of(row).c_str(), row["spp"].get<int>(),
                row["seconds"].get<double>(), row["relmse"].get<double>(), row.value("relmse_error", 0.0),
                row["relmse_trimmed"].get<double>(), row["mean_ratio"].get<double>(),
                row["mean_ratio_error"].get<double>());
}

/// Adds the row that says when the way reaches the target, and how many times as long that takes as in `base`.
void add_time_to_error(const SceneContext& context, Suite& suite, const Way& way, const Way& base) {
  const double target = context.options.target_error;
  const TimeToError time = time_to_error(way.points(), target);
  Row row = way.last_row();
  for (const char* field :
       {"spp", "runs", "seconds_min", "seconds_max", "cpu_seconds", "mpaths_per_second", "mrays_per_second",
        "start_up_seconds", "relmse_noise", "relmse_error", "relmse_trimmed", "mean_ratio", "mean_ratio_error",
        "estimated_relmse", "estimated_relmse_95", "estimated_relmse_reliable"}) {
    row.erase(field);
  }
  row["question"] = "time to error";
  row["target_relmse"] = target;
  row["relmse"] = target;
  row["seconds"] = time.seconds;
  row["extrapolated"] = time.extrapolated;
  std::string line = format("%-12s %-32s relMSE %g after %.3f s%s", context.loaded.scene.name.c_str(),
                            name_of(row).c_str(), target, time.seconds, time.extrapolated ? " (extrapolated)" : "");
  const std::size_t rounds = std::min(way.rounds(), base.rounds());
  if (&way != &base && rounds > 1) {
    const RatioEstimate ratio =
        ratio_of_pairs(way.times_by_round(rounds, target), base.times_by_round(rounds, target), 0.95);
    if (std::isfinite(ratio.interval.high)) {  // not of pictures without any error
      row["against"] = name_of(base.last_row());
      row["runs"] = rounds;
      row["time_ratio"] = {{"mean", ratio.mean}, {"low", ratio.interval.low}, {"high", ratio.interval.high}};
      line += format(", %.2f times that of %s (95%%: %.2f to %.2f)", ratio.mean,
                     row["against"].get<std::string>().c_str(), ratio.interval.low, ratio.interval.high);
    }
  }
  suite.add({row}, {line});
}

/// Renders the round, and leaves out a way that fails where it may.
void take_turns(Suite& suite, std::vector<std::unique_ptr<Way>>& ways, int spp, int run) {
  for (std::size_t i = 0; i < ways.size(); ++i) {
    Way& way = *ways[run % 2 == 0 ? i : ways.size() - 1 - i];
    if (way.is_out()) continue;
    try {
      way.render(suite, spp, run);
    } catch (const Error& e) {
      if (!way.may_fail()) throw;
      suite.note(std::string("left out: ") + e.what());
      way.leave_out();
    }
  }
}

}  // namespace

RenderOptions options_for(const SceneContext& context, const Configuration& configuration, int spp, int run) {
  RenderOptions o = options_of(context.loaded, context.options.width);
  o.integrator.kind = parse_integrator(configuration.integrator);
  o.integrator.ray_offset = configuration.ray_offset == "book" ? RayOffset::book : RayOffset::bounds;
  o.sampler = parse_sampler(configuration.sampler);
  o.samples_per_pixel = static_cast<std::uint32_t>(spp);
  o.seed = context.options.seed + 1 + static_cast<std::uint32_t>(run);
  return o;
}

Row scene_row(const SceneContext& context) {
  return {{"suite", "render"}, {"scene", context.loaded.scene.name}, {"threads", context.threads}};
}

int runs_of(const RenderSuiteOptions& options, int spp) {
  // A peer's noise takes two pictures to tell; where a render takes so little time that a stall of the machine shows,
  // there are twice as many.
  const int repeats = options.peer_python.empty() ? options.repeats : std::max(2, options.repeats);
  return spp < *std::max_element(options.spp.begin(), options.spp.end()) ? 2 * repeats : repeats;
}

void measure_in_turns(Suite& suite, const SceneContext& context, const std::vector<Configuration>& configurations,
                      const std::vector<Built>& built, const std::vector<Peer>& peers) {
  std::vector<std::unique_ptr<Way>> ways;
  for (std::size_t i = 0; i < configurations.size(); ++i)
    ways.push_back(std::make_unique<OwnWay>(context, configurations[i], built[i]));
  for (const Peer& peer : peers) {
    try {
      ways.push_back(std::make_unique<PeerWay>(context, peer, suite));
    } catch (const Error& e) {
      suite.note(std::string("left out: ") + e.what());
    }
  }
  // The longest point comes first: where it is too short for a peer, so are all others.
  for (auto spp = context.options.spp.rbegin(); spp != context.options.spp.rend(); ++spp) {
    for (const auto& way : ways) way->begin(suite, *spp);
    for (int run = 0; run < runs_of(context.options, *spp); ++run) take_turns(suite, ways, *spp, run);
    for (const auto& way : ways) {
      if (way->is_out() || !way->end(suite, *spp)) continue;
      suite.add({way->last_row()}, {line_of(way->last_row())});
    }
  }
  for (const auto& way : ways) {
    if (!way->points().empty()) add_time_to_error(context, suite, *way, *ways.front());
  }
}

}  // namespace raylab::bench
