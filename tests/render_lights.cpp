#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "catch.hpp"
#include "core_statistics.hpp"
#include "glm_formulas.hpp"
#include "raylab/accel/accelerator.hpp"
#include "raylab/core/parallel.hpp"
#include "raylab/scene/surface_point.hpp"
#include "render/lights.hpp"
#include "test_scenes.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

constexpr double kPiD = 3.14159265358979323846;

struct Draw {
  std::uint64_t select;
  vec2 u;
};
Draw random_draw(std::uint64_t i) {
  const std::uint64_t a = mix_bits(i * 0x9e3779b97f4a7c15ull + 5);
  const std::uint64_t b = mix_bits(a + 1);
  return {b, {bits_to_unit(static_cast<std::uint32_t>(a)), bits_to_unit(static_cast<std::uint32_t>(a >> 32))}};
}

/// Density with which the lights give direction wi from p: that of every emitter the ray meets, hidden ones too,
/// since what is in between is found out later. A sphere seen from outside gives its near side only.
double density(const Scene& scene, const Lights& lights, const Accelerator& accelerator, const vec3& p,
               const vec3& wi) {
  double sum = lights.environment_pdf(wi);
  Ray ray{p, wi};
  std::vector<bool> seen(scene.geometry.spheres.size(), false);
  while (const auto hit = accelerator.intersect(ray)) {
    const auto point = surface_point(scene.geometry, ray, *hit);
    const std::uint32_t material = scene.material_of(hit->geometry, hit->primitive);
    if (scene.geometry.is_sphere(hit->geometry)) {
      if (!seen[hit->primitive]) sum += lights.sphere_pdf(hit->primitive, material, p, point.position, wi);
      seen[hit->primitive] = true;
    } else if (scene.materials[material].kind == Material::Kind::diffuse_light) {
      sum += lights.triangle_pdf(hit->geometry, hit->primitive, material, p, point.position, point.ng, wi);
    }
    ray.t_min = hit->t * (1.0f + 4.0f * kUnitRoundoff);
  }
  return sum;
}

/// Samples of a scene's lights from p against the density found by casting rays, over directions at most `angle`
/// degrees from `axis`, which must be all that give light.
void compare_with_density(const Scene& scene, const vec3& p, const vec3& axis, double angle, int count = 60000,
                          int fine = 40) {
  constexpr int kRings = 12, kSectors = 16;
  const FlushDenormals flush;
  const auto accelerator = make_accelerator("embree-robust", scene.geometry);
  const Lights lights(scene, scene_needs(scene));
  const test::GlmFrame frame(glm::normalize(axis));
  const double widest = 1.0 - std::cos(angle * kPiD / 180.0);

  std::vector<double> expected(kRings * kSectors, 0.0), counted(kRings * kSectors, 0.0);
  double integral = 0.0;
  const double solid_angle = widest * 2.0 * kPiD / (kRings * fine * kSectors * fine);
  std::uint64_t jitter = 0;
  for (int i = 0; i < kRings * fine; ++i) {
    for (int k = 0; k < kSectors * fine; ++k) {
      // One point at random in each small cell: borders of lights then cost noise, not a bias.
      const vec2 r = random_draw(++jitter + (1u << 30)).u;
      const double cosine = 1.0 - widest * (i + static_cast<double>(r.x)) / (kRings * fine);
      const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
      const double phi = 2.0 * kPiD * ((k + static_cast<double>(r.y)) / (kSectors * fine) - 0.5);
      const vec3 wi = glm::normalize(frame.to_world(vec3(dvec3(sine * std::cos(phi), sine * std::sin(phi), cosine))));
      const double mass = density(scene, lights, *accelerator, p, wi) * solid_angle;
      expected[(i / fine) * kSectors + k / fine] += mass * count;
      integral += mass;
    }
  }
  int useless = 0, outside = 0, bad = 0;
  double worst_pdf = 0.0, worst_radiance = 0.0;
  for (std::uint64_t n = 0; n < static_cast<std::uint64_t>(count); ++n) {
    const Draw draw = random_draw(n);
    const LightSample s = lights.sample(p, draw.select, draw.u.y);
    if (!(s.pdf > 0.0f)) {
      ++useless;
      continue;
    }
    bad += std::abs(glm::length(s.wi) - 1.0f) > 1e-5f || !is_finite(s.radiance);
    const vec3 local = frame.to_local(s.wi);
    const double ring = (1.0 - local.z) / widest * kRings;
    if (ring >= kRings * (1.0 + 1e-5)) {
      ++outside;
      continue;
    }
    const double turn = std::atan2(local.y, local.x) / (2.0 * kPiD) + 0.5;
    ++counted[std::min(kRings - 1, static_cast<int>(ring)) * kSectors +
              std::min(kSectors - 1, static_cast<int>(turn * kSectors))];
    if (s.infinite) {
      worst_pdf = std::max(worst_pdf, std::abs(1.0 - lights.environment_pdf(s.wi) / s.pdf));
      continue;
    }
    // The same emitter met by a ray: the same density and radiance, with the shadow ray ending on this side of it.
    const vec3 to_target = s.position - p;
    const float length = glm::length(to_target);
    const auto hit = accelerator->intersect({p, s.wi, 0.999f * length, kInfinity});
    if (!hit || std::abs(hit->t - length) > 1e-3f * length) continue;  // its very rim
    const auto point = surface_point(scene.geometry, Ray{p, s.wi}, *hit);
    const std::uint32_t material = scene.material_of(hit->geometry, hit->primitive);
    const float pdf =
        scene.geometry.is_sphere(hit->geometry)
            ? lights.sphere_pdf(hit->primitive, material, p, point.position, s.wi)
            : lights.triangle_pdf(hit->geometry, hit->primitive, material, p, point.position, point.ng, s.wi);
    // Grazing the emitter, the density turns on the last bits of the direction.
    if (std::abs(glm::dot(point.ng, s.wi)) < 0.02f) continue;
    worst_pdf = std::max(worst_pdf, std::abs(1.0 - static_cast<double>(pdf) / s.pdf));
    if (scene.materials[material].color.kind != Texture::Kind::checker) {
      const Rgb met = texture_color(scene.materials[material].color, scene.textures, point.position, point.uv,
                                    address_mode_of_v(scene.geometry.is_sphere(hit->geometry)));
      worst_radiance = std::max(worst_radiance, static_cast<double>(glm::length(met - s.radiance)) / luminance(met));
    }
  }
  CHECK(integral == Approx(1.0).epsilon(4e-3));
  CHECK(bad == 0);
  CHECK(outside == 0);
  CHECK(useless <= count / 2000);
  CHECK(worst_pdf < 2e-3);
  CHECK(worst_radiance < 5e-3);
  CHECK(chi_square_z(counted, expected) < kLimitZ);
}

}  // namespace

TEST_CASE("points of a triangle light are chosen with the density it is met with", "[statistical][lights]") {
  Scene scene;
  add_triangle(scene, {vec3(-1, 1, 0), vec3(1, 1, 0.5f), vec3(0.2f, 2.0f, 1)}, light(grey(3.0f)));
  SECTION("nearby") { compare_with_density(scene, vec3(0.1f, 0.2f, 0.1f), vec3(0, 1, 0.3f), 80.0); }
  SECTION("far away") { compare_with_density(scene, vec3(30, -20, 25), vec3(-30, 21.3f, -24.5f), 3.0); }
  SECTION("almost edge on") {
    compare_with_density(scene, vec3(0.0f, -3.0f, -2.2f), vec3(0.07f, 4.33f, 2.7f), 18.0, 60000, 160);
  }
  SECTION("from behind") { compare_with_density(scene, vec3(0.0f, 2.0f, -1.0f), vec3(0, -0.5f, 1.2f), 75.0); }
}

TEST_CASE("points of a sphere light are chosen with the density it is met with", "[statistical][lights]") {
  Scene scene;
  add_sphere(scene, vec3(1, 2, 3), 1.5f, light(grey(2.0f)));
  SECTION("from afar") { compare_with_density(scene, vec3(40, 20, -10), vec3(-39, -18, 13), 2.1); }
  SECTION("from nearby") { compare_with_density(scene, vec3(1, 0.3f, 3), vec3(0, 1, 0), 62.1); }
  SECTION("from just above it") { compare_with_density(scene, vec3(1, 0.49f, 3), vec3(0, 1, 0), 84.0); }
  SECTION("from its centre") { compare_with_density(scene, vec3(1, 2, 3), vec3(0, 0, 1), 180.0); }
  SECTION("from inside") { compare_with_density(scene, vec3(1.4f, 1.3f, 3.9f), vec3(0, 0, 1), 180.0); }
  SECTION("from inside, close to its surface") { compare_with_density(scene, vec3(1, 0.52f, 3), vec3(0, 1, 0), 180.0); }
}

TEST_CASE("a distant sphere light keeps its small cone of directions", "[unit][lights]") {
  // 1 - cos of a half angle of 1e-5 is below the precision of a float near 1.
  Scene scene;
  add_sphere(scene, vec3(0, 0, 1e5f), 1.0f, light(grey(2.0f)));
  const Lights lights(scene, scene_needs(scene));
  double farthest = 0.0;
  int bad = 0;
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const Draw draw = random_draw(i);
    const LightSample s = lights.sample(vec3(0.0f), draw.select, draw.u.y);
    bad += std::abs(s.pdf * kPiD * 1e-10 - 1.0) > 1e-3;
    farthest = std::max(farthest, static_cast<double>(std::hypot(s.position.x, s.position.y)));
  }
  CHECK(bad == 0);
  CHECK(farthest > 0.97);
  CHECK(farthest < 1.2);
}

TEST_CASE("a sphere light gives what its form factor says, however near it is", "[stability][lights]") {
  // On a surface that faces its centre from distance d it is pi L (r / d)^2.
  for (float gap = 1.0f; gap > 5e-7f; gap *= 0.1f) {
    Scene scene;
    add_sphere(scene, vec3(0.0f), 1.0f, light(grey(1.0f)));
    const Lights lights(scene, scene_needs(scene));
    const vec3 p(0.0f, 0.0f, 1.0f + gap);
    constexpr int kSide = 200;
    double sum = 0.0;
    for (int i = 0; i < kSide * kSide; ++i) {
      const vec2 u((static_cast<float>(i % kSide) + 0.5f) / kSide, (static_cast<float>(i / kSide) + 0.5f) / kSide);
      const LightSample s = lights.sample(p, static_cast<std::uint64_t>(u.x * 0x1p32f) << 32, u.y);
      REQUIRE(s.pdf > 0.0f);
      REQUIRE((s.end >= 0.0f && s.end < 1.0f));
      sum += std::max(0.0f, -s.wi.z) / s.pdf;
    }
    const double d = p.z;
    INFO("gap " << gap);
    CHECK(sum / (kSide * kSide) == Approx(kPi / (d * d)).epsilon(2e-4));
  }
}

TEST_CASE("no lamp shadows itself, however small and far away it is", "[stability][lights]") {
  for (const char* name : {"bvh", "list", "embree", "embree-robust", "exact"}) {
    for (const float size : {1e-3f, 1.0f}) {
      int sampled = 0, shadowed = 0;
      for (std::uint64_t i = 0; i < 300; ++i) {
        const auto point = [&](std::uint64_t k) {
          const Draw a = random_draw(100 * i + 2 * k), b = random_draw(100 * i + 2 * k + 1);
          return vec3(a.u.x, a.u.y, b.u.x) * 2.0f - 1.0f;
        };
        Scene scene;
        add_triangle(scene, {size * point(0), size * point(1), size * point(2)}, light(grey(1.0f)));
        const Lights lights(scene, scene_needs(scene));
        const auto accelerator = make_accelerator(name, scene.geometry);
        for (std::uint64_t k = 3; k < 30; ++k) {
          const vec3 p = 2.0f * point(k);
          const Draw draw = random_draw(100 * i + 90 + k % 10);
          const LightSample s = lights.sample(p, draw.select, draw.u.y);
          if (!(s.pdf > 0.0f)) continue;
          ++sampled;
          shadowed += accelerator->occluded({p, s.position - p, 0.0f, s.end});
        }
      }
      INFO(name << ", size " << size);
      CHECK(sampled > 7000);
      CHECK(shadowed == 0);
    }
  }
}

TEST_CASE("a light whose colour varies is chosen with the density it is met with", "[statistical][lights]") {
  Scene scene;
  const auto texel = [](int x, int y) { return Rgb(x == 1 ? 4.0f : 0.5f, 1.0f + y, 0.2f); };
  SECTION("a picture on a quad") {
    add_quad(scene, {-1, 1, -1}, {2, 0, 0}, {0, 0.3f, 2}, light(picture(scene, 4, 3, texel)));
    compare_with_density(scene, vec3(0.3f, 0, 0.2f), vec3(0, 1, 0), 75.0);
  }
  SECTION("a picture on a sphere") {
    add_sphere(scene, {0, 2, 0}, 1.0f, light(picture(scene, 4, 3, texel)));
    compare_with_density(scene, vec3(0.3f, 0, 0.2f), vec3(-0.3f, 2, -0.2f), 31.0);
  }
  SECTION("a checker on a quad, some of it black") {
    add_quad(scene, {-1, 1, -1}, {2, 0, 0}, {0, 0.3f, 2}, light(checker(0.4f, Rgb(2.0f), Rgb(0.0f))));
    compare_with_density(scene, vec3(0.3f, 0, 0.2f), vec3(0, 1, 0), 75.0);
  }
}

TEST_CASE("a picture of the sky is chosen with the density it is met with", "[statistical][lights]") {
  Scene scene;
  add_sphere(scene, vec3(0.0f), 1.0f, lambertian(grey(0.5f)));
  set_sky(scene, 16, 8, [](int x, int y) { return x == 9 && y == 2 ? Rgb(60.0f) : Rgb(0.3f + 0.05f * x); });
  compare_with_density(scene, vec3(0, 1.5f, 0), vec3(0, 1, 0), 180.0, 150000);
}

TEST_CASE("several lights together are chosen with the density they are met with", "[statistical][lights]") {
  Scene scene;
  add_quad(scene, {-1, 3, -1}, {2, 0, 0}, {0, 0, 2}, light(color(1, 2, 3)));
  add_sphere(scene, {3, 0.5f, 0}, 0.8f, light(grey(4.0f)));
  add_sphere(scene, {2, 0, 2}, 0.2f, light(grey(0.0f)));  // black: never chosen
  add_sphere(scene, {-1, -1, -1}, 0.4f, lambertian(grey(0.5f)));
  add_triangle(scene, {vec3(-3, 0, 1), vec3(-3, 1, -1), vec3(-3, 2, 1)}, light(checker(0.5f, Rgb(5.0f), Rgb(1.0f))));
  set_sky(scene, 8, 4, [](int x, int y) { return Rgb(x == 3 ? 2.0f : 0.1f, 0.2f, y == 0 ? 1.0f : 0.3f); });
  const Lights lights(scene, scene_needs(scene));
  CHECK(lights.count() == 2 + 1 + 1 + 1);
  compare_with_density(scene, vec3(0.2f, 0.1f, 0.3f), vec3(0, 1, 0), 180.0, 150000);
}

TEST_CASE("lights chosen by a tree are met with the density of their samples", "[statistical][lights]") {
  Scene scene;
  for (int i = 0; i < 12; ++i) {
    const auto angle = static_cast<float>(0.5 * i);
    const vec3 at(2.0f * std::cos(angle), 0.3f * static_cast<float>(i) - 2.0f, 2.0f * std::sin(angle));
    add_sphere(scene, at, 0.1f + 0.03f * static_cast<float>(i % 5), light(grey(static_cast<float>(1 + i * i))));
    add_quad(scene, -1.2f * at, {0.6f, 0.1f, 0}, {0, 0.2f, 0.5f},
             light(i == 3 ? checker(0.3f, Rgb(5.0f), Rgb(1.0f)) : grey(static_cast<float>(2 + i))));
  }
  add_sphere(scene, vec3(0.2f, 0.1f, 0.3f), 9.0f, light(grey(0.01f)));  // which the point is inside of
  set_sky(scene, 8, 4, [](int x, int y) { return Rgb(x == 3 ? 2.0f : 0.1f, 0.2f, y == 0 ? 1.0f : 0.3f); });
  const Lights lights(scene, scene_needs(scene));
  CHECK(lights.tree().emitters().size() == 12 + 24 + 1);
  compare_with_density(scene, vec3(0.2f, 0.1f, 0.3f), vec3(0, 1, 0), 180.0, 200000, 60);
}

TEST_CASE("lights are chosen in proportion to their power", "[statistical][lights]") {
  // In opposite directions: above a quad of both sides 2 x 3 x 4 x pi, below a sphere of 4 pi x 0.25 x 2 x pi.
  Scene scene;
  add_quad(scene, {-1, 3, -1.5f}, {2, 0, 0}, {0, 0, 3}, light(grey(4.0f / 6.0f)));
  add_sphere(scene, {0, -3, 0}, 0.5f, light(grey(2.0f)));
  const double quad = 2.0 * 6.0 * (4.0 / 6.0);
  const double sphere = 4.0 * kPiD * 0.25 * 2.0;
  const Lights lights(scene, scene_needs(scene));
  const int count = 100000;
  int above = 0;
  for (std::uint64_t i = 0; i < count; ++i) {
    const Draw draw = random_draw(i);
    above += lights.sample(vec3(0.0f), draw.select, draw.u.y).wi.y > 0.0f;
  }
  const double p = quad / (quad + sphere);
  CHECK(std::abs(above - p * count) < kLimitZ * std::sqrt(p * (1.0 - p) * count));
}

TEST_CASE("a light in whose plane the point lies gives it nothing", "[unit][lights]") {
  Scene scene;
  add_quad(scene, {1, 0, 0}, {1, 0, 0}, {0, 0, 1}, light(grey(1.0f)));
  const Lights lights(scene, scene_needs(scene));
  for (std::uint64_t i = 0; i < 100; ++i) {
    const Draw draw = random_draw(i);
    CHECK_FALSE(lights.sample(vec3(0, 0, 0.5f), draw.select, draw.u.y).pdf > 0.0f);
    const LightSample on_it = lights.sample(vec3(1.5f, 0, 0.5f), draw.select, draw.u.y);
    CHECK_FALSE(on_it.pdf > 0.0f);
  }
}

TEST_CASE("lights of any size are chosen", "[unit][lights]") {
  for (const float scale : {1e-12f, 1e-6f, 1.0f, 1e6f, 1e12f}) {
    SeenScene scene;
    add_quad(scene, {-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, light(grey(1.0f)));
    add_sphere(scene, {0, -3, 0}, 0.5f, light(grey(2.0f)));
    scale_scene(scene, scale);
    const Lights lights(scene, scene_needs(scene));
    INFO(scale);
    REQUIRE(lights.count() == 3);
    int above = 0, bad = 0;
    for (std::uint64_t i = 0; i < 2000; ++i) {
      const Draw draw = random_draw(i);
      const LightSample s = lights.sample(vec3(0.0f), draw.select, draw.u.y);
      bad += !(s.pdf > 0.0f && s.pdf < kInfinity);
      above += s.wi.y > 0.0f;
    }
    CHECK(bad == 0);
    CHECK(above / 2000.0 == Approx(8.0 / (8.0 + 2.0 * kPiD)).margin(0.04));
  }
}
