#include "hit_accuracy.hpp"

#include <algorithm>
#include <unordered_map>

#include "raylab/core/parallel.hpp"
#include "raylab/measure/batch_queries.hpp"
#include "raylab/measure/ray_key.hpp"

namespace raylab::bench {

namespace {

/// Keeps the exact accelerator's answers to some rays, since it is slow and many accelerators are compared with
/// it.
class CachedHits final : public Accelerator {
 public:
  CachedHits(const Accelerator& exact, std::span<const Ray> rays) : exact_(exact) {
    std::vector<std::optional<Hit>> hits(rays.size());
    parallel_for(rays.size(), [&](std::size_t i) { hits[i] = exact.intersect(rays[i]); });
    for (std::size_t i = 0; i < rays.size(); ++i) hits_.emplace(rays[i], hits[i]);
  }
  std::optional<Hit> intersect(const Ray& ray) const noexcept override {
    const auto found = hits_.find(ray);
    return found != hits_.end() ? found->second : exact_.intersect(ray);
  }
  bool occluded(const Ray& ray) const noexcept override {
    const auto found = hits_.find(ray);
    return found != hits_.end() ? found->second.has_value() : exact_.occluded(ray);
  }
  const BuildReport& build_report() const noexcept override { return exact_.build_report(); }

 private:
  const Accelerator& exact_;
  std::unordered_map<Ray, std::optional<Hit>, RayHash, RayEqual> hits_;
};

/// Describes the first error, with its floats exact, so that it can be made again.
std::string example(const HitErrors& e) {
  const std::pair<const char*, const Finding*> kinds[] = {{"leak", &e.leaks},
                                                          {"false miss", &e.false_misses},
                                                          {"false hit", &e.false_hits},
                                                          {"wrong primitive", &e.wrong_primitives}};
  for (const auto& [name, finding] : kinds) {
    if (finding->first) return std::string(name) + ": " + to_string(*finding->first);
  }
  return "";
}

std::size_t count_errors(const HitErrors& e) {
  return e.leaks.count + e.false_misses.count + e.false_hits.count + e.wrong_primitives.count;
}

/// Counts the rays with at least one error.
std::size_t count_wrong(const Geometry& geometry, const Accelerator& tested, const Accelerator& exact,
                        std::span<const Ray> rays, const HitErrors& errors) {
  // The other kinds exclude one another.
  const std::size_t others = count_errors(errors) - errors.leaks.count;
  if (errors.leaks.count == 0 || others == 0) return count_errors(errors);
  std::vector<char> wrong(rays.size());
  parallel_for(rays.size(), [&](std::size_t i) {
    wrong[i] = count_errors(judge_hits(geometry, tested, exact, rays.subspan(i, 1), Surface::closed)) > 0;
  });
  return static_cast<std::size_t>(std::count(wrong.begin(), wrong.end(), 1));
}

}  // namespace

HitChecker::HitChecker(const Geometry& geometry) : geometry_(geometry), exact_(make_accelerator("exact", geometry)) {}

std::vector<HitAccuracy> HitChecker::operator()(std::span<const Accelerator* const> accelerators, const RaySet& set,
                                                std::size_t count, Suite& suite) const {
  const std::vector<Ray> rays = evenly_spaced(set.rays, count);
  const CachedHits exact(*exact_, rays);
  // A scene's surfaces may be open elsewhere, so a leak is judged by the surface right around the ray.
  const auto check = [&](const Accelerator& accelerator) {
    const HitErrors errors = judge_hits(geometry_, accelerator, exact, rays, Surface::closed);
    suite.check();
    return HitAccuracy{errors, count_wrong(geometry_, accelerator, exact, rays, errors)};
  };
  std::vector<HitAccuracy> accuracies;
  for (const Accelerator* accelerator : accelerators) {
    HitAccuracy accuracy = check(*accelerator);
    const BatchAnswers in_batches(*accelerator, rays);
    accuracy.batch_differences = in_batches.differences();
    accuracy.wrong_batch = in_batches.differences() == 0 ? accuracy.wrong : check(in_batches).wrong;
    accuracies.push_back(accuracy);
  }
  return accuracies;
}

void add_fields(Row& row, const HitAccuracy& accuracy) {
  const HitErrors& e = accuracy.errors;
  row["rays_checked"] = e.rays_checked;
  row["leaks"] = e.leaks.count;
  row["false_misses"] = e.false_misses.count;
  row["false_hits"] = e.false_hits.count;
  row["wrong_primitives"] = e.wrong_primitives.count;
  row["wrong"] = accuracy.wrong;
  row["batch_differences"] = accuracy.batch_differences;
  row["wrong_batch"] = accuracy.wrong_batch;
  if (const std::string text = example(e); !text.empty()) row["example"] = text;
  row["t_error_ulp"] = {{"p50", e.t_error_ulp.p50}, {"p99", e.t_error_ulp.p99}, {"max", e.t_error_ulp.max}};
}

std::string accuracy_text(const Row& row) {
  const auto count = [&](const char* field) { return row[field].get<std::size_t>(); };
  return format("of %zu: %zu leaks, %zu false misses, %zu false hits, %zu wrong primitives; t off by %.3g ulp at most",
                count("rays_checked"), count("leaks"), count("false_misses"), count("false_hits"),
                count("wrong_primitives"), row["t_error_ulp"]["max"].get<double>());
}

}  // namespace raylab::bench
