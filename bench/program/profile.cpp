// raylab-bench profile: the share of a render's time that is spent in the accelerator, and outside it.
#include <atomic>

#include "commands.hpp"
#include "raylab/core/parallel.hpp"
#include "raylab/core/timing.hpp"
#include "rendering.hpp"

namespace raylab::bench {

namespace {

/// Passes all queries on and adds up the seconds that they take. A query of a batch takes thousands of times as
/// long as reading the clock.
class TimedAccelerator final : public Accelerator {
 public:
  explicit TimedAccelerator(const Accelerator& timed) : timed_(timed) {}

  std::optional<Hit> intersect(const Ray& ray) const noexcept override {
    const Timer timer(intersect_seconds_);
    return timed_.intersect(ray);
  }
  bool occluded(const Ray& ray) const noexcept override {
    const Timer timer(occluded_seconds_);
    return timed_.occluded(ray);
  }
  void intersect_batch(const RayBatch& rays, const HitBatch& hits) const noexcept override {
    const Timer timer(intersect_seconds_);
    timed_.intersect_batch(rays, hits);
  }
  void occluded_batch(const RayBatch& rays, std::uint8_t* occluded) const noexcept override {
    const Timer timer(occluded_seconds_);
    timed_.occluded_batch(rays, occluded);
  }
  const BuildReport& build_report() const noexcept override { return timed_.build_report(); }

  double intersect_seconds() const { return intersect_seconds_; }
  double occluded_seconds() const { return occluded_seconds_; }

 private:
  /// Adds the time from its construction to its destruction.
  class Timer {
   public:
    explicit Timer(std::atomic<double>& sum) : sum_(sum) {}
    ~Timer() { sum_.fetch_add(watch_.seconds(), std::memory_order_relaxed); }

   private:
    std::atomic<double>& sum_;
    Stopwatch watch_;
  };

  const Accelerator& timed_;
  mutable std::atomic<double> intersect_seconds_{0.0}, occluded_seconds_{0.0};
};

void measure(Suite& suite, const LoadedScene& loaded, const Variant& variant, const ProfileOptions& options,
             const std::string& part) {
  const Scene& scene = loaded.scene;
  const Built built = build(variant, scene.geometry, 1);
  RenderOptions o = options_of(loaded, options.width);
  o.samples_per_pixel = static_cast<std::uint32_t>(options.spp > 0 ? options.spp : scene.render.samples_per_pixel);
  o.seed = options.seed;
  suite.expect(work_of(o) * options.repeats);
  std::vector<double> seconds, intersect, occluded, shares;
  double estimated_relmse = 0.0;
  for (int run = 0; run < options.repeats; ++run) {
    const TimedAccelerator timed(*built.accelerator);
    const Rendered rendered = render_once(suite, scene, timed, o);
    seconds.push_back(rendered.seconds);
    intersect.push_back(timed.intersect_seconds());
    occluded.push_back(timed.occluded_seconds());
    shares.push_back((intersect.back() + occluded.back()) / rendered.seconds);
    estimated_relmse = rendered.error.relmse;
  }
  Row row{{"suite", "profile"}, {"scene", scene.name}, {"threads", 1}};
  add_fields(row, variant, scene.geometry, built);
  add_fields(row, o);
  add_times(row, seconds, work_of(o));
  row["intersect_seconds"] = to_row(spread_of(intersect));
  row["occluded_seconds"] = to_row(spread_of(occluded));
  row["accelerator_share"] = to_row(spread_of(shares));
  row["estimated_relmse"] = estimated_relmse;
  suite.add(
      {row},
      {format("%-12s %-18s %.1f%% of %.3f s in the accelerator: closest hits %.3f s, shadow rays %.3f s; "
              "estimated relMSE %.4f",
              scene.name.c_str(), variant.name().c_str(), 100.0 * spread_of(shares).median, spread_of(seconds).median,
              spread_of(intersect).median, spread_of(occluded).median, estimated_relmse)},
      part);
}

}  // namespace

int profile(const ProfileOptions& options) {
  const std::vector<Variant> all = variants_or_default(options);
  Suite suite(options, "profile");
  const InterruptGuard guard;
  const ThreadLimit limit(1);
  for (const std::string& file : options.scenes) {
    const LoadedScene loaded = load(suite, file);
    for (const Variant& variant : all) {
      const std::string part = file + " " + variant.name();
      if (!suite.measured(part)) measure(suite, loaded, variant, options, part);
    }
  }
  suite.finish();
  return 0;
}

}  // namespace raylab::bench
