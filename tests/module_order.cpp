// Which module may include which: the order that keeps accelerators ignorant of materials and scenes of accelerators.
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "catch.hpp"

namespace {

namespace fs = std::filesystem;

/// Modules that each module may include beside itself; a program may include every one.
const std::map<std::string, std::set<std::string>> kMayInclude = {
    {"core", {}},
    {"geometry", {"core"}},
    {"accel", {"core", "geometry"}},
    {"image", {"core"}},
    {"scene", {"core", "geometry", "image"}},
    {"io", {"core", "geometry", "image", "scene"}},
    {"render", {"core", "geometry", "image", "scene", "accel"}},
    {"measure", {"core", "geometry", "image", "scene", "accel", "render", "io"}},
    {"apps", {"core"}},
};

/// What else a folder may include from a folder or file outside it that is neither public nor in the same module.
const std::set<std::pair<std::string, std::string>> kMayReach = {
    {"bench/program/", "src/geometry/primitive_test.hpp"},  // the ladder's trees call the library's own tests
    {"bench/program/", "src/accel/embree/api.hpp"},         // the bare loops over Embree ask its own scenes
    {"apps/preview/", "apps/render/options.hpp"},           // the preview takes the options of raylab-render
};

/// Headers of libraries that a few places alone may include, by the start of their names.
struct Library {
  const char* header;
  std::vector<const char*> places;  ///< starts of paths from the top
};
const Library kLibraries[] = {
    {"embree", {"src/accel/embree", "bench/program/embree_bare"}},
    {"tbb/", {"src/core/"}},
    {"oneapi/tbb", {"src/core/"}},
    {"GLFW/", {"apps/preview/"}},
    {"GL/", {"apps/preview/"}},
    {"epoxy/", {"apps/preview/"}},
    {"imgui", {"apps/preview/"}},
    {"assimp/", {"apps/import/"}},
    {"tiny_obj_loader", {"src/io/"}},
    {"tiny_gltf", {"src/io/"}},
    {"toml++/", {"src/io/"}},
    {"OpenEXR/", {"src/image/"}},
    {"Imf", {"src/image/"}},
    {"png.h", {"src/image/"}},
    {"jpeglib.h", {"src/image/"}},
    // Parallel.cpp sets how every thread rounds; all else is written for the vectors of core/simd.
    {"immintrin.h", {"src/core/simd/", "src/core/parallel.cpp"}},
    {"xmmintrin.h", {"src/core/simd/", "src/core/parallel.cpp"}},
    {"emmintrin.h", {"src/core/simd/", "src/core/parallel.cpp"}},
    {"nmmintrin.h", {"src/core/simd/", "src/core/parallel.cpp"}},
    {"x86intrin.h", {"src/core/simd/", "src/core/parallel.cpp"}},
    {"arm_neon.h", {"src/core/simd/", "src/core/parallel.cpp"}},
};

struct Include {
  std::string file;  ///< from the top
  int line;
  std::string header;
};

std::vector<Include> includes_under(const std::string& folder) {
  std::vector<Include> found;
  const fs::path top(RAYLAB_SOURCE_DIR);
  const std::regex pattern("^\\s*#\\s*include\\s*[<\"]([^>\"]+)[>\"]");
  for (const auto& entry : fs::recursive_directory_iterator(top / folder)) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".hpp" && extension != ".cpp" && extension != ".h") continue;
    std::ifstream file(entry.path());
    std::string line;
    for (int number = 1; std::getline(file, line); ++number) {
      std::smatch match;
      if (std::regex_search(line, match, pattern)) {
        found.push_back({fs::relative(entry.path(), top).generic_string(), number, match[1].str()});
      }
    }
  }
  return found;
}

/// The file of Raylab's, from the top, that an include names, or its own name if that is a library's.
std::string resolved(const Include& include) {
  const fs::path folders[] = {fs::path(include.file).parent_path(), "src", "include", "apps/preview", "apps/render"};
  for (const fs::path& folder : folders) {
    const fs::path path = (folder / include.header).lexically_normal();
    if (fs::is_regular_file(RAYLAB_SOURCE_DIR / path)) return path.generic_string();
  }
  return include.header;
}

bool starts(const std::string& text, const std::string& start) { return text.compare(0, start.size(), start) == 0; }

/// The module of include/raylab/MODULE/x.hpp or src/MODULE/x.cpp; the folder, such as apps/render/, of a program's
/// file.
std::string module_of(const std::string& path) {
  for (const std::string start : {"include/raylab/", "src/"}) {
    if (starts(path, start)) return path.substr(start.size(), path.find('/', start.size()) - start.size());
  }
  if (starts(path, "apps/") || starts(path, "bench/")) return path.substr(0, path.find('/', path.find('/') + 1) + 1);
  return {};
}

/// What is wrong with an include, or nothing.
std::string complaint(const Include& include) {
  const std::string header = resolved(include);
  const std::string from = module_of(include.file);
  const std::string to = module_of(header);
  const std::string where = include.file + ":" + std::to_string(include.line) + ": " + include.header;
  if (!to.empty() && !starts(header, "include/") && kMayReach.count({from, header}) == 0) {
    // A private header: of a program, or of the library's sources.
    const bool both_in_library = starts(include.file, "src/") && starts(header, "src/");
    if (to != from && !both_in_library) return where + ": is private to " + to;
    if (starts(include.file, "include/")) return where + ": a public header may not include a private one";
  }
  if (const auto allowed = kMayInclude.find(from); allowed != kMayInclude.end() && !to.empty()) {
    if (to != from && allowed->second.count(to) == 0) return where + ": " + from + " may not include " + to;
  }
  for (const Library& library : kLibraries) {
    if (header != include.header || !starts(header, library.header)) continue;
    bool welcome = false;
    for (const std::string place : library.places) welcome |= starts(include.file, place);
    if (!welcome) return where + ": belongs elsewhere";
  }
  return {};
}

}  // namespace

TEST_CASE("no module includes one that is not below it, and libraries stay in their places", "[unit][layout]") {
  std::size_t seen = 0;
  for (const char* folder : {"include", "src", "apps", "bench"}) {
    for (const Include& include : includes_under(folder)) {
      CHECK(complaint(include) == "");
      ++seen;
    }
  }
  CHECK(seen > 300);
}

TEST_CASE("an include of a module above is seen", "[unit][layout]") {
  CHECK(complaint({"src/accel/list.cpp", 3, "raylab/scene/material.hpp"}) ==
        "src/accel/list.cpp:3: raylab/scene/material.hpp: accel may not include scene");
  CHECK(complaint({"include/raylab/scene/scene.hpp", 9, "raylab/accel/accelerator.hpp"}) != "");
  CHECK(complaint({"src/accel/list.cpp", 3, "raylab/geometry/intersect.hpp"}) == "");
}

TEST_CASE("an include of a module above is seen through a private or relative path", "[unit][layout]") {
  CHECK(complaint({"src/core/simd/lanes.hpp", 3, "geometry/triangle_test.hpp"}) ==
        "src/core/simd/lanes.hpp:3: geometry/triangle_test.hpp: core may not include geometry");
  CHECK(complaint({"src/accel/bvh/bvh.cpp", 3, "../../scene/surface_lanes.hpp"}) != "");
  CHECK(complaint({"src/accel/bvh/bvh.cpp", 3, "../backends.hpp"}) == "");
  CHECK(complaint({"src/accel/bvh/traverse/kernel_avx2.cpp", 3, "kernel.hpp"}) == "");
  CHECK(complaint({"src/render/wavefront.hpp", 3, "core/simd/vector.hpp"}) == "");
}

TEST_CASE("an include of a header that is private to another part is seen", "[unit][layout]") {
  CHECK(complaint({"include/raylab/geometry/intersect.hpp", 3, "geometry/triangle_test.hpp"}) != "");
  CHECK(complaint({"bench/program/ladder.cpp", 3, "render/bsdf.hpp"}) ==
        "bench/program/ladder.cpp:3: render/bsdf.hpp: is private to render");
  CHECK(complaint({"bench/program/ladder.cpp", 3, "../../src/render/bsdf.hpp"}) != "");
  CHECK(complaint({"bench/program/ladder.cpp", 3, "geometry/primitive_test.hpp"}) == "");
  CHECK(complaint({"apps/image/main.cpp", 3, "geometry/primitive_test.hpp"}) != "");
  CHECK(complaint({"apps/image/main.cpp", 3, "../preview/keys.hpp"}) != "");
  CHECK(complaint({"apps/preview/preview_options.hpp", 3, "options.hpp"}) == "");
  CHECK(complaint({"src/apps/program.cpp", 3, "../../apps/render/options.hpp"}) != "");
  CHECK(complaint({"apps/image/main.cpp", 3, "raylab/measure/shapes.hpp"}) == "");
}

TEST_CASE("an include of a library outside its place is seen", "[unit][layout]") {
  for (const char* header : {"tbb/parallel_for.h", "oneapi/tbb/info.h", "embree4/rtcore.h", "GLFW/glfw3.h",
                             "GL/glcorearb.h", "imgui.h", "tiny_obj_loader.h", "toml++/toml.h", "OpenEXR/ImfHeader.h",
                             "ImfTestFile.h", "immintrin.h", "xmmintrin.h", "nmmintrin.h", "arm_neon.h"}) {
    CHECK(complaint({"src/render/tiles.cpp", 3, header}) ==
          std::string("src/render/tiles.cpp:3: ") + header + ": belongs elsewhere");
  }
  CHECK(complaint({"src/accel/bvh/bvh.cpp", 3, "embree4/rtcore.h"}) != "");
  CHECK(complaint({"src/accel/embree/api.hpp", 3, "embree4/rtcore.h"}) == "");
  CHECK(complaint({"src/image/exr_file.cpp", 3, "OpenEXR/ImfHeader.h"}) == "");
  CHECK(complaint({"src/core/simd/registers.hpp", 3, "immintrin.h"}) == "");
}

TEST_CASE("what makes a picture calls no trigonometric function of the library's", "[unit][layout]") {
  // Libraries differ in the last bit, and pictures must not. The camera's two are of doubles, once a picture; the
  // tiles' is about the order of work, which changes no result; framing finds a camera, whose numbers are what is
  // rendered.
  const std::set<std::string> exempt = {"src/scene/camera.cpp", "src/render/tiles.cpp",
                                        "include/raylab/scene/framing.hpp"};
  const std::regex call("std::(sin|cos|tan|asin|acos|atan|atan2)\\(");
  const fs::path root = RAYLAB_SOURCE_DIR;
  int files = 0;
  for (const char* folder : {"src/geometry", "src/accel", "src/scene", "src/render", "include/raylab"}) {
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      const std::string name = fs::relative(entry.path(), root).generic_string();
      if (!entry.is_regular_file() || exempt.count(name) != 0) continue;
      std::ifstream file(entry.path());
      const std::string text{std::istreambuf_iterator<char>(file), {}};
      INFO(name);
      CHECK_FALSE(std::regex_search(text, call));
      ++files;
    }
  }
  CHECK(files > 50);
}
