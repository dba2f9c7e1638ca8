#include "sphere_chains.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "raylab/geometry/geometry.hpp"
#include "sphere_chain_lanes.hpp"

namespace raylab {

namespace {

/// Of light from all sides.
float mean_reflectance(float index) {
  constexpr int kSteps = 64;
  float sum = 0.0f;
  for (int i = 0; i < kSteps; ++i) {
    float cos_t;
    sum += fresnel_dielectric<float>(std::sqrt((static_cast<float>(i) + 0.5f) / kSteps), index, cos_t);
  }
  return sum / kSteps;
}

/// Squared distance of a point from a triangle (Ericson 2005, "Real-Time Collision Detection", §5.1.5).
double distance2(const dvec3& p, const Triangle& triangle) {
  const dvec3 corners[3] = {dvec3(triangle.p0), dvec3(triangle.p1), dvec3(triangle.p2)};
  const dvec3 n = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
  double least = std::numeric_limits<double>::infinity();
  bool inside = glm::dot(n, n) > 0.0;
  for (int k = 0; k < 3; ++k) {
    const dvec3& from = corners[k];
    const dvec3 edge = corners[(k + 1) % 3] - from, way = p - from;
    const double length2 = glm::dot(edge, edge);
    const double t = length2 > 0.0 ? std::clamp(glm::dot(way, edge) / length2, 0.0, 1.0) : 0.0;
    const dvec3 rest = way - t * edge;
    least = std::min(least, glm::dot(rest, rest));
    inside = inside && glm::dot(glm::cross(edge, way), n) >= 0.0;
  }
  if (!inside) return least;
  const double height = glm::dot(p - corners[0], n);
  return height * height / glm::dot(n, n);
}

/// Whether a sphere has nothing of the scene inside. What touches it may.
bool is_clear(const Geometry& geometry, std::uint32_t id) {
  const Sphere& sphere = geometry.spheres[id];
  const dvec3 center(sphere.center);
  const double radius = (1.0 - 1e-5) * sphere.radius;
  for (std::uint32_t i = 0; i < geometry.spheres.size(); ++i) {
    const Sphere& other = geometry.spheres[i];
    const double distance = glm::length(dvec3(other.center) - center);
    // Apart, or the other around this one.
    if (i != id && is_valid_sphere(other) && distance < other.radius + radius && other.radius < distance + radius)
      return false;
  }
  const vec3 lower(center - radius), upper(center + radius);  // rounded by less than what is taken from the radius
  for (const TriangleMesh& mesh : geometry.meshes) {
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      const Triangle t = triangle_corners(mesh, i);
      const vec3 least = glm::min(glm::min(t.p0, t.p1), t.p2), most = glm::max(glm::max(t.p0, t.p1), t.p2);
      if (glm::any(glm::greaterThan(least, upper)) || glm::any(glm::lessThan(most, lower))) continue;
      if (is_valid_triangle(mesh, i) && distance2(center, t) < radius * radius) return false;
    }
  }
  return true;
}

}  // namespace

SphereChains::SphereChains(const Scene& scene) {
  struct Row {
    std::uint32_t sphere;
    int crossings;
    float weight;
  };
  std::vector<float> reflectance(scene.materials.size(), 0.0f);
  for (std::size_t i = 0; i < reflectance.size(); ++i) {
    const Material& m = scene.materials[i];
    if (m.kind == Material::Kind::dielectric && m.index >= 1.0f) reflectance[i] = mean_reflectance(m.index);
  }
  std::vector<Row> rows;
  for (std::uint32_t i = 0; i < scene.geometry.spheres.size(); ++i) {
    const Sphere& sphere = scene.geometry.spheres[i];
    const Material& m = scene.materials[scene.sphere_materials[i]];
    if (!is_valid_sphere(sphere)) continue;
    const float area = sphere.radius * sphere.radius;
    if (m.kind == Material::Kind::metal && m.fuzz == 0.0f && m.color.kind == Texture::Kind::solid) {
      rows.push_back({i, 0, area * luminance(m.color.a)});
    } else if (m.kind == Material::Kind::dielectric && m.index >= 1.0f) {
      const float reflected = reflectance[scene.sphere_materials[i]];
      const float through = area * (1.0f - reflected) * (1.0f - reflected);
      rows.push_back({i, 0, area * reflected});
      rows.push_back({i, 1, through});
      if (m.index >= kTwiceIndex) rows.push_back({i, 2, through * reflected});
    }
  }
  std::ranges::stable_sort(rows, std::ranges::greater{}, &Row::weight);
  // As many spheres are looked into as there is room for rows, so that a heap of marbles costs no more.
  std::vector<std::pair<std::uint32_t, bool>> looked_into;
  const auto may_cross = [&](std::uint32_t sphere) {
    const auto known = std::ranges::find(looked_into, sphere, &std::pair<std::uint32_t, bool>::first);
    if (known != looked_into.end()) return known->second;
    if (looked_into.size() == SphereChainTable::kMost) return false;
    return looked_into.emplace_back(sphere, is_clear(scene.geometry, sphere)).second;
  };
  for (const Row& row : rows) {
    if (table_.count == SphereChainTable::kMost || !(row.weight > 0.0f)) break;
    if (row.crossings > 0 && !may_cross(row.sphere)) continue;
    const Sphere& sphere = scene.geometry.spheres[row.sphere];
    const Material& m = scene.materials[scene.sphere_materials[row.sphere]];
    const bool metal = m.kind == Material::Kind::metal;
    const Rgb color = metal ? m.color.a : Rgb(1.0f);
    const float numbers[SphereChainTable::kColumns] = {sphere.center.x,
                                                       sphere.center.y,
                                                       sphere.center.z,
                                                       sphere.radius,
                                                       metal ? 1.0f : m.index,
                                                       static_cast<float>(row.crossings),
                                                       row.weight,
                                                       color.x,
                                                       color.y,
                                                       color.z};
    for (int k = 0; k < SphereChainTable::kColumns; ++k) table_.columns[k][table_.count] = numbers[k];
    spheres_.push_back(row.sphere);
    ++table_.count;
  }
}

std::optional<std::uint32_t> SphereChains::row_of(std::uint32_t sphere, std::uint32_t crossings) const {
  for (std::uint32_t row = 0; row < spheres_.size(); ++row) {
    if (spheres_[row] == sphere && table_.columns[5][row] == static_cast<float>(crossings)) return row;
  }
  return {};
}

bool SphereChains::follow(std::uint32_t sphere, bool reflected, ChainId& chain) const {
  if (!is_over_sphere(chain)) {
    const auto first = std::ranges::find(spheres_, sphere);
    if (chain != 0 || first == spheres_.end()) return false;
    const auto first_row = static_cast<std::uint32_t>(first - spheres_.begin());
    chain = reflected ? id(first_row, 0, false) : id(first_row, 1, true);
    return true;
  }
  if (sphere_of(chain) != sphere || !is_inside(chain)) return false;
  if (reflected && crossings_of(chain) == 2) return false;
  chain = reflected ? id(first_row_of(chain), crossings_of(chain) + 1, true)
                    : id(first_row_of(chain), crossings_of(chain), false);
  return true;
}

SphereChains::Share SphereChains::share(ChainId chain, const vec3& p, const vec3& origin, const vec3& direction,
                                        const vec3& light, const vec3& ng, bool infinite) const {
  const std::optional<std::uint32_t> found = row_of(sphere_of(chain), crossings_of(chain));
  if (!found || is_inside(chain)) return {p, 0.0f};
  const std::uint32_t row = *found;
  const SphereChain<float> over = sphere_chain<float>([&](int k) { return table_.columns[k][row]; });
  const ChainEnds<float> ends = chain_ends<float>(over, p, light, infinite);
  if (!ends.outside) return {over.center, 0.0f};
  // The angle of incidence is that at which the last ray leaves.
  const Vec3<float> from_center = Vec3<float>(origin) - over.center;
  const float along = std::max(dot<float>(from_center, direction), 0.0f);
  const Vec3<float> across = cross<float>(from_center, direction);
  const float beside = std::sqrt(dot<float>(across, across));
  const float scale = 1.0f / std::sqrt(along * along + beside * beside);
  const float cosine = along * scale;
  const ChainTurn<float> turn = chain_turn<float>(ends, beside * scale, cosine);
  float spread = chain_spread<float>(ends, turn, cosine) / chain_roots<float>(ends);
  if (!infinite) spread *= std::abs(dot<float>(ends.light, ng) / dot<float>(direction, ng));
  const float reflectance = chain_reflectance<float>(ends, over.index == 1.0f, over.index, cosine);
  const auto column = [&](int k, int of_row) { return table_.columns[k][of_row]; };
  const float factor = chain_choice<float>(table_.count, column, Vec3<float>(p), row) * spread / reflectance;
  return {over.center, factor < kInfinity ? factor : 0.0f};
}

}  // namespace raylab
