// What --set says, one assignment a line, on top of a small scene.
#include "companions.hpp"
#include "raylab/io/scene_file.hpp"

using namespace raylab;

RAYLAB_FUZZ(text) {
  fuzz::write_companions();
  static const auto file = fuzz::write("scene.toml", R"([camera]
look_from = [0, 0, 5]
[render]
width = 16
[background]
color = [1, 1, 1]
[material.grey]
type = "lambertian"
albedo = [0.5, 0.5, 0.5]
[[mesh]]
obj = "a.obj"
[[sphere]]
center = [0, 0, 0]
radius = 1
material = "grey"
)");
  LoadOptions options;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    options.overrides.emplace_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  fuzz::read_or_tell([&] { load_scene(file, options); });
}
