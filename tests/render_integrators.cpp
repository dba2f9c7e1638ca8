// Both integrators, light sampling on and off, must agree on what a scene looks like.
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "catch.hpp"
#include "expect_error.hpp"
#include "raylab/accel/accelerator.hpp"
#include "raylab/io/scene_file.hpp"
#include "shipped_scenes.hpp"
#include "test_scenes.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

struct Case {
  const char* name;
  int max_depth;
  std::function<void(SeenScene&)> add;
};

void add_floor(Scene& s, const Material& m) { add_quad(s, {-3, 0, -3}, {0, 0, 6}, {6, 0, 0}, m); }

/// Objects of every material on a floor, seen from the front.
void add_objects(SeenScene& s) {
  add_floor(s, lambertian(checker(0.5f, Rgb(0.8f, 0.3f, 0.2f), Rgb(0.2f, 0.5f, 0.8f))));
  add_sphere(s, {-1.2f, 0.6f, 0}, 0.6f, glass());
  add_sphere(s, {0, 0.6f, -0.4f}, 0.6f, metal(color(0.9f, 0.7f, 0.4f), 0.15f));
  add_sphere(s, {1.2f, 0.6f, 0}, 0.6f, lambertian(color(0.2f, 0.8f, 0.4f)));
  add_box(s, {-0.3f, 0, 0.5f}, {0.1f, 0.5f, 0.9f}, metal(grey(0.9f), 0.0f));
  look(s, {0, 1.8f, 4.0f}, {0, 0.5f, 0}, 45.0f);
}

const std::vector<Case>& cases() {
  static const std::vector<Case> all = {
      {"a quad of light over every material", 8,
       [](SeenScene& s) {
         add_objects(s);
         add_quad(s, {-1.5f, 2.5f, -1.5f}, {3, 0, 0}, {0, 0.2f, 3}, light(color(3, 2, 1)));
       }},
      {"a sphere of light beside every material", 8,
       [](SeenScene& s) {
         add_objects(s);
         add_sphere(s, {2.0f, 2.4f, 1.5f}, 0.9f, light(color(2, 4, 5)));
       }},
      {"everything inside a sphere of light", 6,
       [](SeenScene& s) {
         add_objects(s);
         add_sphere(s, {0.5f, 0.2f, 0}, 6.0f, light(color(0.5f, 0.8f, 1)));
       }},
      {"a light with a picture on it", 6,
       [](SeenScene& s) {
         add_objects(s);
         add_quad(s, {-2, 3, -2}, {4, 0, 0}, {0, 0, 4},
                  light(picture(s, 4, 4, [](int x, int y) { return Rgb(x == 1 ? 6.0f : 0.1f, y, 0.5f * x); })));
       }},
      {"a checkered sphere of light, partly black", 6,
       [](SeenScene& s) {
         add_objects(s);
         add_sphere(s, {-1, 3, 0.5f}, 1.2f, light(checker(0.6f, Rgb(0.0f), Rgb(6, 3, 2))));
       }},
      {"a constant sky", 8,
       [](SeenScene& s) {
         add_objects(s);
         set_sky(s, Rgb(0.7f, 0.8f, 1.0f));
       }},
      {"a gradient sky", 8,
       [](SeenScene& s) {
         add_objects(s);
         set_sky(s, Rgb(1, 0.6f, 0.2f), Rgb(0.2f, 0.4f, 2));
       }},
      {"a picture of the sky with a bright part", 8,
       [](SeenScene& s) {
         add_objects(s);
         set_sky(s, 12, 6,
                 [](int x, int y) { return x > 6 && x < 9 && y == 1 ? Rgb(12, 10, 8) : Rgb(0.1f, 0.2f, 0.4f); });
       }},
      {"lights of every kind together", 8,
       [](SeenScene& s) {
         add_objects(s);
         add_quad(s, {-2.5f, 2.0f, -1.0f}, {1, 0.5f, 0}, {0, 0.3f, 2}, light(color(4, 1, 1)));
         add_sphere(s, {2.2f, 2.0f, 0}, 0.7f, light(color(1, 4, 2)));
         set_sky(s, 8, 4, [](int x, int y) { return Rgb(0.1f * x, 0.2f, y == 0 ? 1.5f : 0.1f); });
       }},
      {"glass around and in front of the light", 12,
       [](SeenScene& s) {
         add_objects(s);
         add_sphere(s, {0, 2.4f, 0.3f}, 0.9f, glass());
         add_sphere(s, {0, 2.4f, 0.3f}, 0.7f, light(grey(4)));
       }},
      {"a mirror that shows the light", 6,
       [](SeenScene& s) {
         add_floor(s, metal(grey(0.9f), 0.0f));
         add_quad(s, {-3, 0, -3}, {6, 0, 0}, {0, 4, 0}, lambertian(grey(0.7f)));
         add_quad(s, {-1, 1.5f, -1}, {2, 0, 0}, {0, 1, 1}, light(grey(3)));
         look(s, {0, 1.5f, 4.0f}, {0, 0.8f, 0}, 50.0f);
       }},
      {"two mirrors that face each other", 12,
       [](SeenScene& s) {
         add_floor(s, lambertian(grey(0.7f)));
         add_quad(s, {-1.5f, 0, -3}, {0, 0, 6}, {0, 3, 0},
                  metal(checker(0.4f, Rgb(0.9f), Rgb(0.5f, 0.7f, 0.9f)), 0.0f));
         add_quad(s, {1.5f, 0, -3}, {0, 0, 6}, {0, 3, 0}, metal(grey(0.8f), 0.0f));
         add_sphere(s, {0.7f, 0.5f, -0.5f}, 0.5f, lambertian(grey(0.6f)));
         add_quad(s, {-0.8f, 2, -1.5f}, {1.6f, 0, 0}, {0, 0.4f, 1.6f}, light(color(3, 2, 2)));
         add_sphere(s, {-0.8f, 1.5f, 0.5f}, 0.3f, light(color(1, 2, 2)));
         look(s, {0, 1.5f, 4.0f}, {0, 0.6f, 0}, 50.0f);
       }},
      {"a corner of mirrors of which a part is covered", 7,
       [](SeenScene& s) {
         for (const vec3& e : {vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1)}) {
           add_quad(s, {-1, -1, -1}, 2.0f * vec3(e.y, e.z, e.x), 2.0f * vec3(e.z, e.x, e.y), metal(grey(0.9f), 0.0f));
         }
         add_box(s, {-0.7f, -1, -0.7f}, {-0.2f, -0.3f, -0.1f}, lambertian(color(0.8f, 0.6f, 0.3f)));
         add_sphere(s, {0.4f, -0.4f, 0.0f}, 0.4f, metal(grey(0.9f), 0.3f));
         add_sphere(s, {0.3f, 0.5f, -0.6f}, 0.2f, glass());
         add_quad(s, {0.1f, 0.7f, 0.1f}, {0.8f, 0, 0.4f}, {0, 0.4f, 0.8f}, light(color(3, 4, 4)));
         set_sky(s, 4, 2, [](int x, int y) { return Rgb(0.2f * x, 0.1f, 0.2f * y); });
         look(s, {2.5f, 1.2f, 3.0f}, {-0.3f, -0.4f, -0.3f}, 40.0f);
       }},
      {"fuzzy metals of every degree", 8,
       [](SeenScene& s) {
         add_floor(s, metal(grey(0.8f), 0.4f));
         for (int i = 0; i < 4; ++i) {
           add_sphere(s, {-1.5f + static_cast<float>(i), 0.5f, 0}, 0.45f,
                      metal(color(0.9f, 0.8f, 0.7f), i == 0 ? 0.02f : 0.33f * static_cast<float>(i)));
         }
         add_quad(s, {-2, 2.5f, -2}, {4, 0, 0}, {0, 0.5f, 4}, light(grey(2)));
         look(s, {0, 1.8f, 4.0f}, {0, 0.5f, 0}, 45.0f);
       }},
      {"a closed room with long paths", 60, [](SeenScene& s) { s = lit_room(); }},
      {"smooth meshes with pictures, through a lens", 6,
       [](SeenScene& s) {
         const Texture t = picture(s, 8, 8, [](int x, int y) { return Rgb(0.1f * x, 0.1f * y, 0.5f); });
         add_floor(s, lambertian(t));
         add_smooth_sphere(s, {-0.9f, 0.8f, 0}, 0.8f, 5, lambertian(t));
         add_smooth_sphere(s, {0.9f, 0.8f, 0}, 0.8f, 5, metal(grey(0.9f), 0.2f));
         add_smooth_sphere(s, {0.0f, 0.5f, 1.2f}, 0.5f, 6, glass());
         add_smooth_sphere(s, {0.0f, 3.0f, 1.0f}, 0.8f, 4, light(grey(4)));
         set_sky(s, Rgb(0.1f), Rgb(0.2f, 0.3f, 0.5f));
         look(s, {0, 1.8f, 4.0f}, {0, 0.5f, 0}, 45.0f);
         s.camera.defocus_angle = 2.0f;
       }},
  };
  return all;
}

Estimate estimate(const SeenScene& scene, IntegratorKind kind, SamplerKind sampler, int max_depth, std::uint32_t seed,
                  bool all) {
  RenderOptions options = render_options(12, 12, 400, max_depth);
  options.integrator.kind = kind;
  options.sampler = sampler;
  options.seed = seed;
  if (all) options.needs = all_needs();
  return mean_luminance(render(scene, options, "embree-robust"));
}

}  // namespace

TEST_CASE("path and book agree on the mean of every scene", "[statistical][integrators]") {
  double sum_of_squares = 0.0;
  std::uint32_t seed = 100;
  for (const Case& c : cases()) {
    SeenScene scene;
    c.add(scene);
    using K = IntegratorKind;
    const Estimate book = estimate(scene, K::book, SamplerKind::independent, c.max_depth, ++seed, false);
    const Estimate path = estimate(scene, K::path, SamplerKind::independent, c.max_depth, ++seed, false);
    const Estimate sobol = estimate(scene, K::path, SamplerKind::sobol, c.max_depth, ++seed, false);
    const Estimate all = estimate(scene, K::path, SamplerKind::independent, c.max_depth, ++seed, true);
    INFO(c.name << ": book " << book.mean << " ± " << book.error << ", path " << path.mean << " ± " << path.error
                << ", with Sobol " << sobol.mean << " ± " << sobol.error << ", with everything on " << all.mean << " ± "
                << all.error);
    CHECK(book.mean > 0.0);
    CHECK(book.error < 0.03 * book.mean);
    CHECK(path.error < 0.02 * path.mean);
    CHECK(std::abs(difference_z(book, path)) < 4.0);
    CHECK(std::abs(difference_z(book, sobol)) < 4.0);
    CHECK(std::abs(difference_z(book, all)) < 4.0);
    sum_of_squares += std::pow(difference_z(book, path), 2.0);
  }
  // Small biases that each scene alone would hide: the squares add up to a chi-square of one degree a scene.
  const auto n = static_cast<double>(cases().size());
  CHECK(sum_of_squares < n + 4.0 * std::sqrt(2.0 * n));
}

TEST_CASE("path and book agree on the mean of every shipped scene", "[statistical][integrators]") {
  struct Shipped {
    const char* name;
    std::uint32_t book_samples, path_samples;
    double error;  ///< largest relative standard error at which the comparison says something
  };
  // Enough samples for the errors to be small; the sun of the globe is a rare thing to find by scattering alone.
  const Shipped shipped[] = {{"cornell", 2000, 1000, 0.01},     {"one-weekend", 500, 500, 0.005},
                             {"mirror-room", 2000, 1000, 0.01}, {"dragon", 1000, 500, 0.005},
                             {"bunny", 2000, 1000, 0.01},       {"globe", 2500, 200, 0.01},
                             {"forest", 500, 200, 0.005},       {"lamps", 2000, 1000, 0.01},
                             {"caustics", 40000, 4000, 0.03},   {"kaleidoscope", 20000, 1000, 0.02}};
  for (const Shipped& s : shipped) {
    const auto file = shipped_scene(s.name);
    if (!file) continue;
    const LoadedScene loaded = load_scene(*file);
    const Scene& scene = loaded.scene;
    const auto accelerator = make_accelerator("bvh", scene.geometry);
    const auto mean_of = [&](IntegratorKind kind, std::uint32_t samples) {
      RenderOptions options = render_options(24, 24, samples, scene.render.max_depth);
      options.camera = loaded.camera;
      options.integrator.kind = kind;
      options.sampler = SamplerKind::independent;
      options.seed = kind == IntegratorKind::path ? 11 : 12;
      RenderSession session(scene, *accelerator, options);
      session.run();
      return mean_luminance(session.snapshot());
    };
    const Estimate book = mean_of(IntegratorKind::book, s.book_samples);
    const Estimate path = mean_of(IntegratorKind::path, s.path_samples);
    INFO(s.name << ": book " << book.mean << " ± " << book.error << ", path " << path.mean << " ± " << path.error);
    CHECK(book.mean > 0.0);
    CHECK(std::hypot(book.error / book.mean, path.error / path.mean) < s.error);
    CHECK(std::abs(difference_z(book, path)) < 4.0);
  }
}

TEST_CASE("light sampling makes small lights quiet", "[statistical][integrators]") {
  SeenScene scene;
  add_floor(scene, lambertian(grey(0.7f)));
  add_sphere(scene, {0, 2, 0}, 0.2f, light(grey(20.0f)));
  look(scene, {0, 1, 3}, {0, 0, 0}, 30.0f);
  RenderOptions options = render_options(12, 12, 64);
  options.sampler = SamplerKind::independent;
  const double path = mean_luminance(render(scene, options)).error;
  options.integrator.kind = IntegratorKind::book;
  CHECK(path < 0.1 * mean_luminance(render(scene, options)).error);
}

TEST_CASE("roulette goes by what paths lose after the first surface: its colour ends none", "[unit][integrators]") {
  const auto picture_of_card = [](float colour) {
    SeenScene scene;
    add_quad(scene, {-0.01f, 0, -0.01f}, {0, 0, 0.02f}, {0.02f, 0, 0}, lambertian(grey(colour)));
    add_quad(scene, {-9, -1, -9}, {0, 0, 18}, {18, 0, 0}, lambertian(grey(0.5f)));
    add_quad(scene, {-9, 2, -9}, {18, 0, 0}, {0, 0, 18}, lambertian(grey(0.5f)));
    add_quad(scene, {3, 1.9f, -1}, {2, 0, 0}, {0, 0, 2}, light(grey(1.0f)));
    look(scene, {0, 1, 0.01f}, {0, 0, 0}, 0.5f);
    return render(scene, render_options(4, 4, 64, 12)).image();
  };
  const Image bright = picture_of_card(0.5f), dark = picture_of_card(0.5f / 64.0f);
  for (std::size_t i = 0; i < bright.pixels.size(); ++i) {
    CHECK(bright.pixels[i].r > 0.0f);
    CHECK(dark.pixels[i] == bright.pixels[i] / 64.0f);
  }
}

TEST_CASE("rays are counted by what they are for", "[unit][integrators]") {
  SeenScene scene;
  add_quad(scene, {-9, 0, -9}, {0, 0, 18}, {18, 0, 0}, lambertian(grey(0.5f)));
  add_quad(scene, {-1, 2, -1}, {2, 0, 0}, {0, 0, 2}, light(grey(1.0f)));
  look(scene, {0, 1, 0}, {0, 0, 0}, 30.0f);
  const auto accelerator = make_accelerator("list", scene.geometry);
  RenderOptions options = render_options(4, 4, 32, 2);
  options.camera = scene.camera;
  RenderSession path(scene, *accelerator, options);
  path.run();
  CHECK(path.stats().rays.camera == 512);
  CHECK(path.stats().rays.scattered == 512);
  CHECK(path.stats().rays.shadow == 512);
  CHECK(path.stats().rays.total() == 1536);
  options.integrator.kind = IntegratorKind::book;
  RenderSession book(scene, *accelerator, options);
  book.run();
  CHECK(book.stats().rays.scattered == 512);
  CHECK(book.stats().rays.shadow == 0);
}

TEST_CASE("integrators are chosen by name", "[unit][integrators]") {
  for (const IntegratorKind kind : {IntegratorKind::path, IntegratorKind::book}) {
    CHECK(parse_integrator(integrator_name(kind)) == kind);
  }
  expect_error(ErrorKind::usage, "--integrator", {"bdpt", "path", "book"}, [] { parse_integrator("bdpt"); });
}
