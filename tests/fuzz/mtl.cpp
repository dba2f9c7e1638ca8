// MTL files, of which the materials a to e are used.
#include "companions.hpp"
#include "raylab/io/obj_file.hpp"

using namespace raylab;

RAYLAB_FUZZ(text) {
  fuzz::write_companions();
  static const auto obj = fuzz::write("uses.obj",
                                      "mtllib fuzzed.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\nusemtl b\n"
                                      "f 1 2 3\nusemtl c\nf 1 2 3\nusemtl d\nf 1 2 3\nusemtl e\nf 1 2 3\n");
  fuzz::write("fuzzed.mtl", text);
  fuzz::read_or_tell([&] { read_obj(obj); });
}
