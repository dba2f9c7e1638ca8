#include "raylab/render/view_warnings.hpp"

#include <algorithm>

#include "raylab/core/text.hpp"

namespace raylab {
namespace {

struct Seen {
  bool anything = false;
  bool mesh = false;
};

Seen look(const Scene& scene, const Accelerator& accelerator, const RenderOptions& options) {
  constexpr int kMost = 64;
  const Camera camera(options.camera, options.width, options.height);
  const int columns = std::min(options.width, kMost), rows = std::min(options.height, kMost);
  Seen seen;
  for (int row = 0; row < rows && !seen.mesh; ++row) {
    for (int column = 0; column < columns && !seen.mesh; ++column) {
      const float x = (static_cast<float>(column) + 0.5f) / static_cast<float>(columns);
      const float y = (static_cast<float>(row) + 0.5f) / static_cast<float>(rows);
      const Ray ray =
          camera.ray(x * static_cast<float>(options.width), y * static_cast<float>(options.height), vec2(0.5f));
      const auto hit = accelerator.intersect(ray);
      seen.anything = seen.anything || hit;
      seen.mesh = hit && !scene.geometry.is_sphere(hit->geometry);
    }
  }
  return seen;
}

/// Bounds of the triangles that are no lights: a lamp need not be in view.
Bounds bounds_of_shown(const Scene& scene) {
  Bounds bounds;
  for (std::uint32_t m = 0; m < scene.geometry.meshes.size(); ++m) {
    const TriangleMesh& mesh = scene.geometry.meshes[m];
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      const bool emits = scene.materials[scene.mesh_materials[m].of(i)].kind == Material::Kind::diffuse_light;
      if (!emits && is_valid_triangle(mesh, i)) bounds.extend(triangle_bounds(triangle_corners(mesh, i)));
    }
  }
  return bounds;
}

std::string extent(const Bounds& bounds) {
  const auto text = [](const vec3& v) {
    return format("[%.4g, %.4g, %.4g]", static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z));
  };
  return text(bounds.lower) + " to " + text(bounds.upper) + ": camera.look_at = " + text(bounds.center()) +
         " looks there";
}

}  // namespace

std::vector<std::string> view_warnings(const Scene& scene, const Accelerator& accelerator,
                                       const RenderOptions& options) {
  std::vector<std::string> warnings;
  if (!scene_needs(scene).area_lights && scene.environment.is_black()) {
    warnings.emplace_back(
        "the scene has no light, so the picture will be black: a [background] that is not black gives it one, or a "
        "material of type diffuse_light");
  }
  if (scene.geometry.primitive_count() == 0) return warnings;  // which loading has told
  const Seen seen = look(scene, accelerator, options);
  if (!seen.anything) {
    warnings.push_back("the camera sees nothing of the scene, which lies from " + extent(scene.geometry.bounds()));
  } else if (!seen.mesh) {
    const Bounds shown = bounds_of_shown(scene);
    if (!shown.empty()) warnings.push_back("the camera sees no mesh; meshes lie from " + extent(shown));
  }
  return warnings;
}

bool is_black(const Film& film) {
  for (int y = 0; y < film.height(); ++y) {
    for (int x = 0; x < film.width(); ++x) {
      if (!is_black(film.mean(x, y))) return false;
    }
  }
  return true;
}

}  // namespace raylab
