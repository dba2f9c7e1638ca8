// STL files.
#include "fuzz.hpp"
#include "io/stl_file.hpp"
#include "mesh_check.hpp"

using namespace raylab;

RAYLAB_FUZZ(text) {
  const auto file = fuzz::write("fuzzed.stl", text);
  fuzz::read_or_tell([&] {
    MaterialLibrary library;
    fuzz::check_mesh(read_stl_into(library, file, {}).mesh);
  });
}
