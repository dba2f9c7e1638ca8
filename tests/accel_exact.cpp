// `exact` against its own test on every primitive, and the others against `exact`.
#include "catch.hpp"
#include "raylab/core/parallel.hpp"
#include "raylab/geometry/exact.hpp"
#include "raylab/measure/judge.hpp"
#include "raylab/measure/ray_sets.hpp"
#include "raylab/measure/shapes.hpp"

using namespace raylab;

namespace {

constexpr AcceleratorOptions kWatertight{Intersector::watertight, 0};
constexpr AcceleratorOptions kBook{Intersector::book, 0};

std::optional<Hit> hit_without_tree(const Geometry& geometry, const Ray& ray) {
  const ExactTest test(geometry, ray);
  std::optional<Crossing> closest;
  for (const PrimitiveId& id : valid_primitives(geometry)) {
    const auto crossing = test(id);
    if (crossing && (!closest || test.before(*crossing, *closest))) closest = crossing;
  }
  return closest ? std::optional(test.to_hit(*closest)) : std::nullopt;
}

/// Rays with components of 0, -0, denormals and almost that, some along planes of the box.
std::vector<Ray> awkward_rays(const Bounds& bounds, std::size_t count) {
  std::vector<Ray> rays = random_rays(bounds, count, 3);
  const float awkward[] = {0.0f, -0.0f, 1e-40f, -1e-45f, 1e-30f};
  for (std::size_t i = 0; i < rays.size(); ++i) {
    rays[i].direction[static_cast<int>(i) % 3] = awkward[i % 5];
    if (i % 4 == 0) rays[i].direction[static_cast<int>(i + 1) % 3] = awkward[(i / 4) % 5];
    if (i % 2 == 0) rays[i].origin = bounds.center();
    if (i % 8 == 1) rays[i].origin[static_cast<int>(i) % 3] = bounds.lower[static_cast<int>(i) % 3];
  }
  return rays;
}

struct Place {
  vec3 center;
  float radius;
};
const Place kPlaces[] = {{vec3(0.0f), 2.0f},  {{148376, 1234, -223423}, 2.0f},
                         {vec3(1e5f), 1.0f},  {vec3(0.0f), 1e-3f},
                         {vec3(0.0f), 1e-6f}, {vec3(0.0f), 1e10f}};

}  // namespace

TEST_CASE("exact gives the hits of its test on every primitive, bit for bit", "[agreement]") {
  const TriangleMesh ball = icosphere(vec3(0.1f), 0.6f, 2);
  const Geometry mixed{{triangle_soup(150, 1.0f, 0.4f, 1), ball, ball}, sphere_soup(60, 1.0f, 0.2f, 1)};
  const FlushDenormals flush;
  const auto exact = make_accelerator("exact", mixed);
  for (const auto& rays : {random_rays(mixed.bounds(), 1500, 1), axis_aligned_rays(mixed.bounds(), 500, 1),
                           awkward_rays(mixed.bounds(), 1000), rays_at_vertices(ball, vec3(0.1f), 0.2f, 500, 1),
                           rays_at_edges(ball, vec3(0.1f), 0.2f, 500, 1)}) {
    for (Ray ray : rays) {
      const auto expected = hit_without_tree(mixed, ray);
      REQUIRE(exact->intersect(ray) == expected);
      REQUIRE(exact->occluded(ray) == expected.has_value());
      if (!expected) continue;
      ray.t_max = expected->t;  // its exact t may lie on either side
      REQUIRE(exact->intersect(ray) == hit_without_tree(mixed, ray));
    }
  }
}

TEST_CASE("by exact, random and awkward rays find no error in list, bvh, embree-robust, at any scale and place",
          "[agreement]") {
  for (const Place& place : kPlaces) {
    const Geometry geometry{{icosphere(place.center, place.radius, 3)}, {}};
    const auto exact = make_accelerator("exact", geometry);
    const std::vector<Ray> random = random_rays(geometry.bounds(), 10'000, 5);
    std::vector<Ray> all = random;
    for (const Ray& ray : awkward_rays(geometry.bounds(), 2'000)) all.push_back(ray);
    for (const std::string name : {"list", "rtiow", "bvh", "embree-robust"}) {
      // Embree multiplies three lengths, and flushes the product.
      if (name == "embree-robust" && place.radius < 1e-5f) continue;
      // The book's boxes lose rays along their faces.
      const std::vector<Ray>& rays = name == "rtiow" ? random : all;
      const auto accelerator =
          make_accelerator(name, geometry, name == "embree-robust" ? AcceleratorOptions{} : kWatertight);
      const HitErrors errors = judge_hits(geometry, *accelerator, *exact, rays, Surface::closed);
      INFO(name << ", radius " << place.radius << " at " << place.center.x);
      CHECK(errors.rays_checked == rays.size());
      CHECK(errors.hits > 3'000);
      CHECK(errors.leaks.count == 0);
      CHECK(errors.false_misses.count == 0);
      CHECK(errors.false_hits.count == 0);
      CHECK(errors.wrong_primitives.count == 0);
    }
    if (place.radius < 1e-2f) continue;  // the book's padding makes boxes of that size one
    const auto rtiow = make_accelerator("rtiow", geometry, kWatertight);
    CHECK(judge_hits(geometry, *rtiow, *exact, all, Surface::closed).leaks.count > 0);
  }
}

TEST_CASE("by exact, no ray at vertices and edges of closed meshes leaks from list and bvh, while the book's do",
          "[stability]") {
  std::size_t leaks_of_book = 0;
  for (const Place& place : kPlaces) {
    const Geometry geometry{{icosphere(place.center, place.radius, 2)}, {}};
    const TriangleMesh& mesh = geometry.meshes[0];
    const float spread = 0.4f * place.radius;
    std::vector<Ray> rays = rays_at_vertices(mesh, place.center, spread, 4'000, 1);
    for (const Ray& ray : rays_at_edges(mesh, place.center, spread, 4'000, 2)) rays.push_back(ray);
    const auto exact = make_accelerator("exact", geometry);
    const auto judge = [&](const char* name, const AcceleratorOptions& options) {
      return judge_hits(geometry, *make_accelerator(name, geometry, options), *exact, rays, Surface::closed);
    };
    INFO("radius " << place.radius << " at " << place.center.x);
    for (const char* name : {"list", "bvh"}) {
      const HitErrors errors = judge(name, kWatertight);
      INFO(name);
      CHECK(errors.hits == 8'000);
      CHECK(errors.leaks.count + errors.false_misses.count + errors.wrong_primitives.count == 0);
    }
    leaks_of_book += judge("list", kBook).leaks.count;
  }
  CHECK(leaks_of_book > 4'000);
}
