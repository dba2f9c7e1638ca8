#pragma once
#include "fuzz.hpp"
#include "raylab/image/image_file.hpp"

namespace raylab::fuzz {

/// What an input may name: a.obj, a.mtl, a.png and a.exr.
inline void write_companions() {
  static const bool written = [] {
    write("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\n");
    write("a.mtl", "newmtl a\nmap_Kd a.png\nnewmtl b\nKe 1 1 1\n");
    const Image image(2, 2);
    write_png(folder() / "a.png", image);
    write_exr(folder() / "a.exr", image);
    return true;
  }();
  static_cast<void>(written);
}

}  // namespace raylab::fuzz
