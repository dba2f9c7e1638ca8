// No length is built in: rooms of any size look the same, and nothing leaks where surfaces are close or normals
// bent.
#include <cmath>
#include <string>

#include "catch.hpp"
#include "test_scenes.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

/// Share of the pixels that differ by more than a thousandth, and the ratio of the means.
struct Difference {
  double pixels = 0.0;
  double mean_ratio = 0.0;
};
Difference compare(const Film& film, const Film& reference) {
  Difference d;
  for (int y = 0; y < film.height(); ++y) {
    for (int x = 0; x < film.width(); ++x) {
      const Rgb a = film.mean(x, y);
      const Rgb b = reference.mean(x, y);
      d.pixels += max_component(glm::abs(a - b)) > 1e-3f * (max_component(b) + 1e-3f);
    }
  }
  d.pixels /= film.width() * film.height();
  d.mean_ratio = mean_luminance(film).mean / mean_luminance(reference).mean;
  return d;
}

}  // namespace

TEST_CASE("a lit room scaled by a power of two is the same picture to the bit", "[stability][scale]") {
  const RenderOptions options = render_options(16, 16, 16);
  for (const char* accelerator : {"list", "embree-robust"}) {
    const Film reference = render(lit_room(), options, accelerator);
    for (const int exponent : {-20, -7, 1, 20}) {
      INFO(accelerator << ", 2^" << exponent);
      CHECK(different_pixels(render(lit_room(std::ldexp(1.0f, exponent)), options, accelerator), reference) == 0);
    }
  }
}

TEST_CASE("a lit room from a micrometre to a thousand kilometres is the same picture", "[stability][scale]") {
  // Coordinates that are no power of two apart round differently, which turns some random choices around.
  RenderOptions options = render_options(16, 16, 64);
  for (const char* accelerator : {"list", "embree", "embree-robust"}) {
    const Film reference = render(lit_room(), options, accelerator);
    for (const float scale : {1e-6f, 1e-3f, 1e3f, 1e6f}) {
      const Difference d = compare(render(lit_room(scale), options, accelerator), reference);
      INFO(accelerator << ", scale " << scale << ": " << 100.0 * d.pixels << "% of the pixels differ, mean ratio "
                       << d.mean_ratio);
      CHECK(d.pixels < 0.05);
      CHECK(d.mean_ratio == Approx(1.0).epsilon(2e-3));
    }
  }
  // The book's t_min = 0.001 is a length, and shows it.
  options.integrator.ray_offset = RayOffset::book;
  const Film reference = render(lit_room(), options);
  for (const float scale : {1e-6f, 1e6f}) {
    CHECK(std::abs(compare(render(lit_room(scale), options), reference).mean_ratio - 1.0) > 0.1);
  }
}

TEST_CASE("no light comes through a plate half a millimetre behind glass", "[stability][scale]") {
  SeenScene scene = hidden_light();
  add_quad(scene, {-20, -20, 5e-4f}, {40, 0, 0}, {0, 40, 0}, glass(1.5f));
  add_sphere(scene, {0, 0, 3}, 0.5f, lambertian(grey(0.9f)));
  for (const auto integrator : {IntegratorKind::path, IntegratorKind::book}) {
    for (const char* accelerator : {"list", "embree", "embree-robust"}) {
      RenderOptions options = render_options(12, 12, 32, 12);
      options.integrator.kind = integrator;
      INFO(integrator_name(integrator) << ", " << accelerator);
      CHECK(mean_luminance(render(scene, options, accelerator)).mean == 0.0);
      options.integrator.ray_offset = RayOffset::book;
      CHECK(mean_luminance(render(scene, options, accelerator)).mean > 0.0);
    }
  }
}

TEST_CASE("bent shading normals let no light through a wall", "[stability][scale]") {
  // Normals almost along the wall: half of the directions that look reflected go through it.
  for (const Material& material : {lambertian(grey(0.8f)), metal(grey(0.9f), 0.5f), metal(grey(0.9f), 0.0f)}) {
    SeenScene scene = hidden_light();
    scene.materials[1] = material;
    TriangleMesh& wall = scene.geometry.meshes[1];
    wall.normals = {glm::normalize(vec3(1, 0, 0.1f)), glm::normalize(vec3(0, 1, 0.1f)),
                    glm::normalize(vec3(-1, 0, 0.1f)), glm::normalize(vec3(0, -1, 0.1f))};
    REQUIRE(scene_needs(scene).shading_normals);
    for (const auto integrator : {IntegratorKind::path, IntegratorKind::book}) {
      RenderOptions options = render_options(12, 12, 32, 8);
      options.integrator.kind = integrator;
      CHECK(mean_luminance(render(scene, options)).mean == 0.0);
    }
  }
}

TEST_CASE("a closed room stays dark whatever shines outside", "[stability][scale]") {
  for (const float scale : {1e-4f, 1.0f, 1e4f}) {
    for (const vec3& center : {vec3(0.0f), vec3(8.0f, -24.0f, 4.0f)}) {
      SeenScene scene;
      const vec3 c = scale * center;
      add_box(scene, c - vec3(scale), c + vec3(scale), lambertian(grey(0.9f)));
      add_sphere(scene, c + scale * vec3(0.3f, -0.5f, 0.2f), 0.4f * scale, glass());
      add_sphere(scene, c, 50.0f * scale, light(grey(1000.0f)));
      set_sky(scene, Rgb(1000.0f));
      look(scene, c + scale * vec3(-0.6f, 0.5f, 0.8f), c, 70.0f);
      for (const char* accelerator : {"list", "embree-robust"}) {
        INFO(accelerator << ", scale " << scale << " at " << center.x);
        CHECK(mean_luminance(render(scene, render_options(16, 16, 16, 12), accelerator)).mean == 0.0);
      }
    }
  }
}

TEST_CASE("a lamp behind a cover lights nothing, down to a gap of sixteen units in the last place",
          "[stability][scale]") {
  for (const float base : {0.0f, 10.0f, 1000.0f}) {
    const auto floor_light = [&](float gap, IntegratorKind kind) {
      SeenScene scene;
      const vec3 at(base, base, base);
      add_quad(scene, at + vec3(-1, 0, -1), {0, 0, 2}, {2, 0, 0}, lambertian(grey(0.5f)));
      add_quad(scene, at + vec3(-0.25f, 1, -0.25f), {0.5f, 0, 0}, {0, 0, 0.5f}, light(grey(10.0f)));
      if (gap > 0.0f)
        add_quad(scene, at + vec3(-0.3f, 1 - gap, -0.3f), {0.6f, 0, 0}, {0, 0, 0.6f}, lambertian(grey(0.0f)));
      look(scene, at + vec3(0, 0.5f, 0.8f), at, 60.0f);
      RenderOptions options = render_options(16, 16, 64, 3);
      options.integrator.kind = kind;
      return mean_luminance(render(scene, options)).mean;
    };
    const float ulp = next_float_up(base + 1.0f) - (base + 1.0f);
    const double uncovered = floor_light(0.0f, IntegratorKind::path);
    for (const IntegratorKind kind : {IntegratorKind::path, IntegratorKind::book, IntegratorKind::reference}) {
      for (const float gap : {16.0f * ulp, 64.0f * ulp, 1024.0f * ulp}) {
        INFO("at " << base << ", gap " << gap << " of ulp " << ulp);
        CHECK(floor_light(gap, kind) < 2e-3 * uncovered);
      }
    }
  }
}

TEST_CASE("a ground sphere of any radius is lit and shadowed as a plane is", "[stability][scale]") {
  const auto ground_light = [&](float radius, bool plate, IntegratorKind kind) {
    SeenScene scene;
    if (radius > 0.0f) add_sphere(scene, {0, -radius, 0}, radius, lambertian(grey(0.5f)));
    if (radius == 0.0f) add_quad(scene, {-50, 0, -50}, {0, 0, 100}, {100, 0, 0}, lambertian(grey(0.5f)));
    add_quad(scene, {-1, 3, -1}, {2, 0, 0}, {0, 0, 2}, light(grey(10.0f)));
    if (plate) add_quad(scene, {-9, 2, -9}, {18, 0, 0}, {0, 0, 18}, lambertian(grey(0.0f)));
    look(scene, {0, 1, 2}, vec3(0.0f), 30.0f);
    RenderOptions options = render_options(16, 16, 256, 3);
    options.integrator.kind = kind;
    return mean_luminance(render(scene, options)).mean;
  };
  for (const IntegratorKind kind : {IntegratorKind::path, IntegratorKind::book}) {
    const double flat = ground_light(0.0f, false, kind);
    for (const float radius : {1e2f, 1e3f, 1e4f, 1e5f, 1e6f, 1e7f}) {
      INFO("radius " << radius);
      CHECK(ground_light(radius, true, kind) == 0.0);
      if (radius >= 1e3f) CHECK(ground_light(radius, false, kind) == Approx(flat).epsilon(0.02));
    }
  }
}

TEST_CASE("a metal of any fuzz reflects all of a lamp that it sees nothing but", "[stability][scale]") {
  for (const float fuzz : {0.0f, 1e-8f, 1e-7f, 1e-6f, 1e-5f, 1e-4f, 2e-4f, 3e-4f, 1e-3f, 1e-2f, 0.1f}) {
    for (const IntegratorKind kind : {IntegratorKind::path, IntegratorKind::book}) {
      SeenScene scene;
      add_quad(scene, {-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, metal(grey(0.5f), fuzz));
      add_quad(scene, {-400, 1, -400}, {800, 0, 0}, {0, 0, 800}, light(grey(2.0f)));
      look(scene, {0, 0.9f, 0.3f}, vec3(0.0f), 20.0f);
      RenderOptions options = render_options(16, 16, 256, 3);
      options.integrator.kind = kind;
      const Estimate seen = mean_luminance(render(scene, options));
      INFO("fuzz " << fuzz << (kind == IntegratorKind::path ? ", path" : ", book") << ": error " << seen.error);
      CHECK(seen.mean == Approx(1.0).epsilon(1e-3));
    }
  }
}

TEST_CASE("with the book's offset shadow rays leave their surface too", "[stability][scale]") {
  SeenScene scene;
  add_sphere(scene, vec3(0.0f), 1.0f, lambertian(grey(0.5f)));
  add_quad(scene, {-1, 3, -1}, {2, 0, 0}, {0, 0, 2}, light(grey(10.0f)));
  look(scene, {0, 3, 3}, vec3(0.0f), 40.0f);
  RenderOptions options = render_options(16, 16, 256, 2);
  const Estimate bounds = mean_luminance(render(scene, options));
  options.integrator.ray_offset = RayOffset::book;
  for (const IntegratorKind kind : {IntegratorKind::path, IntegratorKind::reference}) {
    options.integrator.kind = kind;
    CHECK(mean_luminance(render(scene, options)).mean == Approx(bounds.mean).epsilon(0.01));
  }
}
