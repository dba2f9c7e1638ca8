// glTF files, with a buffer and pictures that they may name.
#include "companions.hpp"
#include "io/gltf_file.hpp"

using namespace raylab;

RAYLAB_FUZZ(bytes) {
  fuzz::write_companions();
  static const auto buffer = fuzz::write("a.bin", std::string(1024, '\x3f'));
  const auto file = fuzz::write("fuzzed.gltf", bytes);
  fuzz::read_or_tell([&] {
    MaterialLibrary library;
    read_gltf_into(library, file, {});
  });
}
