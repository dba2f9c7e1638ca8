// The integrator that reads like the book against the one that renders: the same bits, for every instruction set.
#include <string>

#include "catch.hpp"
#include "raylab/accel/accelerator.hpp"
#include "raylab/io/scene_file.hpp"
#include "shipped_scenes.hpp"
#include "test_scenes.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

/// Pixels that differ in some bit between the reference and the wavefront, over all instruction sets here.
void check_equal(const Scene& scene, const CameraSettings& camera, RenderOptions options, const std::string& name) {
  options.camera = camera;
  const auto accelerator = make_accelerator("bvh", scene.geometry);
  const auto film_of = [&](IntegratorKind kind, std::optional<Isa> isa, RayCounts& rays) {
    options.integrator.kind = kind;
    options.integrator.isa = isa;
    RenderSession session(scene, *accelerator, options);
    session.run();
    rays = session.stats().rays;
    return session.snapshot();
  };
  RayCounts expected_rays;
  const Film expected = film_of(IntegratorKind::reference, {}, expected_rays);
  for (const Isa isa : kCompiledIsas) {
    if (!isa_supported(isa)) continue;
    INFO(name << ", " << isa_name(isa));
    RayCounts rays;
    CHECK(different_pixels(film_of(IntegratorKind::path, isa, rays), expected) == 0);
    CHECK(rays.scattered == expected_rays.scattered);
    CHECK(rays.shadow == expected_rays.shadow);
  }
}

/// All that shading knows: each material, textures, bent normals, emitters of every kind, more than fit a LightTable,
/// a picture for a sky, a lens.
SeenScene scene_with_everything() {
  SeenScene scene = lit_room();
  add_quad(scene, {-1, -0.99f, 0.4f}, {2, 0, 0}, {0, 0.1f, -0.3f},
           lambertian(picture(scene, 4, 4, [](int x, int y) { return Rgb(0.2f * x, 0.2f * y, 0.5f); })));
  add_quad(scene, {-0.9f, -0.5f, -0.9f}, {0.4f, 0, 0}, {0, 0.4f, 0}, metal(checker(0.1f, Rgb(0.9f), Rgb(0.2f)), 0.3f));
  add_smooth_sphere(scene, {0.4f, 0.2f, -0.4f}, 0.3f, 5, lambertian(grey(0.7f)));
  add_smooth_sphere(scene, {-0.4f, 0.3f, -0.4f}, 0.2f, 4, metal(grey(0.8f), 0.2f));
  add_smooth_sphere(scene, {0.0f, 0.1f, 0.2f}, 0.15f, 4, glass());
  add_sphere(scene, {0.6f, 0.6f, 0.3f}, 0.1f, light(grey(4.0f)));
  add_quad(scene, {-0.98f, -0.9f, -0.9f}, {0, 1.2f, 0}, {0, 0, 1.5f}, metal(grey(0.9f), 0.0f));
  add_quad(scene, {0.98f, -0.9f, -0.9f}, {0, 0, 1.5f}, {0, 1.2f, 0}, metal(checker(0.2f, Rgb(0.9f), Rgb(0.6f)), 0.0f));
  add_quad(scene, {-0.9f, 0.2f, -0.5f}, {0, 0, 0.3f}, {0, 0.3f, 0},
           light(picture(scene, 2, 2, [](int x, int y) { return Rgb(1.0f + x, 2.0f, 1.0f + 3.0f * y); })));
  for (int i = 0; i < 20; ++i)
    add_triangle(scene,
                 {{-0.9f + 0.09f * i, 0.9f, 0.0f}, {-0.85f + 0.09f * i, 0.9f, 0.0f}, {-0.9f + 0.09f * i, 0.9f, 0.05f}},
                 light(grey(0.5f + i)));
  set_sky(scene, 8, 4, [](int x, int y) { return Rgb(0.1f * x, 0.2f, 0.3f * y); });
  scene.camera.defocus_angle = 1.0f;
  return scene;
}

/// A mirror that shows a lamp and a picture of the sky.
SeenScene mirror_under_the_sky() {
  SeenScene scene;
  add_quad(scene, {-3, 0, -3}, {0, 0, 6}, {6, 0, 0}, lambertian(grey(0.7f)));
  add_quad(scene, {-2, 0, -1}, {4, 0, 0}, {0, 2, 0}, metal(grey(0.9f), 0.0f));
  add_quad(scene, {-0.5f, 1.5f, 0.5f}, {1, 0, 0}, {0, 0, 0.5f}, light(grey(4.0f)));
  set_sky(scene, 8, 4, [](int x, int y) { return Rgb(0.1f * x, 0.2f, 0.3f * y); });
  look(scene, {0, 1.0f, 3.0f}, {0, 0.3f, 0}, 60.0f);
  return scene;
}

}  // namespace

TEST_CASE("the reference integrator gives the wavefront's bits on every shipped scene", "[agreement][reference]") {
  for (const char* name : {"cornell", "one-weekend", "mirror-room", "dragon", "bunny", "globe", "forest", "lamps",
                           "caustics", "kaleidoscope"}) {
    const auto file = shipped_scene(name);
    if (!file) continue;
    const LoadedScene loaded = load_scene(*file);
    check_equal(loaded.scene, loaded.camera, render_options(40, 30, 8, loaded.scene.render.max_depth), name);
  }
}

TEST_CASE("the reference integrator gives the wavefront's bits whatever a scene has", "[agreement][reference]") {
  const SeenScene everything = scene_with_everything(), room = lit_room();
  RenderOptions options = render_options(40, 30, 24, 12);
  check_equal(everything, everything.camera, options, "everything");
  const SeenScene mirror = mirror_under_the_sky();
  check_equal(mirror, mirror.camera, options, "a mirror under the sky");
  options.sampler = SamplerKind::independent;
  options.seed = 7;
  check_equal(everything, everything.camera, options, "independent samples");
  options.integrator.ray_offset = RayOffset::book;
  check_equal(everything, everything.camera, options, "book offset");
  check_equal(room, room.camera, options, "few lights");
}
