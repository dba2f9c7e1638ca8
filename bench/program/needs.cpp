// raylab-bench needs: how little a scene can be rendered with, found by measuring.
#include <algorithm>
#include <cmath>

#include "commands.hpp"
#include "raylab/core/error.hpp"
#include "raylab/core/parallel.hpp"
#include "rendering.hpp"

namespace raylab::bench {

namespace {

// What leaving something out may cost, of the error that is allowed in all.
constexpr double kShare = 0.1;
// Segments that stand for all of them: roulette ends paths long before.
constexpr int kAllSegments = 256;

/// What to render with.
struct Choice {
  Variant variant{kDefaultAccelerator, "watertight", BuildQuality::balanced};
  IntegratorKind integrator = IntegratorKind::path;
  SamplerKind sampler = SamplerKind::sobol;
  bool everything = false;  ///< all needs on: a sky of one colour is then sampled as a light
  int max_depth = 0;
  int spp = 0;
};

struct Cost {
  RunErrors errors;
  std::vector<double> seconds;
  double median() const { return spread_of(seconds).median; }
};

/// One scene with what is measured on it.
class Study {
 public:
  Study(Suite& suite, const LoadedScene& loaded, const std::string& file, const NeedsOptions& options)
      : suite_(suite), loaded_(loaded), scene_(loaded.scene), file_(file), options_(options) {}

  void run();

 private:
  Row row(const char* question) const;
  RenderOptions options_for(const Choice& choice, std::uint32_t run) const;
  Cost measure(const Choice& choice, const Accelerator& accelerator) const;
  void add_choice(Row& row, const Choice& choice) const;

  void tell_uses() const;
  int choose_depth(const Choice& choice, const Accelerator& accelerator) const;
  void tell_energy(const Choice& choice, const Accelerator& accelerator) const;
  Choice choose_strategy(Choice choice, const Accelerator& accelerator) const;
  Built choose_accelerator(Choice& choice) const;
  void tell_cheapest(Choice choice, const Built& built, const Cost& first) const;

  Suite& suite_;
  const LoadedScene& loaded_;
  const Scene& scene_;
  const std::string& file_;
  const NeedsOptions& options_;
  Reference reference_;
};

Row Study::row(const char* question) const {
  return {{"suite", "needs"}, {"scene", scene_.name}, {"question", question}};
}

RenderOptions Study::options_for(const Choice& choice, std::uint32_t run) const {
  RenderOptions o = options_of(loaded_, options_.width);
  o.integrator.kind = choice.integrator;
  o.integrator.max_depth = choice.max_depth;
  o.sampler = choice.sampler;
  o.samples_per_pixel = static_cast<std::uint32_t>(choice.spp);
  o.seed = options_.seed + 1 + run;
  if (choice.everything) o.needs = all_needs();
  return o;
}

Cost Study::measure(const Choice& choice, const Accelerator& accelerator) const {
  Cost cost;
  std::vector<ImageError> errors;
  for (int run = 0; run < options_.repeats; ++run) {
    const RenderOptions o = options_for(choice, static_cast<std::uint32_t>(run));
    suite_.expect(work_of(o));
    const Rendered rendered = render_once(suite_, scene_, accelerator, o);
    cost.seconds.push_back(rendered.seconds);
    errors.push_back(image_error(rendered.image, reference_.image));
  }
  cost.errors = combine(errors, reference_);
  return cost;
}

void Study::add_choice(Row& row, const Choice& choice) const {
  add_fields(row, choice.variant);
  add_fields(row, options_for(choice, 0));
  if (choice.everything) row["needs"] = "all";
}

void Study::tell_uses() const {
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

/// The light that arrives by paths of so many segments and fewer. Equal random numbers: what a shorter path finds,
/// a longer one finds too.
void Study::tell_energy(const Choice& choice, const Accelerator& accelerator) const {
  const auto energy = [&](int segments) {
    Choice c = choice;
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

/// The fewest segments whose picture is within its share of the error of that with as many as the file says.
int Study::choose_depth(const Choice& choice, const Accelerator& accelerator) const {
  const auto picture = [&](int segments) {
    Choice c = choice;
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

Choice Study::choose_strategy(Choice choice, const Accelerator& accelerator) const {
  Choice best = choice;
  double least = kInfinity;
  const bool sky = !scene_.environment.is_black();
  for (const IntegratorKind integrator : {IntegratorKind::path, IntegratorKind::book}) {
    for (const SamplerKind sampler : {SamplerKind::sobol, SamplerKind::independent}) {
      for (const bool everything : {false, true}) {
        if (everything && (!sky || integrator == IntegratorKind::book)) continue;
        choice.integrator = integrator;
        choice.sampler = sampler;
        choice.everything = everything;
        const Cost cost = measure(choice, accelerator);
        Row r = row("strategy");
        add_choice(r, choice);
        add_times(r, cost.seconds, work_of(options_for(choice, 0)));
        add_fields(r, cost.errors, reference_);
        // Samples halve the error in twice the time: their product is what a strategy costs.
        const double price = cost.errors.relmse * cost.median();
        r["relmse_seconds"] = price;
        suite_.add({r}, {format("%-12s %s, %s%s: relMSE %.3g in %.3f s, product %.3g", scene_.name.c_str(),
                                std::string(integrator_name(integrator)).c_str(),
                                std::string(sampler_name(sampler)).c_str(), everything ? ", sky sampled" : "",
                                cost.errors.relmse, cost.median(), price)});
        if (price < least) {
          least = price;
          best = choice;
        }
      }
    }
  }
  return best;
}

/// The fastest accelerator, building included, whose picture is within its share of the error of the judge's.
Built Study::choose_accelerator(Choice& choice) const {
  // Equal to list to the bit, which is tested.
  const auto judge = make_accelerator(kDefaultAccelerator, scene_.geometry);
  const RenderOptions o = options_for(choice, 0);
  const Image right = render_once(suite_, scene_, *judge, o).image;
  Built best;
  double least = kInfinity;
  for (const Variant& v : variants(options_)) {
    if (!is_fit(v, scene_.geometry.primitive_count())) continue;
    Built built = build(v, scene_.geometry, options_.threads);
    std::vector<double> seconds;
    Image image;
    for (int run = 0; run < options_.repeats; ++run) {
      suite_.expect(work_of(o));
      Rendered rendered = render_once(suite_, scene_, *built.accelerator, o);
      seconds.push_back(rendered.seconds);
      image = std::move(rendered.image);
    }
    const double relmse = image_error(image, right).relmse;
    const double total = built.build_seconds.median + spread_of(seconds).median;
    const bool good = relmse < kShare * options_.target_error;
    choice.variant = v;
    Row r = row("accelerator");
    add_fields(r, v, scene_.geometry, built);
    add_choice(r, choice);
    add_times(r, seconds, work_of(o));
    r["relmse"] = relmse;
    r["good_enough"] = good;
    suite_.add({r}, {format("%-12s %-18s built in %.3f s, rendered in %.3f s, relMSE %.2g against bvh%s",
                            scene_.name.c_str(), v.name().c_str(), built.build_seconds.median,
                            spread_of(seconds).median, relmse, good ? "" : ": too far off")});
    if (good && total < least) {
      least = total;
      best = std::move(built);
      best.variant = v;
    }
  }
  if (!best.accelerator) throw Error(ErrorKind::failure, scene_.name, "no accelerator is good enough");
  choice.variant = best.variant;
  return best;
}

void Study::tell_cheapest(Choice choice, const Built& built, const Cost& first) const {
  constexpr int kTries = 6;
  const double target = options_.target_error;
  // Beyond the samples of the reference, its own error is what would be measured.
  const auto limited = [&](double spp) {
    return std::clamp(static_cast<int>(std::ceil(spp)), 1, options_.reference_spp);
  };
  choice.spp = limited(choice.spp * first.errors.relmse / target);
  Cost cost;
  for (int i = 0;; ++i) {
    cost = measure(choice, *built.accelerator);
    // Two standard errors: right for this scene, and not only for these seeds.
    const double surely = cost.errors.relmse + 2.0 * (options_.repeats > 1 ? cost.errors.relmse_error : 0.0);
    if (surely < target || i == kTries || choice.spp == options_.reference_spp) break;
    choice.spp = limited(choice.spp * std::clamp(surely / target, 1.1, 2.0));
  }
  const bool kept = cost.errors.relmse < target;
  if (!kept) suite_.note(scene_.name + ": the error was not kept; raise --reference-spp or --target-error");
  const std::string lines =
      format("[render]\nsamples_per_pixel = %d\nmax_depth = %d", choice.spp, choice.max_depth);
  std::string command = "raylab-render " + file_;
  for (const std::string& argument : choice.variant.arguments()) command += " " + argument;
  command += " --integrator " + std::string(integrator_name(choice.integrator)) + " --sampler " +
             std::string(sampler_name(choice.sampler));
  if (choice.everything) command += " --needs all";
  Row r = row("cheapest");
  add_fields(r, choice.variant, scene_.geometry, built);
  add_choice(r, choice);
  add_times(r, cost.seconds, work_of(options_for(choice, 0)));
  add_fields(r, cost.errors, reference_);
  r["allowed_relmse"] = target;
  r["kept"] = kept;
  r["scene_file"] = lines;
  r["command"] = command;
  suite_.add({r}, {format("%-12s the cheapest found for relMSE %g at a width of %d: relMSE %.3g in %.3f s",
                          scene_.name.c_str(), target, options_.width, cost.errors.relmse, cost.median()),
                   lines, "# " + command});
}

void Study::run() {
  const auto accelerator = make_accelerator(kDefaultAccelerator, scene_.geometry);
  tell_uses();
  Choice choice;
  choice.spp = options_.spp;
  choice.max_depth = scene_.render.max_depth;
  RenderOptions for_reference = options_for(choice, 0);
  for_reference.samples_per_pixel = static_cast<std::uint32_t>(options_.reference_spp);
  suite_.expect(work_of(for_reference));
  std::filesystem::path cache = options_.cache;
  if (cache.empty()) cache = suite_.folder().path() / "references";
  reference_ = reference_of(suite_, loaded_, *accelerator, for_reference, options_.reference_spp, cache);
  if (reference_.relmse > kShare * options_.target_error) {
    suite_.note(format("%s: the reference's own relMSE is %.2g: too much to judge %g by; raise --reference-spp",
                       scene_.name.c_str(), reference_.relmse, options_.target_error));
  }
  tell_energy(choice, *accelerator);
  choice.max_depth = choose_depth(choice, *accelerator);
  choice = choose_strategy(choice, *accelerator);
  const Cost cost = measure(choice, *accelerator);
  const Built built = choose_accelerator(choice);
  tell_cheapest(choice, built, cost);
}

}  // namespace

int needs(const NeedsOptions& options) {
  (void)variants(options);
  Suite suite(options.out, "needs", options.command_line);
  const InterruptGuard guard;
  const ThreadLimit limit(options.threads);
  for (const std::string& file : options.scenes) {
    const LoadedScene loaded = load(suite, file);
    Study(suite, loaded, file, options).run();
  }
  suite.finish();
  return 0;
}

}  // namespace raylab::bench
