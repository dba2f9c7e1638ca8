#include "lights.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/low_discrepancy.hpp"
#include "core/warp.hpp"
#include "light_choice.hpp"
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

TreeEmitter tree_emitter(const TriangleMesh& mesh, std::uint32_t id, std::uint32_t triangle) {
  const Triangle t = triangle_corners(mesh, triangle);
  const vec3 center = (t.p0 + t.p1 + t.p2) / 3.0f;
  float radius = 0.0f;
  for (const vec3& p : {t.p0, t.p1, t.p2}) radius = std::max(radius, glm::length(p - center));
  return {center, radius, 0.0f, point_on_triangle(t, 0.0f, 0.0f).ng, id, triangle};
}

void put(const LightSample& light, int i, LightLanes& out) {
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

/// A point as it was sampled; its radiance is still to be found.
LightSample seen_point(const EmitterSample<float>& s) {
  LightSample light;
  light.wi = s.wi;
  light.position = s.position;
  light.ng = s.ng;
  light.end = s.end;
  light.pdf = s.pdf;
  return light;
}

/// The least probability of an emitter in LightTable: numbers of 24 bits are good to 2^-14 of it.
constexpr double kLeastOfTable = 0x1p-10;

}  // namespace

Lights::Lights(const Scene& scene, const SceneNeeds& needs) : scene_(scene) {
  const Geometry& geometry = scene.geometry;
  std::vector<double> powers;
  std::vector<TreeEmitter> emitters;
  if (needs.area_lights) {
    material_luminance_.resize(scene.materials.size(), 0.0f);
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
      const Material& m = scene.materials[i];
      if (m.kind == Material::Kind::diffuse_light) {
        material_luminance_[i] = mean_luminance(m.color, scene.textures);
      }
    }
    for (std::uint32_t m = 0; m < geometry.meshes.size(); ++m) {
      const TriangleMesh& mesh = geometry.meshes[m];
      for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        const float luminance = material_luminance_[scene.mesh_materials[m].of(i)];
        if (!(luminance > 0.0f) || !is_valid_triangle(mesh, i)) continue;
        const double power = luminance * triangle_power(triangle_corners(mesh, i));
        if (!(power > 0.0)) continue;
        emitters.push_back(tree_emitter(mesh, m, i));
        powers.push_back(power);
      }
    }
    for (std::uint32_t i = 0; i < geometry.spheres.size(); ++i) {
      const Sphere& sphere = geometry.spheres[i];
      const double power = material_luminance_[scene.sphere_materials[i]] * sphere_power(sphere);
      if (!(power > 0.0) || !is_valid_sphere(sphere)) continue;
      emitters.push_back({sphere.center, sphere.radius, 0.0f, vec3(0.0f), geometry.sphere_geometry(), i});
      powers.push_back(power);
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
  const bool has_environment = powers.size() > emitters.size();
  if (has_environment) environment_probability_ = static_cast<float>(powers.back() * inv_total_power_);
  if (emitters.size() > kFew) {
    fill_tree(std::move(emitters), powers);
    return;
  }
  for (const TreeEmitter& e : emitters) {
    if (geometry.is_sphere(e.geometry)) {
      spheres_.push_back(e.primitive);
    } else {
      add_triangle(e);
    }
  }
  fill_choice(powers);
  for (TriangleEmitter& t : triangles_) t.pdf_area = triangle_pdf_area(t.material);
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

void Lights::add_triangle(const TreeEmitter& e) {
  const std::uint32_t material = scene_.mesh_materials[e.geometry].of(e.primitive);
  const Triangle corners = triangle_corners(scene_.geometry.meshes[e.geometry], e.primitive);
  const SurfacePoint point = point_on_triangle(corners, 0.0f, 0.0f);
  // That of any point of the triangle is no larger than the largest of its corners'.
  const float offset = std::max(
      {point.offset, point_on_triangle(corners, 1.0f, 0.0f).offset, point_on_triangle(corners, 0.0f, 1.0f).offset});
  const Texture& texture = scene_.materials[material].color;
  triangles_.push_back({corners.p0, corners.p1 - corners.p0, corners.p2 - corners.p0, point.ng, offset, 0.0f, texture.a,
                        e.geometry, e.primitive, material, texture.kind != Texture::Kind::solid});
}

void Lights::fill_tree(std::vector<TreeEmitter> emitters, const std::vector<double>& powers) {
  for (std::size_t i = 0; i < emitters.size(); ++i) {
    // Over pi the power of a triangle is 2, and that of a sphere 4 times its largest intensity. None is so weak that
    // its strength vanishes.
    const double strength = powers[i] * inv_total_power_ / (emitters[i].ng == vec3(0.0f) ? 4.0 : 2.0);
    emitters[i].strength = std::max(static_cast<float>(strength), 1e-20f);
  }
  const bool has_environment = powers.size() > emitters.size();
  const double end = has_environment ? (1.0 - powers.back() * inv_total_power_) * 0x1p64 : 0.0;
  tree_ = LightTree(std::move(emitters));
  view_ = tree_.view(static_cast<std::uint64_t>(end));
  if (has_environment) environment_probability_ = 1.0f - view_.probability;
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

LightSample Lights::sample(const vec3& p, std::uint64_t select, float v, const vec3& receiver_ng) const {
  if (!tree_.empty()) {
    const LightChoice choice = choose_light<float>(view_, {p, receiver_ng}, select);
    return sample_tree_emitter(choice.at, static_cast<float>(choice.probability), p, {choice.u(), v});
  }
  const Choice chosen = choose(select);
  return sample_emitter(chosen.emitter, p, {chosen.u, v});
}

LightSample Lights::sample_emitter(std::size_t chosen, const vec3& p, const vec2& u) const {
  if (chosen < triangles_.size()) return sample_mesh(triangles_[chosen], p, u);
  if (chosen == triangles_.size() + spheres_.size()) return sample_environment(u);
  const std::uint32_t sphere = spheres_[chosen - triangles_.size()];
  return sample_sphere(sphere, sphere_probability(sphere, scene_.sphere_materials[sphere]), p, u);
}

LightSample Lights::sample_environment(const vec2& u) const {
  const EnvironmentSampler::Sample s = environment_.sample(u);
  LightSample light;
  light.wi = s.direction;
  light.radiance = scene_.environment.radiance(s.direction);
  light.pdf = environment_probability_ * s.pdf;
  light.infinite = true;
  light.end = kInfinity;
  return light;
}

LightSample Lights::sample_tree_emitter(std::uint32_t chosen, float probability, const vec3& p, const vec2& u) const {
  if (!(probability > 0.0f)) return {};
  if (chosen == LightChoice::kNotOfTree) return sample_environment(u);
  const auto [geometry, primitive] = tree_.emitters()[chosen];
  if (scene_.geometry.is_sphere(geometry)) return sample_sphere(primitive, probability, p, u);
  const TriangleMesh& mesh = scene_.geometry.meshes[geometry];
  const Triangle t = triangle_corners(mesh, primitive);
  const EmitterSample<float> s = sample_triangle<float>(true, t.p0, t.p1, t.p2, probability, p, {u.x, u.y});
  LightSample light = seen_point(s);
  if (!(light.pdf > 0.0f)) return light;
  const Texture& texture = scene_.materials[scene_.mesh_materials[geometry].of(primitive)].color;
  const vec2 uv = texture.kind == Texture::Kind::image ? interpolated_texcoords(mesh, primitive, s.b1, s.b2) : vec2(0);
  light.radiance = texture_color(texture, scene_.textures, s.position, uv);
  return light;
}

void Lights::fetch(std::uint32_t lanes, const float* v, const float* const (&p)[3], LightLanes& out) const {
  out.triangles = out.spheres = out.infinite = 0;
  for (; lanes != 0; lanes &= lanes - 1) {
    const int i = __builtin_ctz(lanes);
    const vec3 from(p[0][i], p[1][i], p[2][i]);
    if (out.probability[i] > 0.0f && out.emitter[i] != LightChoice::kNotOfTree) {
      const auto [geometry, primitive] = tree_.emitters()[out.emitter[i]];
      const bool is_sphere = scene_.geometry.is_sphere(geometry);
      const Texture& texture = scene_.materials[scene_.material_of(geometry, primitive)].color;
      bool ready = texture.kind == Texture::Kind::solid;
      if (ready && is_sphere) {
        const Sphere& sphere = scene_.geometry.spheres[primitive];
        ready = SeenSphere<float>(sphere.center, sphere.radius, from).from_outside();
        const float* const row = &sphere.center.x;
        for (int k = 0; k < 4; ++k) out.corner[k][i] = row[k];
      } else if (ready) {
        const TriangleMesh& mesh = scene_.geometry.meshes[geometry];
        const uvec3& corners = mesh.triangles[primitive];
        for (int c = 0; c < 3; ++c) {
          const float* const corner = &mesh.positions[corners[c]].x;
          for (int k = 0; k < 3; ++k) out.corner[3 * c + k][i] = corner[k];
        }
      }
      if (ready) {
        for (int k = 0; k < 3; ++k) out.radiance[k][i] = (&texture.a.x)[k];
        (is_sphere ? out.spheres : out.triangles) |= 1u << i;
        continue;
      }
    }
    put(sample_tree_emitter(out.emitter[i], out.probability[i], from, {out.u[i], v[i]}), i, out);
  }
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
    put(sample_emitter(chosen.emitter, {p[0][i], p[1][i], p[2][i]}, {chosen.u, v[i]}), i, out);
  }
}

LightSample Lights::sample_mesh(const TriangleEmitter& emitter, const vec3& p, const vec2& u) const {
  const EmitterSample<float> s = sample_triangle<float>(
      {emitter.p0, emitter.e1, emitter.e2, emitter.ng, emitter.offset, emitter.pdf_area}, p, {u.x, u.y});
  LightSample light = seen_point(s);
  if (!(light.pdf > 0.0f)) return light;
  light.radiance = emitter.radiance;
  if (emitter.varies) {
    const vec2 uv = interpolated_texcoords(scene_.geometry.meshes[emitter.mesh], emitter.triangle, s.b1, s.b2);
    light.radiance = texture_color(scene_.materials[emitter.material].color, scene_.textures, s.position, uv);
  }
  return light;
}

LightSample Lights::sample_sphere(std::uint32_t sphere_id, float probability, const vec3& p, const vec2& u) const {
  const Sphere& sphere = scene_.geometry.spheres[sphere_id];
  LightSample light;
  if (SeenSphere<float>(sphere.center, sphere.radius, p).from_outside()) {
    light = seen_point(sample_sphere_outside<float>(sphere.center, sphere.radius, probability, p, {u.x, u.y}));
    if (!(light.pdf > 0.0f)) return light;
  } else {
    // From inside every point is seen: uniform over the surface.
    const SurfacePoint point = point_on_sphere(sphere, uniform_sphere<float>(u.x, u.y));
    const vec3 way = point.position - p;
    light.wi = glm::normalize(way);
    light.position = point.position;
    light.ng = point.ng;
    const float pdf = probability * sphere_direction_pdf(sphere_id, p, point.position, light.wi);
    if (!(pdf > 0.0f && pdf < kInfinity)) return light;
    light.pdf = pdf;
    light.end = shadow_end<float>(way, point.ng, point.offset, 1.0f / std::abs(glm::dot(way, point.ng)));
  }
  const std::uint32_t material = scene_.sphere_materials[sphere_id];
  const Texture& texture = scene_.materials[material].color;
  const vec2 uv = texture.kind == Texture::Kind::image ? sphere_texcoords(light.ng) : vec2(0.0f);
  light.radiance = texture_color(texture, scene_.textures, light.position, uv, AddressMode::clamp);
  return light;
}

float Lights::triangle_pdf(std::uint32_t mesh, std::uint32_t triangle, std::uint32_t material, const vec3& p,
                           const vec3& hit_position, const vec3& ng, const vec3& wi, const vec3& receiver_ng) const {
  float pdf_area = triangle_pdf_area(material);
  if (!tree_.empty() && pdf_area > 0.0f) {
    const Triangle t = triangle_corners(scene_.geometry.meshes[mesh], triangle);
    pdf_area = raylab::triangle_pdf_area<float>(
        light_probability<float>(view_, {p, receiver_ng}, tree_.place(mesh, triangle)), t.p0, t.p1, t.p2);
  }
  return raylab::triangle_pdf<float>(pdf_area, p, hit_position, ng, wi);
}

float Lights::triangle_pdf_area(std::uint32_t material) const {
  if (material_luminance_.empty()) return 0.0f;
  return static_cast<float>(2.0 * static_cast<double>(material_luminance_[material]) * inv_total_power_);
}

float Lights::sphere_direction_pdf(std::uint32_t sphere, const vec3& p, const vec3& hit_position,
                                   const vec3& wi) const {
  const Sphere& s = scene_.geometry.spheres[sphere];
  const SeenSphere<float> seen(s.center, s.radius, p);
  if (seen.from_outside()) return seen.pdf();
  const vec3 to_light = hit_position - p;
  const vec3 n = (hit_position - s.center) / s.radius;
  const float cosine = std::abs(glm::dot(n, wi));
  return cosine > 0.0f ? glm::dot(to_light, to_light) / (cosine * 4.0f * kPi * static_cast<float>(seen.r2)) : 0.0f;
}

float Lights::sphere_probability(std::uint32_t sphere, std::uint32_t material) const {
  return static_cast<float>(material_luminance_[material] * sphere_power(scene_.geometry.spheres[sphere]) *
                            inv_total_power_);
}

float Lights::sphere_pdf(std::uint32_t sphere, std::uint32_t material, const vec3& p, const vec3& hit_position,
                         const vec3& wi, const vec3& receiver_ng) const {
  if (material_luminance_.empty()) return 0.0f;
  const float probability =
      tree_.empty()
          ? sphere_probability(sphere, material)
          : light_probability<float>(view_, {p, receiver_ng}, tree_.place(scene_.geometry.sphere_geometry(), sphere));
  return probability * sphere_direction_pdf(sphere, p, hit_position, wi);
}

float Lights::environment_pdf(const vec3& wi) const {
  return environment_probability_ > 0.0f ? environment_probability_ * environment_.pdf(wi) : 0.0f;
}

std::size_t Lights::bytes() const {
  return triangles_.capacity() * sizeof(TriangleEmitter) + spheres_.capacity() * sizeof(std::uint32_t) +
         first_.capacity() * sizeof(std::uint64_t) + material_luminance_.capacity() * sizeof(float) +
         environment_.bytes() + tree_.bytes();
}

}  // namespace raylab
