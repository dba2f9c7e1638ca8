// Whether renders know how far from the truth they are: many small pictures against references.
#include "catch.hpp"
#include "raylab/accel/accelerator.hpp"
#include "raylab/image/metrics.hpp"
#include "test_scenes.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

SeenScene matte_room() {
  SeenScene scene;
  const Material white = lambertian(grey(0.75f));
  add_quad(scene, {-1, -1, -1}, {0, 0, 2}, {2, 0, 0}, white);
  add_quad(scene, {-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, white);
  add_quad(scene, {-1, -1, -1}, {2, 0, 0}, {0, 2, 0}, white);
  add_quad(scene, {-1, -1, -1}, {0, 2, 0}, {0, 0, 2}, lambertian(color(0.65f, 0.05f, 0.05f)));
  add_quad(scene, {1, -1, -1}, {0, 0, 2}, {0, 2, 0}, lambertian(color(0.1f, 0.5f, 0.1f)));
  add_quad(scene, {-0.3f, 0.98f, -0.3f}, {0.6f, 0, 0}, {0, 0, 0.6f}, light(grey(12.0f)));
  add_box(scene, {-0.6f, -1, -0.5f}, {-0.1f, 0.2f, 0}, white);
  look(scene, {0, 0, 3.4f}, {0, 0, 0}, 40.0f);
  return scene;
}

SeenScene balls_under_sky() {
  SeenScene scene;
  add_quad(scene, {-4, 0, -4}, {0, 0, 8}, {8, 0, 0}, lambertian(checker(0.5f, Rgb(0.8f), Rgb(0.2f))));
  add_sphere(scene, {0, 0.5f, 0}, 0.5f, lambertian(color(0.7f, 0.3f, 0.2f)));
  add_sphere(scene, {1, 0.3f, 0.5f}, 0.3f, lambertian(grey(0.5f)));
  set_sky(scene, 16, 8,
          [](int x, int y) { return x == 3 && y == 2 ? Rgb(60.0f, 55.0f, 40.0f) : Rgb(0.4f, 0.5f, 0.8f); });
  look(scene, {0, 1.2f, 4}, {0, 0.3f, 0}, 40.0f);
  return scene;
}

}  // namespace

TEST_CASE("the estimated error's interval holds the true error of 93% of small pictures or more",
          "[statistical][session]") {
  constexpr int kRuns = 90;
  int held = 0, runs = 0;
  for (const SeenScene& scene : {matte_room(), balls_under_sky()}) {
    const auto accelerator = make_accelerator("bvh", scene.geometry);
    RenderOptions options = render_options(20, 20, 8192);
    options.camera = scene.camera;
    options.seed = 12345;
    const auto run = [&] {
      RenderSession session(scene, *accelerator, options);
      session.run();
      return std::pair(session.film().image(), session.estimated_error());
    };
    const Image reference = run().first;
    for (const SamplerKind sampler : {SamplerKind::independent, SamplerKind::sobol}) {
      for (const std::uint32_t samples : {16u, 48u, 64u}) {
        options.sampler = sampler;
        options.samples_per_pixel = samples;
        double estimated = 0.0, truth = 0.0;
        for (options.seed = 1; options.seed <= kRuns; ++options.seed) {
          const auto [image, error] = run();
          const double is = image_error(image, reference).relmse;
          held += error.low <= is && is <= error.high;
          ++runs;
          estimated += error.relmse;
          truth += is;
        }
        INFO(sampler_name(sampler) << ", " << samples << " samples: truth " << truth / kRuns);
        CHECK(estimated / truth > 0.85);
        CHECK(estimated / truth < 1.35);
      }
    }
  }
  INFO(held << " of " << runs);
  CHECK(runs >= 500);
  CHECK(held >= 0.93 * runs);
}
