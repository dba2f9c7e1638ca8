// raylab-bench scale: what grows with the number of triangles, and with threads.
#include <algorithm>
#include <functional>
#include <span>
#include <vector>

#include "commands.hpp"
#include "hit_accuracy.hpp"
#include "raylab/core/parallel.hpp"
#include "raylab/core/timing.hpp"
#include "raylab/measure/batch_queries.hpp"
#include "raylab/measure/ray_timing.hpp"
#include "raylab/measure/scale_families.hpp"
#include "suite.hpp"

namespace raylab::bench {

namespace {

constexpr std::size_t kFewest = 1000;

/// The accelerators asked for as they are by default: their triangle tests are the business of `rays`. Where none
/// is named, those that the largest size is not too large for.
std::vector<Variant> scale_variants(const ScaleOptions& options) {
  std::vector<Variant> all = variants(options, false);
  if (options.accels.empty()) std::erase_if(all, [&](const Variant& v) { return !is_fit(v, options.largest); });
  return all;
}

/// Seconds of the wall clock that an accelerator took on several threads, and on one right before.
struct ThreadTimes {
  std::vector<double> several, one;
};

/// Sends all rays through each accelerator on several threads and on one, in pairs, so that a machine whose speed
/// drifts changes no ratio.
std::vector<ThreadTimes> time_on_threads(std::span<const Accelerator* const> accelerators, std::span<const Ray> rays,
                                         int threads, const Repeats& repeats, const std::function<bool()>& stopped) {
  constexpr std::size_t kBlock = 1024;
  const std::size_t blocks = (rays.size() + kBlock - 1) / kBlock;
  std::vector<double> found(blocks);  // what was found, kept so that no query can be left out
  const auto send = [&](std::size_t i) {
    parallel_for(blocks, [&](std::size_t block) {
      double sum = 0.0;
      for (const Ray& ray : rays.subspan(block * kBlock, std::min(kBlock, rays.size() - block * kBlock))) {
        const auto hit = accelerators[i]->intersect(ray);
        sum += hit ? static_cast<double>(hit->t) : 0.0;
      }
      found[block] = sum;
    });
  };
  std::vector<ThreadTimes> times(accelerators.size());
  const auto pair = [&](std::size_t i) {
    for (const auto& [count, seconds] : {std::pair{1, &times[i].one}, std::pair{threads, &times[i].several}}) {
      const ThreadLimit limit(count);
      const Stopwatch watch;
      send(i);
      seconds->push_back(watch.seconds());
    }
  };
  (void)time_interleaved(accelerators.size(), repeats, pair, stopped);
  for (ThreadTimes& t : times) {
    t.one.erase(t.one.begin());  // the warm-up
    t.several.erase(t.several.begin());
  }
  return times;
}

Row speedup_of(const ThreadTimes& times) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < times.one.size(); ++i) ratios.push_back(times.one[i] / times.several[i]);
  return to_row(spread_of(ratios));
}

/// Holds what all rows of one family and size have in common.
struct FamilyContext {
  std::string name;
  const ScaleFamily& made;
};

Row speeds_of(std::size_t rays, const std::vector<double>& seconds) {
  std::vector<double> speeds;
  for (const double s : seconds) speeds.push_back(1e-6 * static_cast<double>(rays) / s);
  return to_row(spread_of(speeds));
}

/// Completes a row that holds its speeds, and adds it.
void add_row(Suite& suite, const FamilyContext& context, const Built& built, int threads, Row row,
             const HitAccuracy& accuracy) {
  row.update({{"suite", "scale"}, {"scene", context.name}, {"threads", threads}});
  add_fields(row, built.variant, context.made.geometry, built);
  row["rays_timed"] = context.made.rays.size();
  add_fields(row, accuracy);
  suite.add({row},
            {format("%-8s %9zu triangles %d threads %-18s build %8.4f s %7.1f bytes/triangle %6.2f Mrays/s  %s",
                    context.name.c_str(), row["triangles"].get<std::size_t>(), threads, built.variant.name().c_str(),
                    built.build_seconds.median, row["bytes"].get<double>() / row["triangles"].get<double>(),
                    row["mrays_per_second"]["median"].get<double>(), accuracy_text(row).c_str())});
}

}  // namespace

int scale(const ScaleOptions& options) {
  const std::vector<Variant> all = scale_variants(options);
  std::vector<std::string> families = options.families;
  if (families.empty()) families.assign(scale_family_names().begin(), scale_family_names().end());
  for (const std::string& family : families) (void)make_scale_family(family, 1, 1, 0);
  std::vector<std::size_t> sizes;
  for (std::size_t size = kFewest; size <= options.largest; size *= 10) sizes.push_back(size);

  Suite suite(options, "scale");
  const InterruptGuard guard;
  for (const std::size_t size : sizes) suite.expect(static_cast<double>(families.size() * size));
  for (const std::string& family : families) {
    for (const std::size_t size : sizes) {
      const std::string all_threads = family + " " + std::to_string(size);
      if (suite.measured(all_threads, static_cast<double>(size))) continue;
      const ScaleFamily made = make_scale_family(family, size, options.rays, options.seed);
      const HitChecker check_hits(made.geometry);
      const FamilyContext context{family, made};
      const RaySet set{RayKind::primary, made.rays};
      const auto stopped = [&] {
        suite.check();
        return false;
      };
      const int most_threads = size == sizes.back() ? hardware_threads() : 1;
      for (int threads = 1; threads <= most_threads; ++threads) {
        const std::string part = all_threads + format(", %d threads", threads);
        if (suite.measured(part)) continue;
        std::vector<Built> built;
        std::vector<const Accelerator*> accelerators;
        for (const Variant& v : all) {
          suite.check();
          built.push_back(build(v, made.geometry, threads));
          accelerators.push_back(built.back().accelerator.get());
        }
        const Repeats repeats{options.repeats};
        std::vector<Row> speeds;
        const std::size_t rays = made.rays.size();
        if (threads == 1) {
          const auto times = time_queries(accelerators, made.rays, Query::intersect, repeats, stopped);
          const auto batch_times =
              time_batch_queries(accelerators, BatchedRays(made.rays), Query::intersect, repeats, stopped);
          for (std::size_t i = 0; i < built.size(); ++i) {
            speeds.push_back({{"mrays_per_second", speeds_of(rays, times[i].cpu)},
                              {"mrays_per_second_wall", speeds_of(rays, times[i].wall)},
                              {"mrays_per_second_batch", speeds_of(rays, batch_times[i].cpu)}});
          }
        } else {
          for (const ThreadTimes& times : time_on_threads(accelerators, made.rays, threads, repeats, stopped)) {
            const Row speed = speeds_of(rays, times.several);
            speeds.push_back(
                {{"mrays_per_second", speed}, {"mrays_per_second_wall", speed}, {"speedup", speedup_of(times)}});
          }
        }
        const auto accuracies = check_hits(accelerators, set, options.checked, suite);
        for (std::size_t i = 0; i < built.size(); ++i) {
          add_row(suite, context, built[i], threads, speeds[i], accuracies[i]);
        }
        suite.end_part(part);
      }
      suite.advance(static_cast<double>(size));
      suite.end_part(all_threads);
    }
  }
  suite.finish();
  return 0;
}

}  // namespace raylab::bench
