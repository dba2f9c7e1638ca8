// raylab-bench needs: how little a scene can be rendered with, found by measuring.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "commands.hpp"
#include "raylab/core/error.hpp"
#include "raylab/core/parallel.hpp"
#include "rendering.hpp"

namespace raylab::bench {

namespace {

// Leaving one thing out may cost this share of the error that is allowed in all.
constexpr double kShare = 0.1;
// So many segments stand for all of them, since roulette ends paths long before.
constexpr int kAllSegments = 256;
// An accelerator is chosen by renders of so many seconds in all, and so many that their median has an interval; one
// whose first render took so many times as long as the best is out of the question.
constexpr double kLeastSeconds = 1.0;
constexpr int kFewestForInterval = 6;
constexpr double kHopeless = 2.0;

/// What a scene is rendered with.
struct Configuration {
  Variant variant{kDefaultAccelerator, "watertight", BuildQuality::balanced};
  IntegratorKind integrator = IntegratorKind::path;
  SamplerKind sampler = SamplerKind::sobol;
  bool all_needs = false;  ///< a sky of one colour is then sampled as a light
  int max_depth = 0;
  int spp = 0;
};

struct Cost {
  RunErrors errors;
  std::vector<double> seconds;
  double median() const { return spread_of(seconds).median; }
};

/// Measures one scene, and reports it row by row.
class SceneMeasurement {
 public:
  SceneMeasurement(Suite& suite, const LoadedScene& loaded, const std::string& file, const NeedsOptions& options)
      : suite_(suite), loaded_(loaded), scene_(loaded.scene), file_(file), options_(options) {}

  void run();

 private:
  Row row(const char* question) const;
  RenderOptions options_for(const Configuration& configuration, std::uint32_t run) const;
  Cost measure(const Configuration& configuration, const Accelerator& accelerator) const;
  void add_configuration(Row& row, const Configuration& configuration) const;

  void report_uses() const;
  int choose_depth(const Configuration& configuration, const Accelerator& accelerator) const;
  void report_energy(const Configuration& configuration, const Accelerator& accelerator) const;
  Configuration choose_strategy(Configuration configuration, const Accelerator& accelerator) const;
  struct Choice {
    Built built;
    std::vector<std::string> ties;  ///< variants that may be as fast
  };
  Choice choose_accelerator(const Configuration& configuration) const;
  void report_cheapest(Configuration configuration, const Choice& choice, const Cost& first) const;

  Suite& suite_;
  const LoadedScene& loaded_;
  const Scene& scene_;
  const std::string& file_;
  const NeedsOptions& options_;
  Reference reference_;
};

Row SceneMeasurement::row(const char* question) const {
  return {{"suite", "needs"}, {"scene", scene_.name}, {"question", question}};
}

RenderOptions SceneMeasurement::options_for(const Configuration& configuration, std::uint32_t run) const {
  RenderOptions o = options_of(loaded_, options_.width);
  o.integrator.kind = configuration.integrator;
  o.integrator.max_depth = configuration.max_depth;
  o.sampler = configuration.sampler;
  o.samples_per_pixel = static_cast<std::uint32_t>(configuration.spp);
  o.seed = options_.seed + 1 + run;
  if (configuration.all_needs) o.needs = raylab::all_needs();
  return o;
}

Cost SceneMeasurement::measure(const Configuration& configuration, const Accelerator& accelerator) const {
  Cost cost;
  std::vector<ImageError> errors;
  for (int run = 0; run < options_.repeats; ++run) {
    const RenderOptions o = options_for(configuration, static_cast<std::uint32_t>(run));
    suite_.expect(work_of(o));
    const Rendered rendered = render_once(suite_, scene_, accelerator, o);
    cost.seconds.push_back(rendered.seconds);
    errors.push_back(image_error(rendered.image, reference_.image));
  }
  cost.errors = combine(errors, reference_);
  return cost;
}

void SceneMeasurement::add_configuration(Row& row, const Configuration& configuration) const {
  add_fields(row, configuration.variant);
  add_fields(row, options_for(configuration, 0));
  if (configuration.all_needs) row["needs"] = "all";
}

void SceneMeasurement::report_uses() const {
  Row uses = row("uses");
  uses["uses"] = describe(scene_needs(scene_));
  uses["triangles"] = scene_.geometry.triangle_count();
  uses["spheres"] = scene_.geometry.spheres.size();
  uses["scene_bytes"] = scene_.bytes();
  uses["dropped_bytes"] = loaded_.dropped_bytes;
  std::vector<std::string> lines{scene_.name + " uses"};
  for (const std::string& line : uses["uses"]) lines.push_back(line);
  suite_.add({uses}, lines);
}

double luminance_sum(const Image& image) {
  double sum = 0.0;
  for (const Rgb& p : image.pixels) sum += 0.2126 * p.r + 0.7152 * p.g + 0.0722 * p.b;
  return sum;
}

/// Reports how much light arrives by paths of so many segments and fewer. All of them have equal random numbers,
/// so that what a shorter path finds, a longer one finds too.
void SceneMeasurement::report_energy(const Configuration& configuration, const Accelerator& accelerator) const {
  const auto energy = [&](int segments) {
    Configuration c = configuration;
    c.max_depth = segments;
    const RenderOptions o = options_for(c, 0);
    suite_.expect(work_of(o));
    return luminance_sum(render_once(suite_, scene_, accelerator, o).image);
  };
  constexpr double kNothingLeft = 5e-4;
  const double all = energy(kAllSegments);
  int for_1_percent = 0;
  for (int segments = 1; all > 0.0 && segments < kAllSegments; segments += 1 + segments / 12) {
    const double missing = 1.0 - energy(segments) / all;
    Row r = row("energy by segment");
    r["segment"] = segments;
    r["missing_energy"] = missing;
    suite_.add({r}, {format("%-12s %3d segments: %.3f%% of the light is missing", scene_.name.c_str(), segments,
                            100.0 * missing)});
    if (missing < 0.01 && for_1_percent == 0) for_1_percent = segments;
    if (missing < 1e-3) {
      Row depth = row("segments needed");
      depth["for_1_percent"] = for_1_percent;
      depth["for_0.1_percent"] = segments;
      suite_.add({depth}, {format("%-12s 1%% takes %d segments, 0.1%% takes %d; the scene file says %d",
                                  scene_.name.c_str(), for_1_percent, segments, scene_.render.max_depth)});
      break;
    }
    if (missing < kNothingLeft) break;
  }
}

/// Returns the fewest segments whose picture is within its share of the error of that with as many as the file
/// says.
int SceneMeasurement::choose_depth(const Configuration& configuration, const Accelerator& accelerator) const {
  const auto picture = [&](int segments) {
    Configuration c = configuration;
    c.max_depth = segments;
    const RenderOptions o = options_for(c, 0);
    suite_.expect(work_of(o));
    return render_once(suite_, scene_, accelerator, o).image;
  };
  const Image full = picture(scene_.render.max_depth);
  int too_few = 0;
  int enough = scene_.render.max_depth;
  while (enough - too_few > 1) {
    const int middle = (too_few + enough) / 2;
    const bool suffices = image_error(picture(middle), full).relmse < kShare * options_.target_error;
    (suffices ? enough : too_few) = middle;
  }
  return enough;
}

Configuration SceneMeasurement::choose_strategy(Configuration configuration, const Accelerator& accelerator) const {
  Configuration best = configuration;
  double least = kInfinity;
  const bool sky = !scene_.environment.is_black();
  for (const IntegratorKind integrator : {IntegratorKind::path, IntegratorKind::book}) {
    for (const SamplerKind sampler : {SamplerKind::sobol, SamplerKind::independent}) {
      for (const bool all_needs : {false, true}) {
        if (all_needs && (!sky || integrator == IntegratorKind::book)) continue;
        configuration.integrator = integrator;
        configuration.sampler = sampler;
        configuration.all_needs = all_needs;
        const Cost cost = measure(configuration, accelerator);
        Row r = row("strategy");
        add_configuration(r, configuration);
        add_times(r, cost.seconds, work_of(options_for(configuration, 0)));
        add_fields(r, cost.errors, reference_);
        // Samples halve the error in twice the time: their product is what a strategy costs.
        const double cost_product = cost.errors.relmse * cost.median();
        r["relmse_seconds"] = cost_product;
        suite_.add({r},
                   {format("%-12s %s, %s%s: relMSE %.3g in %.3f s, product %.3g", scene_.name.c_str(),
                           std::string(integrator_name(integrator)).c_str(), std::string(sampler_name(sampler)).c_str(),
                           all_needs ? ", sky sampled" : "", cost.errors.relmse, cost.median(), cost_product)});
        if (cost_product < least) {
          least = cost_product;
          best = configuration;
        }
      }
    }
  }
  return best;
}

/// Chooses the fastest accelerator, building included, whose picture differs from the reference accelerator's by no
/// more than its share of the error, and names those that the measurement cannot tell from it.
SceneMeasurement::Choice SceneMeasurement::choose_accelerator(const Configuration& configuration) const {
  // Its pictures equal those of list to the bit, which is tested.
  const auto reference = make_accelerator(kDefaultAccelerator, scene_.geometry);
  const RenderOptions o = options_for(configuration, 0);
  const Image expected = render_once(suite_, scene_, *reference, o).image;
  struct Candidate {
    Built built;
    double relmse;
    std::vector<double> seconds;
    double total() const { return built.build_seconds.median + spread_of(seconds).median; }
    bool measured(int repeats) const {
      return static_cast<int>(seconds.size()) >= repeats &&
             std::accumulate(seconds.begin(), seconds.end(), 0.0) >= kLeastSeconds;
    }
  };
  const auto is_good = [&](const Candidate& c) { return c.relmse < kShare * options_.target_error; };
  const auto render_again = [&](Candidate& c) {
    suite_.expect(work_of(o));
    Rendered rendered = render_once(suite_, scene_, *c.built.accelerator, o);
    c.seconds.push_back(rendered.seconds);
    return std::move(rendered.image);
  };
  std::vector<Candidate> candidates;
  double least = kInfinity;
  for (const Variant& v : variants(options_)) {
    if (!is_fit(v, scene_.geometry.primitive_count())) continue;
    Candidate c{build(v, scene_.geometry, options_.threads), 0.0, {}};
    c.relmse = image_error(render_again(c), expected).relmse;
    if (is_good(c)) least = std::min(least, c.total());
    candidates.push_back(std::move(c));
  }
  if (least == kInfinity) throw Error(ErrorKind::failure, scene_.name, "no accelerator is good enough");
  // Those that may be the fastest take turns.
  const auto in_question = [&](const Candidate& c) { return is_good(c) && c.seconds[0] < kHopeless * least; };
  const int repeats = std::max(options_.repeats, kFewestForInterval);
  for (bool again = true; again;) {
    again = false;
    for (Candidate& c : candidates) {
      if (!in_question(c)) continue;
      render_again(c);
      again = again || !c.measured(repeats);
    }
  }
  Candidate* best = nullptr;
  for (Candidate& c : candidates) {
    Row r = row("accelerator");
    add_fields(r, c.built.variant, scene_.geometry, c.built);
    Configuration tried = configuration;
    tried.variant = c.built.variant;
    add_configuration(r, tried);
    add_times(r, c.seconds, work_of(o));
    r["relmse"] = c.relmse;
    r["good_enough"] = is_good(c);
    suite_.add({r}, {format("%-12s %-18s built in %.3f s, rendered in %.3f s, relMSE %.2g against bvh%s",
                            scene_.name.c_str(), c.built.variant.name().c_str(), c.built.build_seconds.median,
                            spread_of(c.seconds).median, c.relmse, is_good(c) ? "" : ": too far off")});
    if (in_question(c) && (best == nullptr || c.total() < best->total())) best = &c;
  }
  Choice choice;
  for (const Candidate& c : candidates) {
    if (&c == best || !in_question(c)) continue;
    std::vector<double> ratios;  // of renders of the same turn
    for (std::size_t i = 0; i < c.seconds.size(); ++i) {
      ratios.push_back((c.built.build_seconds.median + c.seconds[i]) /
                       (best->built.build_seconds.median + best->seconds[i]));
    }
    if (median_interval(ratios, 0.95).low <= 1.0) choice.ties.push_back(c.built.variant.name());
  }
  choice.built = std::move(best->built);
  return choice;
}

void SceneMeasurement::report_cheapest(Configuration configuration, const Choice& choice, const Cost& first) const {
  constexpr int kMostAttempts = 6;
  const double target = options_.target_error;
  // With more samples than the reference has, the error measured would be the reference's own.
  const auto limited = [&](double spp) {
    return std::clamp(static_cast<int>(std::ceil(spp)), 1, options_.reference_spp);
  };
  configuration.spp = limited(configuration.spp * first.errors.relmse / target);
  Cost cost;
  for (int i = 0;; ++i) {
    cost = measure(configuration, *choice.built.accelerator);
    // Two standard errors on top make it hold for this scene, and not for these seeds only.
    const double upper_bound = cost.errors.relmse + 2.0 * (options_.repeats > 1 ? cost.errors.relmse_error : 0.0);
    if (upper_bound < target || i == kMostAttempts || configuration.spp == options_.reference_spp) break;
    configuration.spp = limited(configuration.spp * std::clamp(upper_bound / target, 1.1, 2.0));
  }
  const bool kept = cost.errors.relmse < target;
  if (!kept) suite_.note(scene_.name + ": the error was not kept; raise --reference-spp or --target-error");
  const std::string lines =
      format("[render]\nsamples_per_pixel = %d\nmax_depth = %d", configuration.spp, configuration.max_depth);
  std::string command = "raylab-render " + file_;
  for (const std::string& argument : configuration.variant.arguments()) command += " " + argument;
  command += " --integrator " + std::string(integrator_name(configuration.integrator)) + " --sampler " +
             std::string(sampler_name(configuration.sampler));
  if (configuration.all_needs) command += " --needs all";
  command += format(" --width %d --spp %d --set render.max_depth=%d -o %s.png", options_.width, configuration.spp,
                    configuration.max_depth, scene_.name.c_str());
  Row r = row("cheapest");
  add_fields(r, configuration.variant, scene_.geometry, choice.built);
  add_configuration(r, configuration);
  add_times(r, cost.seconds, work_of(options_for(configuration, 0)));
  add_fields(r, cost.errors, reference_);
  r["allowed_relmse"] = target;
  r["kept"] = kept;
  r["scene_file"] = lines;
  r["command"] = command;
  std::string tied;
  if (!choice.ties.empty()) r["ties"] = choice.ties;
  for (const std::string& name : choice.ties) tied += (tied.empty() ? "; no slower as far as measured: " : ", ") + name;
  // An earlier run may have had another winner, whose row has another key.
  suite_.folder().remove({{"suite", "needs"}, {"scene", scene_.name}, {"question", "cheapest"}});
  suite_.add({r}, {format("%-12s the cheapest found for relMSE %g at a width of %d: relMSE %.3g in %.3f s%s",
                          scene_.name.c_str(), target, options_.width, cost.errors.relmse, cost.median(), tied.c_str()),
                   lines, "# " + command});
}

void SceneMeasurement::run() {
  const auto accelerator = make_accelerator(kDefaultAccelerator, scene_.geometry);
  report_uses();
  Configuration configuration;
  configuration.spp = options_.spp;
  configuration.max_depth = scene_.render.max_depth;
  RenderOptions for_reference = options_for(configuration, 0);
  for_reference.samples_per_pixel = static_cast<std::uint32_t>(options_.reference_spp);
  suite_.expect(work_of(for_reference));
  std::filesystem::path cache = options_.cache;
  if (cache.empty()) cache = suite_.folder().path() / "references";
  reference_ = reference_of(suite_, loaded_, *accelerator, for_reference, options_.reference_spp, cache);
  if (reference_.relmse > kShare * options_.target_error) {
    suite_.note(format("%s: the reference's own relMSE is %.2g: too much to judge %g by; raise --reference-spp",
                       scene_.name.c_str(), reference_.relmse, options_.target_error));
  }
  report_energy(configuration, *accelerator);
  configuration.max_depth = choose_depth(configuration, *accelerator);
  configuration = choose_strategy(configuration, *accelerator);
  const Cost cost = measure(configuration, *accelerator);
  const Choice choice = choose_accelerator(configuration);
  configuration.variant = choice.built.variant;
  report_cheapest(configuration, choice, cost);
}

}  // namespace

int needs(const NeedsOptions& options) {
  (void)variants(options);
  Suite suite(options, "needs");
  const InterruptGuard guard;
  const ThreadLimit limit(options.threads);
  for (const std::string& file : options.scenes) {
    const LoadedScene loaded = load(suite, file);
    if (suite.measured(file)) continue;
    SceneMeasurement(suite, loaded, file, options).run();
    suite.end_part(file);
  }
  suite.finish();
  return 0;
}

}  // namespace raylab::bench
