// Writing a camera back into a scene file. A second time, nothing is left to change.
#include "fuzz.hpp"
#include "raylab/io/camera_file.hpp"

using namespace raylab;

RAYLAB_FUZZ(text) {
  CameraSettings camera;
  camera.look_from = vec3(1.0f, -2.5f, 3e7f);
  camera.vfov = 33.0f;
  fuzz::read_or_tell([&] {
    const std::string changed = with_camera(text, "scene.toml", camera);
    if (with_camera(changed, "scene.toml", camera) != changed) std::abort();
  });
}
