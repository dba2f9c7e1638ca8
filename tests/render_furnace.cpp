// Scenes whose radiance is known: furnaces, concentric spheres, a lamp over a floor, glass seen from inside.
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "catch.hpp"
#include "test_scenes.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

constexpr double kPiD = 3.14159265358979323846;

struct Method {
  std::string name;
  IntegratorKind integrator;
  SamplerKind sampler;
};
std::vector<Method> methods() {
  std::vector<Method> all;
  for (const auto integrator : {IntegratorKind::path, IntegratorKind::book}) {
    for (const auto sampler : {SamplerKind::independent, SamplerKind::sobol}) {
      all.push_back(
          {std::string(integrator_name(integrator)) + ", " + std::string(sampler_name(sampler)), integrator, sampler});
    }
  }
  return all;
}

/// Mean over a small picture; `error` includes what floats cannot tell.
Estimate estimate(const SeenScene& scene, const Method& method, std::uint32_t samples, int max_depth) {
  RenderOptions options = render_options(6, 6, samples, max_depth);
  options.integrator.kind = method.integrator;
  options.sampler = method.sampler;
  return mean_luminance(render(scene, options));
}

/// Within three standard errors, and two parts in a million for rounding.
void expect_mean(const Estimate& found, double expected) {
  INFO("found " << found.mean << " ± " << found.error << ", expected " << expected);
  CHECK(std::abs(found.mean - expected) <= 3.0 * found.error + 2e-6 * expected);
}

struct Furnace {
  const char* name;
  std::function<void(Scene&)> enclose;
};
/// Radiance 1 from everywhere.
const Furnace kFurnaces[] = {
    {"inside a glowing sphere", [](Scene& s) { add_sphere(s, vec3(0.3f, 0.1f, 0), 5.0f, light(grey(1.0f))); }},
    {"inside a glowing box", [](Scene& s) { add_box(s, vec3(-4, -3, -4), vec3(4, 5, 4), light(grey(1.0f))); }},
    {"under a constant sky", [](Scene& s) { set_sky(s, Rgb(1.0f)); }},
    {"under a gradient sky", [](Scene& s) { set_sky(s, Rgb(1.0f), Rgb(1.0f)); }},
    {"under a picture of the sky", [](Scene& s) { set_sky(s, 8, 4, [](int, int) { return Rgb(1.0f); }); }},
};

}  // namespace

TEST_CASE("in a white furnace nothing can be told apart", "[statistical][furnace]") {
  struct Object {
    const char* name;
    Material material;
  };
  const Object objects[] = {{"lambertian", lambertian(grey(1.0f))},
                            {"mirror", metal(grey(1.0f), 0.0f)},
                            {"glass", glass()},
                            {"air in glass", glass(1.0f / 1.5f)}};
  for (const Furnace& furnace : kFurnaces) {
    for (const Object& object : objects) {
      for (const bool mesh : {false, true}) {
        SeenScene scene;
        if (mesh) {
          add_box(scene, vec3(-0.7f), vec3(0.7f, 0.8f, 0.9f), object.material);
        } else {
          add_sphere(scene, vec3(0.0f), 1.0f, object.material);
        }
        furnace.enclose(scene);
        look(scene, {1.5f, 1.0f, 2.2f}, vec3(0.0f), 20.0f);
        for (const Method& method : methods()) {
          INFO(object.name << (mesh ? " box " : " sphere ") << furnace.name << ", " << method.name);
          // Light may go round inside of a glass box forever: what is left after so many segments is below the
          // error.
          expect_mean(
              estimate(scene, method, 64, mesh && object.material.kind == Material::Kind::dielectric ? 2000 : 200),
              1.0);
        }
      }
    }
  }
}

TEST_CASE("in a white furnace a fuzzy metal is as bright as what it does not absorb", "[statistical][furnace]") {
  for (const Furnace& furnace : kFurnaces) {
    for (const float fuzz : {0.05f, 0.3f, 1.0f}) {
      for (const double degrees : {0.0, 40.0, 80.0}) {
        SeenScene scene;
        add_quad(scene, {-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, metal(grey(1.0f), fuzz));
        furnace.enclose(scene);
        const double angle = degrees * kPiD / 180.0;
        look(scene, vec3(dvec3(2.0 * std::sin(angle), 2.0 * std::cos(angle), 0.0)), vec3(0.0f), 0.02f);
        const double cosine = std::cos(angle);
        const double expected = 1.0 - std::max(0.0, (fuzz - cosine) / (2.0 * fuzz));
        for (const Method& method : methods()) {
          INFO("fuzz " << fuzz << " at " << degrees << " degrees " << furnace.name << ", " << method.name);
          expect_mean(estimate(scene, method, 128, 10), expected);
        }
      }
    }
  }
}

TEST_CASE("light between two concentric spheres adds up to its series", "[statistical][furnace]") {
  // A glowing sphere of radius r inside a diffuse one of radius R: the fraction F = (r/R)² of what a wall point
  // sees is the light, the rest wall. With n segments L = rho Le F (1 + a + a² + ... + a^(n-2)), a = rho (1 - F).
  constexpr double kLight = 3.0, kFraction = 0.0625;
  for (const double albedo : {0.5, 0.99}) {
    SeenScene scene;
    add_sphere(scene, vec3(0.0f), 2.0f, lambertian(grey(static_cast<float>(albedo))));
    add_sphere(scene, vec3(0.0f), 0.5f, light(grey(static_cast<float>(kLight))));
    look(scene, {0, 0.1f, 1.2f}, {0.2f, 0.3f, 2.0f}, 50.0f);
    const double a = albedo * (1.0 - kFraction);
    for (const int segments : {1, 2, 3, 6, 1000}) {
      double series = 0.0, term = albedo * kLight * kFraction;
      for (int k = 2; k <= segments; ++k, term *= a) series += term;
      if (segments == 1000) CHECK(series == Approx(albedo * kLight * kFraction / (1.0 - a)).epsilon(1e-9));
      for (const Method& method : methods()) {
        INFO("albedo " << albedo << ", " << segments << " segments, " << method.name);
        const Estimate found = estimate(scene, method, segments == 1000 ? 256 : 512, segments);
        // The precision of the check, too: three standard errors are a few per cent at most.
        if (series > 0.0) CHECK(found.error < 0.04 * series);
        expect_mean(found, series);
      }
    }
  }
}

TEST_CASE("a lamp lights the floor by its form factor", "[statistical][furnace]") {
  const LampOverFloor lamp = lamp_over_floor();
  for (const Method& method : methods()) {
    INFO(method.name);
    const Estimate found = estimate(lamp.scene, method, 2048, 2);
    CHECK(found.error < 0.02 * found.mean);
    expect_mean(found, lamp.expected);
  }
}

TEST_CASE("the depth counts segments, the camera's included", "[unit][furnace]") {
  SeenScene scene;
  add_sphere(scene, {0, 0, -3}, 1.0f, glass(1.0f));  // no boundary: nothing but two more segments
  add_sphere(scene, {0, 0, -10}, 3.0f, light(grey(2.0f)));
  look(scene, vec3(0.0f), {0, 0, -1}, 5.0f);
  for (const Method& method : methods()) {
    INFO(method.name);
    CHECK(estimate(scene, method, 16, 1).mean == 0.0);
    CHECK(estimate(scene, method, 16, 2).mean == 0.0);
    CHECK(estimate(scene, method, 16, 3).mean == Approx(2.0).epsilon(1e-6));
    look(scene, {0, 0, -5}, {0, 0, -10}, 5.0f);
    CHECK(estimate(scene, method, 16, 1).mean == Approx(2.0).epsilon(1e-6));
    look(scene, vec3(0.0f), {0, 0, -1}, 5.0f);
    set_sky(scene, Rgb(0.5f));
    look(scene, {0, 9, 0}, {0, 10, 0.1f}, 5.0f);
    CHECK(estimate(scene, method, 16, 1).mean == Approx(0.5).epsilon(1e-6));
    look(scene, vec3(0.0f), {0, 0, -1}, 5.0f);
    set_sky(scene, Rgb(0.0f));
  }
}

TEST_CASE("glass seen from inside lets through what Fresnel's equations say", "[statistical][furnace]") {
  // From the point at distance sin(angle) from the centre, at right angles to the radius, the unit sphere is met
  // at that angle. With two segments only what passes at once is seen: n² (1 - R) of a sky of radiance 1. R
  // computed apart; Schlick's approximation with the inside cosine would have R = 0.041 at 40 degrees.
  struct Known {
    double degrees, reflected;
  };
  for (const Known& k : {Known{0.0, 0.04}, Known{35.0, 0.0861379914688122}, Known{38.0, 0.14218118093166612},
                         Known{40.0, 0.24529120428690981}, Known{41.0, 0.37975126596244024},
                         Known{41.5, 0.5416199915153559}, Known{41.8, 0.8907719214997081}, Known{42.0, 1.0}}) {
    const auto away = static_cast<float>(std::sin(k.degrees * kPiD / 180.0));
    SeenScene scene;
    add_sphere(scene, vec3(0.0f), 1.0f, glass());
    set_sky(scene, Rgb(1.0f));
    look(scene, {away, 0, 0}, {away, 0, 1}, 0.0005f);
    for (const Method& method : methods()) {
      INFO(k.degrees << " degrees, " << method.name);
      expect_mean(estimate(scene, method, 2048, 2), 2.25 * (1.0 - k.reflected));
      // All that is reflected meets the sphere at the same angle and passes in the end: radiance goes with n².
      if (k.reflected < 0.5) expect_mean(estimate(scene, method, 256, 400), 2.25);
    }
  }
}
