// Scene files, with an OBJ file, an MTL file and pictures that they may name.
#include "companions.hpp"
#include "raylab/io/scene_file.hpp"

using namespace raylab;

RAYLAB_FUZZ(text) {
  fuzz::write_companions();
  const auto file = fuzz::write("scene.toml", text);
  fuzz::read_or_tell([&] { load_scene(file); });
}
