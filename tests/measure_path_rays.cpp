#include <set>

#include "catch.hpp"
#include "raylab/core/parallel.hpp"
#include "raylab/io/scene_file.hpp"
#include "raylab/measure/path_rays.hpp"
#include "raylab/measure/ray_timing.hpp"
#include "raylab/measure/shapes.hpp"

using namespace raylab;

namespace {

std::vector<RaySet> cornell_rays(std::size_t count, int max_depth) {
  static const LoadedScene loaded = load_scene(RAYLAB_SOURCE_DIR "/scenes/cornell.toml");
  const auto accelerator = make_accelerator("list", loaded.scene.geometry);
  IntegratorSettings settings;
  settings.max_depth = max_depth;
  settings.strategies.sphere = false;  // or some would go to spheres
  return path_ray_sets(loaded.scene, loaded.camera, *accelerator, settings, count, 1);
}

}  // namespace

TEST_CASE("path rays are those of the camera, of continued paths and to the light", "[unit][measure]") {
  const auto sets = cornell_rays(1000, 7);
  REQUIRE(sets.size() == 3);
  for (const RaySet& set : sets) CHECK(set.rays.size() == 1000);
  for (const Ray& ray : sets[0].rays) {
    CHECK(ray.origin == vec3(278.0f, 278.0f, -800.0f));
    CHECK(ray.t_max == kInfinity);
  }
  for (const Ray& ray : sets[1].rays) CHECK(ray.origin.z > -1.0f);
  // Up to a point of the lamp, and no farther.
  for (const Ray& ray : sets[2].rays) {
    CHECK(ray.at(1.0f).y == Approx(554.0f).margin(0.01));
    CHECK(ray.t_max <= 1.0f);
  }
}

TEST_CASE("paths of one segment send camera rays alone", "[unit][measure]") {
  const auto sets = cornell_rays(500, 1);
  CHECK(sets[0].rays.size() == 500);
  CHECK(sets[1].rays.empty());
  CHECK(sets[2].rays.empty());
}

TEST_CASE("rays are chosen evenly spaced, first one included", "[unit][measure]") {
  std::vector<Ray> rays;
  for (int i = 0; i < 10; ++i) rays.push_back({vec3(static_cast<float>(i)), vec3(1.0f)});
  const auto chosen = evenly_spaced(rays, 4);
  REQUIRE(chosen.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) CHECK(chosen[i].origin.x == static_cast<float>(i * 10 / 4));
  CHECK(evenly_spaced(rays, 99).size() == 10);
}

TEST_CASE("outline rays go to points of shared edges and to vertices that nothing hides", "[unit][measure]") {
  Geometry geometry;
  geometry.meshes.push_back(icosphere(vec3(0.0f), 2.0f, 2));
  const auto accelerator = make_accelerator("list", geometry);
  const std::vector<Ray> origins{{vec3(0.5f, 0.0f, 0.0f), vec3(1.0f)}, {vec3(0.0f, -0.5f, 0.0f), vec3(1.0f)}};
  const auto sets = outline_ray_sets(geometry, *accelerator, origins, 200, 1);
  REQUIRE(sets.size() == 2);
  CHECK(sets[0].kind == RayKind::edge);
  CHECK(sets[1].kind == RayKind::vertex);
  std::set<float> edge_lengths;
  for (const RaySet& set : sets) {
    REQUIRE(set.rays.size() == 200);
    for (const Ray& ray : set.rays) {
      CHECK((ray.origin == origins[0].origin || ray.origin == origins[1].origin));
      const float radius = glm::length(ray.at(1.0f));
      // Vertices lie on the sphere; an edge of 20 * 4² triangles is at most 2% inside.
      CHECK(radius == Approx(2.0f).epsilon(set.kind == RayKind::vertex ? 1e-6 : 0.02));
    }
  }
}

TEST_CASE("a mesh that shares no edges, and spheres, have no outline rays", "[unit][measure]") {
  Geometry geometry;
  geometry.meshes.push_back(triangle_soup(50, 1.0f, 0.1f, 1));
  geometry.spheres = sphere_soup(5, 1.0f, 0.1f, 1);
  const auto accelerator = make_accelerator("list", geometry);
  const std::vector<Ray> origins{{vec3(0.0f), vec3(1.0f)}};
  for (const RaySet& set : outline_ray_sets(geometry, *accelerator, origins, 10, 1)) CHECK(set.rays.empty());
}

TEST_CASE("queries are timed interleaved after a warm-up", "[unit][measure]") {
  /// Writes down who was asked.
  struct Noted final : Accelerator {
    Noted(std::string& log, char name) : log_(log), name_(name) {}
    std::optional<Hit> intersect(const Ray&) const noexcept override { return log_ += name_, std::nullopt; }
    bool occluded(const Ray&) const noexcept override { return log_ += static_cast<char>(name_ + 1), false; }
    const BuildReport& build_report() const noexcept override { return report_; }
    std::string& log_;
    char name_;
    BuildReport report_;
  };
  std::string log;
  const Noted a(log, 'a'), m(log, 'm');
  const Accelerator* both[] = {&a, &m};
  const std::vector<Ray> rays(2);
  const auto times = time_queries(both, rays, Query::intersect, {2, 0.0});
  CHECK(log == "aammaammaamm");
  REQUIRE(times.size() == 2);
  CHECK(times[0].cpu.size() == 2);
  CHECK(times[1].wall.size() == 2);
  log.clear();
  (void)time_queries(both, rays, Query::occluded, {1, 0.0});
  CHECK(log == "bbnnbbnn");
  log.clear();
  CHECK(time_queries(both, rays, Query::intersect, {1, 1e9})[1].cpu.size() == 200);  // the most
}

TEST_CASE("turns are spread evenly, however many each takes", "[unit]") {
  using Order = std::vector<std::size_t>;
  CHECK(interleaved_order(std::vector<int>{2, 2}) == Order{0, 1, 0, 1});
  CHECK(interleaved_order(std::vector<int>{1, 6, 2, 3}) == Order{1, 1, 3, 1, 2, 1, 3, 1, 0, 1, 2, 3});
  CHECK(interleaved_order({}).empty());
}
