#include "raylab/measure/ray_sets.hpp"

namespace raylab {

namespace {

/// Rays from around `inside` to the points that `target()` gives.
template <class Target>
std::vector<Ray> rays_from_inside(const vec3& inside, float spread, std::size_t count, UniformFloats& uniform,
                                  const Target& target) {
  std::vector<Ray> rays;
  rays.reserve(count);
  while (rays.size() < count) {
    const vec3 origin = uniform.in_box(inside - spread, inside + spread);
    const vec3 direction = target() - origin;
    if (direction != vec3(0.0f)) rays.push_back({origin, direction});
  }
  return rays;
}

}  // namespace

RayArrays::RayArrays(std::span<const Ray> rays) {
  for (auto& component : components_) component.reserve(rays.size());
  for (const Ray& ray : rays) {
    for (int axis = 0; axis < 3; ++axis) {
      components_[axis].push_back(ray.origin[axis]);
      components_[3 + axis].push_back(ray.direction[axis]);
    }
    components_[6].push_back(ray.t_min);
    components_[7].push_back(ray.t_max);
  }
}

RayBatch RayArrays::batch(std::size_t first, std::size_t count) const {
  const auto at = [&](int k) { return components_[k].data() + first; };
  return {count, {at(0), at(1), at(2)}, {at(3), at(4), at(5)}, at(6), at(7)};
}

std::vector<Ray> random_rays(const Bounds& bounds, std::size_t count, std::uint64_t seed) {
  UniformFloats uniform(seed);
  const vec3 margin = bounds.diagonal();
  std::vector<Ray> rays;
  rays.reserve(count);
  while (rays.size() < count) {
    const vec3 origin = uniform.in_box(bounds.lower - margin, bounds.upper + margin);
    const float scale = uniform(0.5f, 2.0f);  // first: compilers differ in which side of a product is drawn first
    const vec3 direction = (uniform.in_box(bounds.lower, bounds.upper) - origin) * scale;
    if (direction != vec3(0.0f)) rays.push_back({origin, direction});
  }
  return rays;
}

std::vector<Ray> axis_aligned_rays(const Bounds& bounds, std::size_t count, std::uint64_t seed) {
  UniformFloats uniform(seed);
  const vec3 size = bounds.diagonal();
  std::vector<Ray> rays;
  rays.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const int axis = static_cast<int>(uniform.below(3));
    const bool backward = uniform.below(2) == 1;
    vec3 origin = uniform.in_box(bounds.lower, bounds.upper);
    origin[axis] = backward ? bounds.upper[axis] + size[axis] : bounds.lower[axis] - size[axis];
    vec3 direction;
    for (int k = 0; k < 3; ++k) direction[k] = uniform.below(2) == 1 ? -0.0f : 0.0f;
    direction[axis] = backward ? -1.0f : 1.0f;
    rays.push_back({origin, direction});
  }
  return rays;
}

std::vector<Ray> faulty_rays() {
  const Ray good{{0.3f, 0.4f, -2.0f}, {0.0f, 0.0f, 1.0f}};
  std::vector<Ray> rays;
  for (const float bad : {std::nanf(""), kInfinity, -kInfinity}) {
    for (int axis = 0; axis < 3; ++axis) {
      rays.push_back(good);
      rays.back().origin[axis] = bad;
      rays.push_back(good);
      rays.back().direction[axis] = bad;
    }
  }
  for (const float zero : {0.0f, -0.0f}) rays.push_back({good.origin, vec3(zero)});
  rays.push_back({good.origin, good.direction, std::nanf(""), kInfinity});
  rays.push_back({good.origin, good.direction, 0.0f, std::nanf("")});
  rays.push_back({good.origin, good.direction, kInfinity, kInfinity});
  return rays;
}

std::vector<Ray> rays_at_vertices(const TriangleMesh& mesh, const vec3& inside, float spread, std::size_t count,
                                  std::uint64_t seed) {
  UniformFloats uniform(seed);
  return rays_from_inside(inside, spread, count, uniform, [&] {
    const uvec3& corners = mesh.triangles[uniform.below(mesh.triangles.size())];
    return mesh.positions[corners[static_cast<int>(uniform.below(3))]];
  });
}

std::vector<Ray> rays_at_edges(const TriangleMesh& mesh, const vec3& inside, float spread, std::size_t count,
                               std::uint64_t seed) {
  UniformFloats uniform(seed);
  return rays_from_inside(inside, spread, count, uniform, [&] {
    const uvec3& corners = mesh.triangles[uniform.below(mesh.triangles.size())];
    const int edge = static_cast<int>(uniform.below(3));
    const vec3 a = mesh.positions[corners[edge]];
    const vec3 b = mesh.positions[corners[(edge + 1) % 3]];
    return a + uniform() * (b - a);
  });
}

}  // namespace raylab
