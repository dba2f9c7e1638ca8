#include "lights.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/frame.hpp"
#include "core/low_discrepancy.hpp"
#include "core/warp.hpp"
#include "light_lanes.hpp"
#include "raylab/scene/surface_point.hpp"

namespace raylab {

namespace {

/// Power over pi of an emitter of unit luminance.
double triangle_power(const Triangle& t) {
  // In double: the square of a product of two edges soon leaves the range of float.
  return glm::length(glm::cross(dvec3(t.p1 - t.p0), dvec3(t.p2 - t.p0)));  // two sides, each half of it
}
double sphere_power(const Sphere& s) {
  return 4.0 * static_cast<double>(kPi) * static_cast<double>(s.radius) * static_cast<double>(s.radius);
}

/// A sphere as seen from p. In double, since near its surface the distance to the centre cancels with the radius.
struct SeenSphere {
  dvec3 to_center;
  double d2, r2;  ///< squared distance of the centre, squared radius

  SeenSphere(const Sphere& sphere, const vec3& p)
      : to_center(dvec3(sphere.center) - dvec3(p)),
        d2(glm::dot(to_center, to_center)),
        r2(static_cast<double>(sphere.radius) * sphere.radius) {}

  bool from_inside() const { return d2 <= r2; }
  /// 1 - cos of the half angle under which it is seen from outside; accurate for small angles.
  double one_minus_cos_max() const { return r2 / d2 / (1.0 + std::sqrt((d2 - r2) / d2)); }
};

/// The least probability of an emitter in LightTable: numbers of 24 bits are good to 2^-14 of it.
constexpr double kLeastOfTable = 0x1p-10;

}  // namespace

Lights::Lights(const Scene& scene, const SceneNeeds& needs) : scene_(scene) {
  const Geometry& geometry = scene.geometry;
  std::vector<double> powers;
  if (needs.area_lights) {
    material_luminance_.resize(scene.materials.size(), 0.0f);
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
      const Material& m = scene.materials[i];
      if (m.kind == Material::Kind::diffuse_light) {
        material_luminance_[i] = mean_luminance(m.color, scene.textures);
      }
    }
    for (std::uint32_t m = 0; m < geometry.meshes.size(); ++m) {
      for (std::uint32_t i = 0; i < geometry.meshes[m].triangles.size(); ++i) add_triangle(m, i, powers);
    }
    for (std::uint32_t i = 0; i < geometry.spheres.size(); ++i) {
      const double power = material_luminance_[scene.sphere_materials[i]] * sphere_power(geometry.spheres[i]);
      if (power > 0.0 && is_valid_sphere(geometry.spheres[i])) {
        spheres_.push_back(i);
        powers.push_back(power);
      }
    }
  }
  if (needs.environment_sampling) {
    const Bounds bounds = geometry.bounds();
    const double radius = bounds.empty() ? 1.0 : 0.5 * glm::length(dvec3(bounds.diagonal()));
    const double power = 4.0 * static_cast<double>(kPi) * radius * radius * scene.environment.mean_luminance();
    if (power > 0.0) {
      environment_ = EnvironmentSampler(scene.environment);
      powers.push_back(power);
    }
  }

  double total = 0.0;
  for (const double p : powers) total += p;
  if (!(total > 0.0)) return;
  inv_total_power_ = 1.0 / total;
  fill_choice(powers);
  for (TriangleEmitter& t : triangles_) t.pdf_area = triangle_pdf_area(t.material);
  if (powers.size() > triangles_.size() + spheres_.size()) {
    environment_probability_ = static_cast<float>(powers.back() * inv_total_power_);
  }
  if (std::ranges::min(powers) * inv_total_power_ >= kLeastOfTable) fill_table();
}

void Lights::fill_choice(const std::vector<double>& powers) {
  __extension__ using Int = __int128;
  const auto share = [&](double power) {
    return std::max(Int{1}, static_cast<Int>(power * inv_total_power_ * 0x1p64));
  };
  Int left = Int{1} << 64;
  for (const double p : powers) left -= share(p);
  // The remainder of rounding, of either sign, goes to the strongest emitter.
  const auto strongest = static_cast<std::size_t>(std::ranges::max_element(powers) - powers.begin());
  Int sum = 0;
  first_.reserve(powers.size());
  for (std::size_t i = 0; i < powers.size(); ++i) {
    first_.push_back(static_cast<std::uint64_t>(sum));
    sum += share(powers[i]) + (i == strongest ? left : 0);
  }
}

void Lights::fill_table() {
  const auto varies = [](const TriangleEmitter& t) { return t.varies; };
  if (count() > LightTable::kMost || count() != triangles_.size() || std::ranges::any_of(triangles_, varies)) return;
  table_ = {};
  table_.count = static_cast<int>(count());
  for (std::size_t i = 0; i < count(); ++i) {
    const std::uint64_t rounded = (first_[i] + (1ull << 39)) >> 40;
    first_[i] = rounded << 40;
    table_.first[i] = static_cast<float>(rounded) * 0x1p-24f;
  }
  for (std::size_t i = 0; i < count(); ++i) {
    table_.scale[i] = 1.0f / ((i + 1 < count() ? table_.first[i + 1] : 1.0f) - table_.first[i]);
  }
  static_assert(offsetof(TriangleEmitter, radiance) == (LightTable::kColumns - 3) * sizeof(float));
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    const float* const row = &triangles_[i].p0.x;
    for (std::size_t k = 0; k < LightTable::kColumns; ++k) table_.columns[k][i] = row[k];
  }
}

void Lights::add_triangle(std::uint32_t mesh_id, std::uint32_t triangle, std::vector<double>& powers) {
  const std::uint32_t material = scene_.mesh_materials[mesh_id].of(triangle);
  const TriangleMesh& mesh = scene_.geometry.meshes[mesh_id];
  if (!(material_luminance_[material] > 0.0f) || !is_valid_triangle(mesh, triangle)) return;
  const Triangle corners = triangle_corners(mesh, triangle);
  const double power = material_luminance_[material] * triangle_power(corners);
  if (!(power > 0.0)) return;
  const SurfacePoint point = point_on_triangle(corners, 0.0f, 0.0f);
  // That of any point of the triangle is no larger than the largest of its corners'.
  const float offset = std::max(
      {point.offset, point_on_triangle(corners, 1.0f, 0.0f).offset, point_on_triangle(corners, 0.0f, 1.0f).offset});
  const Texture& texture = scene_.materials[material].color;
  triangles_.push_back({corners.p0, corners.p1 - corners.p0, corners.p2 - corners.p0, point.ng, offset, 0.0f, texture.a,
                        mesh_id, triangle, material, texture.kind != Texture::Kind::solid});
  powers.push_back(power);
}

Lights::Choice Lights::choose(std::uint64_t select) const {
  const auto i =
      static_cast<std::size_t>(std::upper_bound(first_.begin() + 1, first_.end(), select) - first_.begin() - 1);
  // As the lanes do.
  if (table_.count != 0) {
    const float number = bits_to_unit(static_cast<std::uint32_t>(select >> 32));
    return {i, left_of_choice(number, table_.first[i], table_.scale[i])};
  }
  const std::uint64_t width = (i + 1 < first_.size() ? first_[i + 1] : 0) - first_[i];  // modulo 2^64
  const double share = static_cast<double>(select - first_[i]) / (width == 0 ? 0x1p64 : static_cast<double>(width));
  return {i, std::min(static_cast<float>(share), kBelowOne)};
}

LightSample Lights::sample(const vec3& p, std::uint64_t select, float v) const {
  const Choice chosen = choose(select);
  return sample_emitter(chosen.emitter, p, {chosen.u, v});
}

LightSample Lights::sample_emitter(std::size_t chosen, const vec3& p, const vec2& u) const {
  if (chosen < triangles_.size()) return sample_mesh(triangles_[chosen], p, u);
  if (chosen == triangles_.size() + spheres_.size()) {
    const EnvironmentSampler::Sample s = environment_.sample(u);
    LightSample light;
    light.wi = s.direction;
    light.radiance = scene_.environment.radiance(s.direction);
    light.pdf = environment_probability_ * s.pdf;
    light.infinite = true;
    light.end = kInfinity;
    return light;
  }
  return sample_sphere(spheres_[chosen - triangles_.size()], p, u);
}

void Lights::sample(std::uint32_t lanes, const std::uint32_t* select_high, const std::uint32_t* select_low,
                    const float* v, const float* const (&p)[3], LightLanes& out) const {
  out.triangles = 0;
  out.infinite = 0;
  for (; lanes != 0; lanes &= lanes - 1) {
    const int i = __builtin_ctz(lanes);
    const Choice chosen = choose(static_cast<std::uint64_t>(select_high[i]) << 32 | select_low[i]);
    if (chosen.emitter < triangles_.size() && !triangles_[chosen.emitter].varies) {
      out.emitter[i] = static_cast<std::uint32_t>(chosen.emitter);
      out.u[i] = chosen.u;
      out.triangles |= 1u << i;
      continue;
    }
    const LightSample light = sample_emitter(chosen.emitter, {p[0][i], p[1][i], p[2][i]}, {chosen.u, v[i]});
    for (int k = 0; k < 3; ++k) {
      out.radiance[k][i] = (&light.radiance.x)[k];
      out.wi[k][i] = (&light.wi.x)[k];
      out.position[k][i] = (&light.position.x)[k];
      out.ng[k][i] = (&light.ng.x)[k];
    }
    out.end[i] = light.end;
    out.pdf[i] = light.pdf;
    if (light.infinite) out.infinite |= 1u << i;
  }
}

LightSample Lights::sample_mesh(const TriangleEmitter& emitter, const vec3& p, const vec2& u) const {
  const TriangleLightSample<float> s = sample_triangle<float>(
      {emitter.p0, emitter.e1, emitter.e2, emitter.ng, emitter.offset, emitter.pdf_area}, p, {u.x, u.y});
  LightSample light;
  if (!(s.pdf > 0.0f)) return light;
  light.wi = s.wi;
  light.position = s.position;
  light.ng = emitter.ng;
  light.end = s.end;
  light.pdf = s.pdf;
  light.radiance = emitter.radiance;
  if (emitter.varies) {
    const vec2 uv = interpolated_texcoords(scene_.geometry.meshes[emitter.mesh], emitter.triangle, s.b1, s.b2);
    light.radiance = texture_color(scene_.materials[emitter.material].color, scene_.textures, s.position, uv);
  }
  return light;
}

LightSample Lights::sample_sphere(std::uint32_t sphere_id, const vec3& p, const vec2& u) const {
  const Sphere& sphere = scene_.geometry.spheres[sphere_id];
  const SeenSphere seen(sphere, p);
  SurfacePoint point;
  if (seen.from_inside()) {
    // From inside every point is seen: uniform over the surface.
    const vec3 on_unit = uniform_sphere<float>(u.x, u.y);
    point = point_on_sphere(sphere, on_unit);
  } else {
    // Uniform in the cone of directions that meet the sphere; the angle alpha at its centre gives the point
    // (pbrt-v4 §6.2.4).
    const double d = std::sqrt(seen.d2);
    const double one_minus_cos = static_cast<double>(u.x) * seen.one_minus_cos_max();
    const double cos_theta = 1.0 - one_minus_cos;
    const double sin2_theta = std::max(0.0, one_minus_cos * (1.0 + cos_theta));
    const double sin_max = std::sqrt(seen.r2) / d;
    const double cos_alpha =
        sin2_theta / sin_max + cos_theta * std::sqrt(std::max(0.0, 1.0 - sin2_theta / (sin_max * sin_max)));
    const auto sin_alpha = static_cast<float>(std::sqrt(std::max(0.0, 1.0 - cos_alpha * cos_alpha)));
    float sine, cosine;
    sine_cosine_of_turn(u.y, sine, cosine);
    const Frame frame(vec3(-seen.to_center / d));
    const vec3 n = frame.to_world(vec3(sin_alpha * cosine, sin_alpha * sine, static_cast<float>(cos_alpha)));
    point = point_on_sphere(sphere, n);
  }
  LightSample light;
  light.wi = glm::normalize(point.position - p);
  const std::uint32_t material = scene_.sphere_materials[sphere_id];
  light.pdf = sphere_pdf(sphere_id, material, p, point.position, light.wi);
  if (!(light.pdf > 0.0f && light.pdf < kInfinity)) {
    light.pdf = 0.0f;
    return light;
  }
  light.position = point.position;
  light.ng = point.ng;
  const vec3 way = point.position - p;
  light.end = shadow_end<float>(way, point.ng, point.offset, 1.0f / std::abs(glm::dot(way, point.ng)));
  const Texture& texture = scene_.materials[material].color;
  const vec2 uv = texture.kind == Texture::Kind::image ? sphere_texcoords(point.ng) : vec2(0.0f);
  light.radiance = texture_color(texture, scene_.textures, point.position, uv, AddressMode::clamp);
  return light;
}

float Lights::triangle_pdf(std::uint32_t material, const vec3& p, const vec3& hit_position, const vec3& ng,
                           const vec3& wi) const {
  return raylab::triangle_pdf<float>(triangle_pdf_area(material), p, hit_position, ng, wi);
}

float Lights::triangle_pdf_area(std::uint32_t material) const {
  if (material_luminance_.empty()) return 0.0f;
  return static_cast<float>(2.0 * static_cast<double>(material_luminance_[material]) * inv_total_power_);
}

float Lights::sphere_direction_pdf(const Sphere& sphere, const vec3& p, const vec3& hit_position,
                                   const vec3& wi) const {
  const SeenSphere seen(sphere, p);
  if (!seen.from_inside()) return static_cast<float>(1.0 / (2.0 * static_cast<double>(kPi) * seen.one_minus_cos_max()));
  const vec3 to_light = hit_position - p;
  const vec3 n = (hit_position - sphere.center) / sphere.radius;
  const float cosine = std::abs(glm::dot(n, wi));
  return cosine > 0.0f ? glm::dot(to_light, to_light) / (cosine * 4.0f * kPi * static_cast<float>(seen.r2)) : 0.0f;
}

float Lights::sphere_pdf(std::uint32_t sphere, std::uint32_t material, const vec3& p, const vec3& hit_position,
                         const vec3& wi) const {
  if (material_luminance_.empty()) return 0.0f;
  const Sphere& s = scene_.geometry.spheres[sphere];
  const auto probability = static_cast<float>(material_luminance_[material] * sphere_power(s) * inv_total_power_);
  return probability * sphere_direction_pdf(s, p, hit_position, wi);
}

float Lights::environment_pdf(const vec3& wi) const {
  return environment_probability_ > 0.0f ? environment_probability_ * environment_.pdf(wi) : 0.0f;
}

std::size_t Lights::bytes() const {
  return triangles_.capacity() * sizeof(TriangleEmitter) + spheres_.capacity() * sizeof(std::uint32_t) +
         first_.capacity() * sizeof(std::uint64_t) + material_luminance_.capacity() * sizeof(float) +
         environment_.bytes();
}

}  // namespace raylab
