#pragma once
// What the files of stability cases have in common.
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "raylab/measure/made_scenes.hpp"
#include "raylab/measure/ray_sets.hpp"
#include "raylab/measure/shapes.hpp"
#include "raylab/measure/stability.hpp"

namespace raylab {

std::vector<StabilityCase> stability_triangle_cases();
std::vector<StabilityCase> stability_leak_cases();
std::vector<StabilityCase> stability_sphere_cases();
std::vector<StabilityCase> stability_traversal_cases();
std::vector<StabilityCase> stability_query_cases();
std::vector<StabilityCase> stability_offset_cases();
std::vector<StabilityCase> stability_light_cases();
std::vector<StabilityCase> stability_lamp_cases();
std::vector<StabilityCase> stability_sampling_cases();
std::vector<StabilityCase> stability_film_cases();

/// 10^first, 10^(first + step), ... up to 10^last; for first > last the same, ascending.
std::vector<double> powers_of_ten(double first, double last, double step = 1.0);

template <class... Numbers>
std::vector<double> values(Numbers... numbers) {
  return {static_cast<double>(numbers)...};
}

/// What an accelerator answers, ray by ray or in batches.
struct Answers {
  std::vector<std::optional<Hit>> hits;
  std::vector<std::uint8_t> occluded;
};
Answers answers_of(const Accelerator& accelerator, const std::vector<Ray>& rays, bool batch);
/// The same of the accelerator that the method names.
Answers answers_of(const StabilityMethod& method, const Geometry& geometry, const std::vector<Ray>& rays);

/// Rays to which the two have another t.
StabilityCount differing(const Answers& a, const Answers& b);

/// Rays in the planes of the faces of a cube at the origin, tangent to them, from outside across the face.
std::vector<Ray> rays_in_faces(float size, std::size_t count, std::uint64_t seed);

/// What a ray should find. An answer fails where presence differs, where a t is known and missed by more than
/// `t_error`, or where occlusion is not what the closest hit should be.
struct ExpectedHit {
  bool hit = true;
  double t = 0.0;
  double t_error = std::numeric_limits<double>::infinity();
};

/// Rays whose answers are known.
struct KnownRays {
  Geometry geometry;
  std::vector<Ray> rays;
  std::vector<ExpectedHit> expected;

  void add(const Ray& ray, const ExpectedHit& answer) {
    rays.push_back(ray);
    expected.push_back(answer);
  }
};
StabilityTrial try_known(KnownRays known);

/// The same where all of the rays must hit something.
StabilityTrial try_all_hit(Geometry geometry, std::vector<Ray> rays);

/// Rays whose answers are those of the exact accelerator. A failure is a false miss, a false hit, a wrong primitive, or
/// an occlusion that differs from the closest hit: see AgreementReport.
StabilityTrial try_against_exact(Geometry geometry, std::vector<Ray> rays);

/// The answers of the exact accelerator as presence alone.
std::vector<ExpectedHit> exact_presence(const Geometry& geometry, const std::vector<Ray>& rays);

TriangleMesh make_mesh(std::vector<vec3> positions, std::vector<uvec3> triangles);

/// Pictures of `count` paths, of so many a pixel. Rows of pixels are the trials of estimates.
RenderOptions stability_render_options(const StabilityMethod& method, std::size_t count, std::uint32_t samples,
                                       std::uint64_t seed, int max_depth = 7);
Film stability_render(const made::SeenScene& scene, const RenderOptions& options, const StabilityMethod& method);

/// Pixels that are not black: a path has found light where there is none.
StabilityCount lit_pixels(const Film& film);

/// Rows of pixels whose mean differs from what is expected by more than 4.5 standard errors and `tolerance` of it.
StabilityCount rows_off(const Film& film, double expected, double tolerance = 1e-4);
/// The same for two pictures with independent numbers.
StabilityCount rows_off(const Film& film, const Film& other, double tolerance = 1e-4);

}  // namespace raylab
