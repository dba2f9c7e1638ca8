// What the statements of an MTL file mean: illum 3 is metal (Ks, fuzz = 1 - Ns / 1000), illum 6 a dielectric (Ni),
// and all else a light if Ke is not 0, or lambertian (Kd, or map_Kd in its place).
#include <algorithm>

#include "material_library.hpp"
#include "message_text.hpp"

namespace raylab {

/// Albedos beyond 1 would make light out of nothing, but exporters write them: they are clamped.
Texture MaterialLibrary::mtl_color(const MtlMaterial& source, const std::optional<Rgb>& color, const Rgb& otherwise) {
  const Rgb given = color.value_or(otherwise);
  const Rgb albedo = glm::min(given, Rgb(1.0f));
  if (albedo != given) {
    warnings.push_back(source.location + ": material " + in_quotes(source.name) + " has albedo " + color_text(given) +
                       ", clamped to 1");
  }
  return Texture::solid_color(albedo);
}

Texture MaterialLibrary::mtl_texture(const MtlMaterial& source, const std::filesystem::path& folder) {
  const auto file = named_files.find(folder, source.map_kd, "texture", source.map_kd_place, warnings);
  if (!file) {
    warnings.push_back(source.map_kd_place + ": texture " + in_quotes(source.map_kd) + " of material " +
                       in_quotes(source.name) + " is missing: magenta in its place");
    return Texture::solid_color(Rgb(1.0f, 0.0f, 1.0f));
  }
  Texture texture;
  texture.kind = Texture::Kind::image;
  texture.image = textures.load(*file, source.map_kd);
  check_albedo(textures.images()[texture.image], source.map_kd_place);
  return texture;
}

Material MaterialLibrary::from_mtl(const MtlMaterial& source, const std::filesystem::path& folder) {
  const auto warn = [&](const std::string& message) {
    warnings.push_back(source.location + ": material " + in_quotes(source.name) + " " + message);
  };
  const bool emits = source.ke && !is_black(*source.ke);
  const int illum = source.illum.value_or(2);
  if (illum > 2 && illum != 3 && illum != 6) {
    warn("has illum " + std::to_string(illum) + ", which is not understood: read as illum 2");
  }
  if (emits && (illum == 3 || illum == 6)) {
    warn("has illum " + std::to_string(illum) + ": its Ke " + color_text(*source.ke) + " is left out");
  }
  if (!source.map_kd.empty() && (emits || illum == 3 || illum == 6)) {
    warn("is not lambertian: its map_Kd " + in_quotes(source.map_kd) + " is left out");
  }

  Material material;
  material.name = source.name;
  if (illum == 3) {
    material.kind = Material::Kind::metal;
    material.color = mtl_color(source, source.ks, Rgb(1.0f));
    const float ns = source.ns.value_or(1000.0f);
    if (ns < 0.0f || ns > 1000.0f) warn("has Ns " + number_text(ns) + ", clamped to 0 ... 1000");
    material.fuzz = static_cast<float>(1.0 - std::clamp(double{ns}, 0.0, 1000.0) / 1000.0);
  } else if (illum == 6) {
    material.kind = Material::Kind::dielectric;
    material.index = source.ni.value_or(material.index);
  } else if (emits) {
    material.kind = Material::Kind::diffuse_light;
    material.color = Texture::solid_color(*source.ke);
  } else if (!source.map_kd.empty()) {
    material.color = mtl_texture(source, folder);
  } else {
    material.color = mtl_color(source, source.kd, Rgb(0.5f));
  }
  return material;
}

}  // namespace raylab
