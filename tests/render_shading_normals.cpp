// Interpolated normals that lean away from the faces: light must neither be lost nor leak.
#include "catch.hpp"
#include "glm_formulas.hpp"
#include "test_scenes.hpp"

using namespace raylab;
using namespace raylab::test;

TEST_CASE("under a white sky a coarse mesh with smooth normals loses no light", "[statistical][furnace]") {
  for (const Material& material : {lambertian(grey(1.0f)), metal(grey(1.0f), 0.0f), glass()}) {
    for (const IntegratorKind kind : {IntegratorKind::path, IntegratorKind::book}) {
      SeenScene scene;
      add_smooth_sphere(scene, vec3(0.0f), 1.0f, 5, material);
      set_sky(scene, Rgb(1.0f));
      look(scene, {0, 0, 4}, {0, 0, 0}, 24.0f);
      RenderOptions options = render_options(32, 32, 64, 400);
      options.integrator.kind = kind;
      const Estimate mean = mean_luminance(render(scene, options));
      INFO(material.name << " " << integrator_name(kind) << ": " << mean.mean << " ± " << mean.error);
      CHECK(std::abs(mean.mean - 1.0) <= 3.0 * mean.error + 1e-5);
    }
  }
}

TEST_CASE("folded at the surface, a lobe keeps its energy and its density", "[statistical][bsdf]") {
  // A shading normal leaning 50 degrees from the geometric one, seen from where a third of the lobe lies below.
  const vec3 ng = glm::normalize(vec3(std::sin(0.87f), 0.0f, std::cos(0.87f)));
  const vec3 wo = glm::normalize(vec3(0.3f, 0.4f, 0.8f));
  // The density of fuzzy metal is infinite at its rim; directions close to it are left out on both sides.
  constexpr float kRim = 10.0f;
  for (const Material& material : {lambertian(grey(0.5f)), metal(grey(0.5f), 0.4f)}) {
    double integral = 0.0;
    constexpr int kSide = 1000;
    for (int i = 0; i < kSide; ++i) {
      for (int j = 0; j < kSide; ++j) {
        // Midpoints of an equal-area grid over the sphere.
        const vec3 wi = uniform_sphere({(i + 0.5f) / kSide, (j + 0.5f) / kSide});
        if (glm::dot(wi, ng) > 0.0f) {
          const auto f = test::eval_bsdf_above(material, material.color.a, wo, wi, ng);
          if (f.pdf > kRim) continue;
          integral += static_cast<double>(f.pdf) * 4.0 * static_cast<double>(kPi) / (kSide * kSide);
        }
      }
    }
    int sampled = 0;
    constexpr std::uint32_t kSamples = 100'000;
    for (std::uint32_t s = 0; s < kSamples; ++s) {
      const Sampler numbers(SamplerKind::independent, 3, 1, 2, s);
      const auto b =
          test::sample_bsdf_above(material, material.color.a, wo, ng, false, numbers.get2(0), numbers.get1(1));
      if (is_black(b.weight)) continue;
      REQUIRE(glm::dot(b.wi, ng) >= 0.0f);
      if (b.pdf > kRim) continue;
      ++sampled;
      REQUIRE(b.pdf == Approx(test::eval_bsdf_above(material, material.color.a, wo, b.wi, ng).pdf).epsilon(0.02));
    }
    INFO(integral << " integrated, " << sampled << " of " << kSamples << " sampled");
    CHECK(integral == Approx(static_cast<double>(sampled) / kSamples).margin(0.005));
  }
}
