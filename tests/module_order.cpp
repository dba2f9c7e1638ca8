// Which module may include which: the order that keeps accelerators ignorant of materials and scenes of accelerators.
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "catch.hpp"

namespace {

namespace fs = std::filesystem;

/// Modules that each module may include beside itself.
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

/// Headers of libraries that one place alone may include, by the start of their names.
struct Library {
  const char* header;
  std::vector<const char*> places;  ///< starts of paths from the top
};
const Library kLibraries[] = {
    {"embree", {"src/accel/embree"}},
    {"tbb/", {"src/core/"}},
    {"oneapi/tbb", {"src/core/"}},
    {"GLFW/", {"apps/preview/"}},
    {"GL/", {"apps/preview/"}},
    {"epoxy/", {"apps/preview/"}},
    {"imgui", {"apps/preview/"}},
    {"tiny_obj_loader", {"src/io/"}},
    {"toml++/", {"src/io/"}},
    {"ImfHeader", {"src/image/"}},
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

/// The module of a path such as include/raylab/MODULE/x.hpp, src/MODULE/x.cpp or raylab/MODULE/x.hpp.
std::string module_of(const std::string& path) {
  for (const std::string start : {"include/raylab/", "src/", "raylab/"}) {
    if (path.compare(0, start.size(), start) == 0) {
      return path.substr(start.size(), path.find('/', start.size()) - start.size());
    }
  }
  return {};
}

/// What is wrong with an include, or nothing.
std::string complaint(const Include& include) {
  const std::string from = module_of(include.file);
  const std::string to = module_of(include.header);
  const std::string where = include.file + ":" + std::to_string(include.line) + ": " + include.header;
  if (const auto allowed = kMayInclude.find(from); allowed != kMayInclude.end() && !to.empty()) {
    if (to != from && allowed->second.count(to) == 0) return where + ": " + from + " may not include " + to;
  }
  for (const Library& library : kLibraries) {
    if (include.header.compare(0, std::string(library.header).size(), library.header) != 0) continue;
    bool welcome = false;
    for (const std::string place : library.places) welcome |= include.file.compare(0, place.size(), place) == 0;
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
  CHECK(complaint({"src/render/tiles.cpp", 3, "tbb/parallel_for.h"}) != "");
  CHECK(complaint({"src/accel/bvh/bvh.cpp", 3, "embree4/rtcore.h"}) != "");
}

TEST_CASE("what makes a picture calls no trigonometric function of the library's", "[unit][layout]") {
  // Libraries differ in the last bit, and pictures must not. The camera's two are of doubles, once a picture; the
  // tiles' is about the order of work, which changes no result.
  const std::set<std::string> exempt = {"src/scene/camera.cpp", "src/render/tiles.cpp"};
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
