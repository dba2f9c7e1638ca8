// How the trials of stability cases are judged.
#include <algorithm>

#include "raylab/core/parallel.hpp"
#include "raylab/measure/agreement.hpp"
#include "raylab/measure/batch_queries.hpp"
#include "stability_cases.hpp"

namespace raylab {

namespace {

/// Rays and what the exact accelerator answers.
struct Judged {
  Judged(Geometry g, std::vector<Ray> r) : geometry(std::move(g)), rays(std::move(r)) {}

  Geometry geometry;
  std::vector<Ray> rays;
  std::unique_ptr<Accelerator> exact = make_accelerator("exact", geometry);
  Answers answers = answers_of(*exact, rays, false);
};

/// Mean and squared standard error of a row of pixels.
struct RowEstimate {
  double mean = 0.0, variance = 0.0;
};
RowEstimate row_estimate(const Film& film, int y) {
  RowEstimate row;
  const double n = film.width();
  for (int x = 0; x < film.width(); ++x) {
    row.mean += static_cast<double>(luminance(film.mean(x, y))) / n;
    row.variance += film.variance_of_mean(x, y).g / (n * n);
  }
  return row;
}

/// The chance of a false alarm is 7 in a million, where means are normally distributed.
constexpr double kLimitZ = 4.5;

}  // namespace

std::vector<double> powers_of_ten(double first, double last, double step) {
  std::vector<double> values;
  for (double k = std::min(first, last); k < std::max(first, last) + 0.5 * step; k += step) {
    values.push_back(std::pow(10.0, k));
  }
  return values;
}

Answers answers_of(const Accelerator& accelerator, const std::vector<Ray>& rays, bool batch) {
  const RayArrays arrays(rays);
  HitArrays hits(rays.size());
  std::vector<std::uint8_t> occluded(rays.size());
  constexpr std::size_t kBlock = BatchedRays::kMost;
  parallel_for((rays.size() + kBlock - 1) / kBlock, [&](std::size_t block) {
    const std::size_t first = block * kBlock, count = std::min(kBlock, rays.size() - first);
    const HitBatch all = hits.batch();
    const HitBatch part{all.t + first, all.u + first, all.v + first, all.geometry + first, all.primitive + first};
    if (batch) {
      accelerator.intersect_batch(arrays.batch(first, count), part);
      accelerator.occluded_batch(arrays.batch(first, count), occluded.data() + first);
      return;
    }
    for (std::size_t i = 0; i < count; ++i) {
      part.set(i, accelerator.intersect(rays[first + i]));
      occluded[first + i] = accelerator.occluded(rays[first + i]);
    }
  });
  Answers answers{{}, std::move(occluded)};
  for (std::size_t i = 0; i < rays.size(); ++i) answers.hits.push_back(hits[i]);
  return answers;
}

Answers answers_of(const StabilityMethod& method, const Geometry& geometry, const std::vector<Ray>& rays) {
  return answers_of(*make_accelerator(method.accel, geometry, method.options()), rays, method.batch.value_or(false));
}

StabilityCount differing(const Answers& a, const Answers& b) {
  StabilityCount count{0, a.hits.size()};
  for (std::size_t i = 0; i < a.hits.size(); ++i) {
    const auto &x = a.hits[i], &y = b.hits[i];
    count.failures += x.has_value() != y.has_value() || (x && x->t != y->t);
  }
  return count;
}

std::vector<Ray> rays_in_faces(float size, std::size_t count, std::uint64_t seed) {
  UniformFloats uniform(seed);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i) {
    const int axis = static_cast<int>(i % 3);
    Ray ray{vec3(0.0f), vec3(0.0f)};
    ray.origin[axis] = ray.direction[axis] = 0.0f;
    if (i / 3 % 2 == 1) ray.origin[axis] = size;
    const int along = (axis + 1 + static_cast<int>(i / 6 % 2)) % 3, other = 3 - axis - along;
    const bool backward = i / 12 % 2 == 1;
    ray.origin[along] = (backward ? 3.0f : -2.0f) * size;
    ray.origin[other] = uniform(0.1f, 0.9f) * size;
    ray.direction[along] = backward ? -1.0f : 1.0f;
    rays.push_back(ray);
  }
  return rays;
}

StabilityTrial try_known(KnownRays known) {
  return [known = std::move(known)](const StabilityMethod& method) {
    const Answers found = answers_of(method, known.geometry, known.rays);
    StabilityCount count{0, known.rays.size()};
    for (std::size_t i = 0; i < known.rays.size(); ++i) {
      const ExpectedHit& e = known.expected[i];
      const auto& hit = found.hits[i];
      const bool good = hit.has_value() == e.hit && (found.occluded[i] != 0) == e.hit &&
                        (!hit || std::abs(static_cast<double>(hit->t) - e.t) <= e.t_error);
      count.failures += !good;
    }
    return count;
  };
}

StabilityTrial try_all_hit(Geometry geometry, std::vector<Ray> rays) {
  const std::size_t count = rays.size();
  return try_known({std::move(geometry), std::move(rays), std::vector<ExpectedHit>(count)});
}

StabilityTrial try_against_exact(Geometry geometry, std::vector<Ray> rays) {
  return
      [judged = std::make_shared<const Judged>(std::move(geometry), std::move(rays))](const StabilityMethod& method) {
        const auto tested = make_accelerator(method.accel, judged->geometry, method.options());
        const Answers found = answers_of(*tested, judged->rays, method.batch.value_or(false));
        StabilityCount count{0, judged->rays.size()};
        std::vector<Ray> questionable;
        for (std::size_t i = 0; i < judged->rays.size(); ++i) {
          const auto& hit = found.hits[i];
          const auto& exact = judged->answers.hits[i];
          if ((found.occluded[i] != 0) != hit.has_value()) {
            ++count.failures;
          } else if (hit.has_value() != exact.has_value() ||
                     (hit && std::abs(hit->t - exact->t) > 4.0f * kUnitRoundoff * exact->t)) {
            questionable.push_back(judged->rays[i]);
          }
        }
        if (questionable.empty()) return count;
        // What is more than a rounding of t apart is judged with care for outlines, which takes much longer.
        const FlushDenormals flush;
        std::optional<BatchAnswers> batch;
        if (method.batch.value_or(false)) batch.emplace(*tested, questionable);
        const AgreementReport report = compare_hits(batch ? static_cast<const Accelerator&>(*batch) : *tested,
                                                    *judged->exact, judged->geometry, questionable);
        count.failures += report.false_misses.count + report.false_hits.count + report.wrong_primitives.count;
        return count;
      };
}

std::vector<ExpectedHit> exact_presence(const Geometry& geometry, const std::vector<Ray>& rays) {
  const auto exact = make_accelerator("exact", geometry);
  std::vector<ExpectedHit> expected(rays.size());
  parallel_for(rays.size(), [&](std::size_t i) { expected[i].hit = exact->occluded(rays[i]); });
  return expected;
}

TriangleMesh make_mesh(std::vector<vec3> positions, std::vector<uvec3> triangles) {
  TriangleMesh mesh;
  mesh.positions = std::move(positions);
  mesh.triangles = std::move(triangles);
  mesh.pad_positions();
  return mesh;
}

RenderOptions stability_render_options(const StabilityMethod& method, std::size_t count, std::uint32_t samples,
                                       std::uint64_t seed, int max_depth) {
  const int side = std::max(2, static_cast<int>(std::sqrt(static_cast<double>(count) / samples)));
  RenderOptions options = made::render_options(side, side, samples, max_depth);
  options.seed = static_cast<std::uint32_t>(seed);
  options.integrator.kind = method.integrator.value_or(IntegratorKind::path);
  options.integrator.ray_offset = method.ray_offset.value_or(RayOffset::bounds);
  options.integrator.isa = method.isa;
  return options;
}

Film stability_render(const made::SeenScene& scene, const RenderOptions& given, const StabilityMethod& method) {
  RenderOptions options = given;
  options.camera = scene.camera;
  const auto accelerator = make_accelerator(method.accel, scene.geometry, method.options());
  RenderSession session(scene, *accelerator, options);
  session.run();
  return session.snapshot();
}

StabilityCount lit_pixels(const Film& film) {
  StabilityCount count{0, static_cast<std::size_t>(film.width()) * static_cast<std::size_t>(film.height())};
  for (int y = 0; y < film.height(); ++y) {
    for (int x = 0; x < film.width(); ++x) count.failures += film.mean(x, y) != Rgb(0.0f);
  }
  return count;
}

StabilityCount rows_off(const Film& film, double expected, double tolerance) {
  StabilityCount count{0, static_cast<std::size_t>(film.height())};
  for (int y = 0; y < film.height(); ++y) {
    const RowEstimate row = row_estimate(film, y);
    const double limit = kLimitZ * std::sqrt(row.variance) + tolerance * std::abs(expected);
    count.failures += !(std::abs(row.mean - expected) <= limit);
  }
  return count;
}

StabilityCount rows_off(const Film& film, const Film& other, double tolerance) {
  StabilityCount count{0, static_cast<std::size_t>(film.height())};
  for (int y = 0; y < film.height(); ++y) {
    const RowEstimate a = row_estimate(film, y), b = row_estimate(other, y);
    const double limit = kLimitZ * std::sqrt(a.variance + b.variance) + tolerance * std::abs(b.mean);
    count.failures += !(std::abs(a.mean - b.mean) <= limit);
  }
  return count;
}

}  // namespace raylab
