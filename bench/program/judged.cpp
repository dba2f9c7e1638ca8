#include "judged.hpp"

#include <algorithm>
#include <unordered_map>

#include "raylab/core/parallel.hpp"
#include "raylab/measure/batch_queries.hpp"
#include "raylab/measure/ray_key.hpp"

namespace raylab::bench {

namespace {

/// Answers of the judge to some rays, found once: there are many accelerators to judge by them, and it is slow.
class Remembered final : public Accelerator {
 public:
  Remembered(const Accelerator& judge, std::span<const Ray> rays) : judge_(judge) {
    std::vector<std::optional<Hit>> hits(rays.size());
    parallel_for(rays.size(), [&](std::size_t i) { hits[i] = judge.intersect(rays[i]); });
    for (std::size_t i = 0; i < rays.size(); ++i) hits_.emplace(rays[i], hits[i]);
  }
  std::optional<Hit> intersect(const Ray& ray) const noexcept override {
    const auto found = hits_.find(ray);
    return found != hits_.end() ? found->second : judge_.intersect(ray);
  }
  bool occluded(const Ray& ray) const noexcept override {
    const auto found = hits_.find(ray);
    return found != hits_.end() ? found->second.has_value() : judge_.occluded(ray);
  }
  const BuildReport& build_report() const noexcept override { return judge_.build_report(); }

 private:
  const Accelerator& judge_;
  std::unordered_map<Ray, std::optional<Hit>, RayHash, RayEqual> hits_;
};

/// The first error of a judgement, with its floats exact, so that it can be made again.
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

/// Rays with at least one error.
std::size_t count_wrong(const Geometry& geometry, const Accelerator& judged, const Accelerator& exact,
                        std::span<const Ray> rays, const HitErrors& errors) {
  // The other kinds exclude one another.
  const std::size_t others = count_errors(errors) - errors.leaks.count;
  if (errors.leaks.count == 0 || others == 0) return count_errors(errors);
  std::vector<char> wrong(rays.size());
  parallel_for(rays.size(), [&](std::size_t i) {
    wrong[i] = count_errors(judge_hits(geometry, judged, exact, rays.subspan(i, 1), Surface::closed)) > 0;
  });
  return static_cast<std::size_t>(std::count(wrong.begin(), wrong.end(), 1));
}

}  // namespace

Judge::Judge(const Geometry& geometry) : geometry_(geometry), exact_(make_accelerator("exact", geometry)) {}

std::vector<Judgement> Judge::operator()(std::span<const Accelerator* const> accelerators, const RaySet& set,
                                         std::size_t count, Suite& suite) const {
  const std::vector<Ray> rays = evenly_spaced(set.rays, count);
  const Remembered exact(*exact_, rays);
  // A scene's surfaces may be open elsewhere: a leak is judged by the surface right around the ray.
  const auto judge = [&](const Accelerator& accelerator) {
    const HitErrors errors = judge_hits(geometry_, accelerator, exact, rays, Surface::closed);
    suite.check();
    return Judgement{errors, count_wrong(geometry_, accelerator, exact, rays, errors)};
  };
  std::vector<Judgement> judgements;
  for (const Accelerator* accelerator : accelerators) {
    Judgement judgement = judge(*accelerator);
    const BatchAnswers in_batches(*accelerator, rays);
    judgement.batch_differences = in_batches.differences();
    judgement.wrong_batch = in_batches.differences() == 0 ? judgement.wrong : judge(in_batches).wrong;
    judgements.push_back(judgement);
  }
  return judgements;
}

void add_fields(Row& row, const Judgement& j) {
  const HitErrors& e = j.errors;
  row["rays_checked"] = e.rays_checked;
  row["leaks"] = e.leaks.count;
  row["false_misses"] = e.false_misses.count;
  row["false_hits"] = e.false_hits.count;
  row["wrong_primitives"] = e.wrong_primitives.count;
  row["wrong"] = j.wrong;
  row["batch_differences"] = j.batch_differences;
  row["wrong_batch"] = j.wrong_batch;
  if (const std::string text = example(e); !text.empty()) row["example"] = text;
  row["t_error_ulp"] = {{"p50", e.t_error_ulp.p50}, {"p99", e.t_error_ulp.p99}, {"max", e.t_error_ulp.max}};
}

std::string judgement_text(const Row& row) {
  const auto count = [&](const char* field) { return row[field].get<std::size_t>(); };
  return format(
      "of %zu: %zu leaks, %zu false misses, %zu false hits, %zu wrong primitives; t off by %.3g ulp at most",
      count("rays_checked"), count("leaks"), count("false_misses"), count("false_hits"), count("wrong_primitives"),
      row["t_error_ulp"]["max"].get<double>());
}

}  // namespace raylab::bench
