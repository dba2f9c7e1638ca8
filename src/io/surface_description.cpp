#include "surface_description.hpp"

#include <algorithm>
#include <cmath>

#include "message_text.hpp"

namespace raylab {
namespace {

bool is_solid(const Texture& texture, const Rgb& color) {
  return texture.kind == Texture::Kind::solid && texture.a == color;
}

}  // namespace

float fuzz_of_roughness(float roughness) {
  // Half of the normals of GGX with width w lie within an angle of tangent w of its axis (Walter et al. 2007, equation
  // 35), and the mirror direction turns by twice that angle, whose sine is 2 w / (1 + w²). Half of the points s of a
  // unit sphere lie within sin 60° of the axis along r, so that half of the directions r + f s turn by a sine of up to
  // f sin 60°, where f is small.
  constexpr double kSineOf60Degrees = 0.86602540378443865;
  const double width = static_cast<double>(roughness) * static_cast<double>(roughness);
  return static_cast<float>(std::min(1.0, 2.0 * width / (1.0 + width * width) / kSineOf60Degrees));
}

Material nearest_material(const SurfaceDescription& surface, std::vector<std::string>& left_out) {
  const bool emits = !is_solid(surface.emission, Rgb(0.0f));
  const auto part = [&](const std::string& what, float value) {
    // In thousandths, as 1 - 0.9 is 0.100000024.
    left_out.push_back(what + number_text(std::round(1000.0f * value) / 1000.0f) + ")");
  };
  Material material;
  material.name = surface.name;
  if (emits) {
    material.kind = Material::Kind::diffuse_light;
    material.color = surface.emission;
    if (!is_solid(surface.base_color, Rgb(0.0f))) left_out.emplace_back("what it reflects");
    return material;
  }
  if (surface.is_metal()) {
    material.kind = Material::Kind::metal;
    material.color = surface.base_color;
    material.fuzz = fuzz_of_roughness(surface.roughness);
    if (surface.metallic < 1.0f) part("its part that is no metal (", 1.0f - surface.metallic);
    return material;
  }
  if (surface.is_clear()) {
    material.kind = Material::Kind::dielectric;
    material.index = surface.index;
    if (!is_solid(surface.base_color, Rgb(1.0f))) left_out.emplace_back("its tint");
    if (surface.roughness > 0.0f) part("its roughness (", surface.roughness);
    if (surface.transmission < 1.0f) part("its part that is not clear (", 1.0f - surface.transmission);
    return material;
  }
  material.color = surface.base_color;
  if (surface.metallic > 0.0f) part("its metallic part (", surface.metallic);
  if (surface.transmission > 0.0f) part("its transmission (", surface.transmission);
  if (surface.roughness < 1.0f) part("its gloss (roughness ", surface.roughness);
  return material;
}

}  // namespace raylab
