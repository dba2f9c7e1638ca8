#include "model_scene.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "message_text.hpp"
#include "raylab/core/text.hpp"
#include "raylab/scene/framing.hpp"

namespace raylab {
namespace {

constexpr double kFieldOfView = 30.0;  // degrees, vertical

/// The file's point with +y up.
dvec3 upright(const vec3& p, char up) {
  const dvec3 v(p);
  if (up == 'x') return {-v.y, v.x, v.z};
  return up == 'z' ? dvec3(v.x, v.z, -v.y) : v;
}

/// Numbers that need be no more exact than a thousandth of the model.
class RoundedNumbers {
 public:
  explicit RoundedNumbers(double size) : step_(std::pow(10.0, std::floor(std::log10(size)) - 3.0)) {}

  std::string operator()(double value) const {
    return number_text(static_cast<float>(std::round(value / step_) * step_));
  }
  std::string operator()(const dvec3& v) const {
    return format("[%s, %s, %s]", (*this)(v.x).c_str(), (*this)(v.y).c_str(), (*this)(v.z).c_str());
  }

 private:
  double step_;
};

const dvec3 kBack = glm::normalize(dvec3(0.6, 0.42, 1.0));  // from the model to the eye

Framing framing_of(const TriangleMesh& mesh, char up, const ModelOptions& options) {
  const auto for_each_point = [&](const auto& visit) {
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      if (!is_valid_triangle(mesh, i)) continue;
      for (int c = 0; c < 3; ++c) visit(upright(mesh.positions[mesh.triangles[i][c]], up), 0.0);
    }
  };
  return frame_balls(for_each_point, kBack, dvec3(0.0, 1.0, 0.0), kFieldOfView, options.width, options.height);
}

/// How brightly the model's own lights light it: the light that they give off over what a sphere around the model
/// receives where the radiance is 1 all around.
double own_light(const MeshWithMaterials& model, const MaterialLibrary& library, double radius) {
  double power = 0.0;
  for (std::uint32_t i = 0; i < model.mesh.triangles.size(); ++i) {
    if (library.materials.empty() || !is_valid_triangle(model.mesh, i)) continue;
    const Material& material = library.materials[model.materials.of(i)];
    if (material.kind != Material::Kind::diffuse_light) continue;
    const Triangle t = triangle_corners(model.mesh, i);
    const double area = 0.5 * glm::length(glm::cross(dvec3(t.p1) - dvec3(t.p0), dvec3(t.p2) - dvec3(t.p0)));
    power += area * static_cast<double>(mean_luminance(material.color, library.textures.images()));
  }
  return power / (4.0 * 3.14159265358979323846 * radius * radius);
}

/// As a TOML string, whose escapes are JSON's but for the one that JSON leaves out. What is not UTF-8 is replaced.
std::string in_toml(const std::string& text) {
  using nlohmann::json;
  std::string quoted = json(text).dump(-1, ' ', false, json::error_handler_t::replace);
  for (std::size_t at = 0; (at = quoted.find('\x7f', at)) != std::string::npos;) quoted.replace(at, 1, "\\u007F");
  return quoted;
}

}  // namespace

std::string model_scene_text(const MeshWithMaterials& model, const MaterialLibrary& library, FileKind kind,
                             const std::string& name, const ModelOptions& options) {
  const char up = options.up != '\0' ? options.up : kind == FileKind::stl ? 'z' : 'y';
  const Framing view = framing_of(model.mesh, up, options);
  const RoundedNumbers number(view.radius);
  const dvec3 eye = view.center + view.distance * kBack;

  std::string text = "version = 1\n\n[camera]\nlook_from = " + number(eye) + "\nlook_at = " + number(view.center) +
                     "\nup = [0, 1, 0]\nvfov = " + number_text(kFieldOfView) +
                     "\n\n[render]\nwidth = " + std::to_string(options.width) +
                     "\nheight = " + std::to_string(options.height) + "\nsamples_per_pixel = 16\nmax_depth = 12\n\n";
  text += "[[mesh]]\nfile = " + in_toml(name) + "\n";
  if (up != 'y') text += std::string("up = \"") + up + "\"  # the file's axis that points up\n";
  if (model.mesh.normals.empty() && kind != FileKind::gltf) {
    text += "smooth = 30  # degrees: the file has no normals; faces that meet at less are shaded as one surface\n";
  }
  // A room's lamps light it (the Cornell box has 0.06); a screen or a lit lamp does not show the model around it.
  constexpr double kEnough = 0.04;
  const double own = own_light(model, library, view.radius);
  if (own < kEnough) {
    // The sky alone shows a white surface at 0.5, and the key light adds 0.8 where it falls straight on.
    const dvec3 direction = glm::normalize(-0.6 * view.right + 0.9 * view.up + 0.5 * kBack);
    const double distance = 6.0 * view.radius;
    text += "\n[background]  # a soft sky, as the model has " + std::string(own > 0.0 ? "little" : "no") +
            " light of its own\nbottom = [0.35, 0.35, 0.37]\ntop = [0.45, 0.55, "
            "0.7]\n";
    text += "\n[material.key-light]\ntype = \"diffuse_light\"\nradiance = [45, 42, 38]\n";
    text +=
        "\n[[sphere]]  # a key light, from the left and above\ncenter = " + number(view.center + distance * direction) +
        "\nradius = " + number(0.14 * distance) + "\nmaterial = \"key-light\"\n";
  }
  if (options.ground) {
    const double radius = 1000.0 * view.radius;
    text += "\n[material.ground]\ntype = \"lambertian\"\nalbedo = [0.5, 0.5, 0.5]\n";
    text += "\n[[sphere]]  # the ground, as in the One Weekend books\ncenter = " +
            number({view.center.x, view.lower.y - radius, view.center.z}) + "\nradius = " + number(radius) +
            "\nmaterial = \"ground\"\n";
  }
  return text;
}

}  // namespace raylab
