#include "raylab/measure/path_rays.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "raylab/core/parallel.hpp"
#include "raylab/measure/ray_key.hpp"
#include "raylab/measure/ray_sets.hpp"

namespace raylab {

namespace {

/// Passes queries on to another accelerator and writes them down. For one thread.
class Recorder final : public Accelerator {
 public:
  explicit Recorder(const Accelerator& accelerator) : accelerator_(accelerator) {}

  std::optional<Hit> intersect(const Ray& ray) const noexcept override {
    closest.push_back(ray);
    return accelerator_.intersect(ray);
  }
  bool occluded(const Ray& ray) const noexcept override {
    any.push_back(ray);
    return accelerator_.occluded(ray);
  }
  const BuildReport& build_report() const noexcept override { return accelerator_.build_report(); }

  mutable std::vector<Ray> closest, any;

 private:
  const Accelerator& accelerator_;
};

struct Edge {
  vec3 a, b;
};

std::vector<Edge> shared_edges(const Geometry& geometry) {
  std::vector<Edge> edges;
  for (const TriangleMesh& mesh : geometry.meshes) {
    std::vector<std::uint64_t> keys;
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      if (!is_valid_triangle(mesh, i)) continue;
      for (int corner = 0; corner < 3; ++corner) {
        const auto [low, high] = std::minmax(mesh.triangles[i][corner], mesh.triangles[i][(corner + 1) % 3]);
        keys.push_back(static_cast<std::uint64_t>(low) << 32 | high);
      }
    }
    std::sort(keys.begin(), keys.end());
    for (std::size_t i = 1; i < keys.size(); ++i) {
      const bool second_of_its_kind = keys[i] == keys[i - 1] && (i < 2 || keys[i] != keys[i - 2]);
      if (second_of_its_kind) edges.push_back({mesh.positions[keys[i] >> 32], mesh.positions[keys[i] & 0xffffffffu]});
    }
  }
  return edges;
}

}  // namespace

std::string_view ray_kind_name(RayKind kind) {
  switch (kind) {
    case RayKind::primary:
      return "primary";
    case RayKind::diffuse:
      return "diffuse";
    case RayKind::shadow:
      return "shadow";
    case RayKind::edge:
      return "edge";
    case RayKind::vertex:
      break;
  }
  return "vertex";
}

std::vector<Ray> evenly_spaced(std::span<const Ray> rays, std::size_t count) {
  count = std::min(count, rays.size());
  std::vector<Ray> chosen;
  chosen.reserve(count);
  for (std::size_t i = 0; i < count; ++i) chosen.push_back(rays[i * rays.size() / count]);
  return chosen;
}

std::vector<RaySet> path_ray_sets(const Scene& scene, const CameraSettings& camera, const Accelerator& accelerator,
                                  const IntegratorSettings& settings, std::size_t count, std::uint32_t seed) {
  RenderOptions options;
  options.camera = camera;
  const double aspect = static_cast<double>(scene.render.width) / scene.render.height;
  options.width = std::max(1, static_cast<int>(std::ceil(std::sqrt(static_cast<double>(count) * aspect))));
  options.height = std::max(1, static_cast<int>(std::ceil(options.width / aspect)));
  options.samples_per_pixel = 1;
  options.seed = seed;
  const ThreadLimit one_thread(1);
  const auto record = [&](int max_depth) {
    Recorder recorder(accelerator);
    options.integrator = settings;
    options.integrator.max_depth = max_depth;
    RenderSession(scene, recorder, options).run();
    return recorder;
  };
  const auto from_paths = [&] {
    // Paths of one segment are camera rays alone: what else a longer path asks for continues it.
    std::vector<Ray> primary = record(1).closest;
    const std::unordered_set<Ray, RayHash, RayEqual> from_camera(primary.begin(), primary.end());
    Recorder all = record(settings.max_depth);
    std::erase_if(all.closest, [&](const Ray& ray) { return from_camera.count(ray) > 0; });
    return std::vector<RaySet>{{RayKind::primary, std::move(primary)},
                               {RayKind::diffuse, std::move(all.closest)},
                               {RayKind::shadow, std::move(all.any)}};
  };
  std::vector<RaySet> sets = from_paths();
  // Where few paths go on, more samples make up for it.
  constexpr std::size_t kMostSamples = 16;
  std::size_t samples = 1;
  for (const RaySet& set : sets) {
    if (!set.rays.empty()) samples = std::max(samples, (count + set.rays.size() - 1) / set.rays.size());
  }
  if (samples > 1) {
    options.samples_per_pixel = static_cast<std::uint32_t>(std::min(samples, kMostSamples));
    sets = from_paths();
  }
  for (RaySet& set : sets) set.rays = evenly_spaced(set.rays, count);
  return sets;
}

std::vector<RaySet> outline_ray_sets(const Geometry& geometry, const Accelerator& accelerator,
                                     std::span<const Ray> origins, std::size_t count, std::uint64_t seed) {
  std::vector<RaySet> sets{{RayKind::edge, {}}, {RayKind::vertex, {}}};
  const std::vector<Edge> edges = shared_edges(geometry);
  if (edges.empty() || origins.empty()) return sets;
  const FlushDenormals flush;
  UniformFloats uniform(seed);
  constexpr float kAlmostThere = 0.999f;
  constexpr std::size_t kTriesPerRay = 64;
  for (RaySet& set : sets) {
    for (std::size_t tries = 0; set.rays.size() < count && tries < count * kTriesPerRay; ++tries) {
      const Edge& edge = edges[uniform.below(edges.size())];
      const vec3 target = set.kind == RayKind::vertex ? edge.a : edge.a + uniform() * (edge.b - edge.a);
      const vec3 origin = origins[uniform.below(origins.size())].origin;
      const Ray ray{origin, target - origin};
      if (ray.direction == vec3(0.0f) || accelerator.occluded({origin, ray.direction, 0.0f, kAlmostThere})) continue;
      set.rays.push_back(ray);
    }
  }
  return sets;
}

}  // namespace raylab
