// PLY files, with pictures that they may name.
#include "companions.hpp"
#include "io/ply_file.hpp"
#include "mesh_check.hpp"

using namespace raylab;

RAYLAB_FUZZ(text) {
  fuzz::write_companions();
  const auto file = fuzz::write("fuzzed.ply", text);
  fuzz::read_or_tell([&] {
    MaterialLibrary library;
    fuzz::check_mesh(read_ply_into(library, file, {}).mesh);
  });
}
