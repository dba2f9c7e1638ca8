// Agreement reports for people, with the floats exact.
#include "raylab/core/text.hpp"
#include "raylab/measure/agreement.hpp"

namespace raylab {

namespace {

std::string to_string(const std::optional<Hit>& hit) {
  if (!hit) return "nothing";
  return format("t = %a (%.9g) on geometry %u, primitive %u", static_cast<double>(hit->t), static_cast<double>(hit->t),
                hit->geometry, hit->primitive);
}

std::string example(const char* kind, const Finding& finding) {
  if (!finding.first) return {};
  return format("\nfirst %s: ", kind) + to_string(*finding.first);
}

}  // namespace

std::string to_string(const Disagreement& d) {
  const auto f = [](float x) { return static_cast<double>(x); };
  const vec3& o = d.ray.origin;
  const vec3& v = d.ray.direction;
  return format("Ray{{%af, %af, %af}, {%af, %af, %af}, %af, %af}", f(o.x), f(o.y), f(o.z), f(v.x), f(v.y), f(v.z),
                f(d.ray.t_min), f(d.ray.t_max)) +
         ": tested hits " + to_string(d.tested) + "; judge hits " + to_string(d.judged);
}

std::string to_string(const AgreementReport& r) {
  return format(
             "%zu rays, %zu hits: %zu false misses, %zu false hits, %zu wrong primitives, %zu times occluded "
             "differs from intersect, %zu different in a batch, %zu undecided; t error p50 %.3g, p99 %.3g, max %.3g "
             "ulp",
             r.rays, r.hits, r.false_misses.count, r.false_hits.count, r.wrong_primitives.count, r.occlusion.count,
             r.batches.count, r.undecided, r.t_error_ulp.p50, r.t_error_ulp.p99, r.t_error_ulp.max) +
         example("false miss", r.false_misses) + example("false hit", r.false_hits) +
         example("wrong primitive", r.wrong_primitives) + example("difference of occluded", r.occlusion) +
         example("difference in a batch (tested: the batch, judge: the ray alone)", r.batches);
}

}  // namespace raylab
