// OBJ files, with an MTL file and pictures that they may name.
#include "companions.hpp"
#include "raylab/io/obj_file.hpp"

using namespace raylab;

RAYLAB_FUZZ(text) {
  fuzz::write_companions();
  const auto file = fuzz::write("fuzzed.obj", text);
  fuzz::read_or_tell([&] { read_obj(file); });
}
