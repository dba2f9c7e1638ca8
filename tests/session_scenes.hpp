#pragma once
// Scenes and options of the tests of render sessions.
#include <string>

#include "test_scenes.hpp"

namespace raylab::test {

/// A scene that uses most of what there is, so that any state shared between samples would show.
inline SeenScene varied_scene() {
  SeenScene scene = lit_room();
  add_quad(scene, {-1, -0.99f, 0.4f}, {2, 0, 0}, {0, 0.1f, -0.3f},
           lambertian(picture(scene, 4, 4, [](int x, int y) { return Rgb(0.2f * x, 0.2f * y, 0.5f); })));
  scene.camera.defocus_angle = 1.0f;
  return scene;
}

/// A floor under a lamp so bright that some, not all, of its light is more than a float can hold.
inline SeenScene blinding_scene() {
  SeenScene scene;
  add_quad(scene, {-2, 0, -2}, {0, 0, 4}, {4, 0, 0}, lambertian(grey(0.8f)));
  add_quad(scene, {-1, 0.3f, -1}, {2, 0, 0}, {0, 0, 2}, light(grey(3e38f)));
  look(scene, {0, 0.2f, 1.9f}, {0, 0, 0}, 60.0f);
  return scene;
}

inline RenderOptions small_options(const SeenScene& scene, const std::string& sampler) {
  RenderOptions options = render_options(19, 13, 12);
  options.camera = scene.camera;
  options.sampler = parse_sampler(sampler);
  options.seed = 5;
  return options;
}

}  // namespace raylab::test
