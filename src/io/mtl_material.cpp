// What the statements of an MTL file mean in a plain material: illum 3 is metal (Ks, fuzz = 1 - Ns / 1000), illum 6 a
// dielectric (Ni), and all else a light if Ke is not 0, or lambertian (Kd, or map_Kd in its place). What exporters add
// to it, such as d, Pr and Pm, makes a material that mtl_exported.cpp reads.
#include <algorithm>
#include <array>

#include "file_kind.hpp"
#include "material_library.hpp"
#include "message_text.hpp"
#include "raylab/image/image_file.hpp"

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

/// Models name pictures of many kinds. One that is named or made as a kind that is read, but damaged, is an error
/// later.
std::optional<std::filesystem::path> MaterialLibrary::mtl_texture_file(const MtlMap& map,
                                                                       const std::filesystem::path& folder,
                                                                       const std::string& otherwise) {
  auto file = named_files.find(folder, map.file, "texture", map.place, warnings);
  if (file) {
    constexpr std::array read{".png", ".jpg", ".jpeg", ".exr", "a PNG picture", "a JPEG picture", "an OpenEXR picture"};
    const auto is_read = [&](const std::string& kind) {
      return std::find(read.begin(), read.end(), kind) != read.end();
    };
    if (is_read(lowercase_ending(*file)) || is_read(content_of(*file).words)) return file;
  }
  warnings.push_back(map.place + ": texture " + in_quotes(map.file) +
                     (file ? " is neither PNG nor JPEG nor OpenEXR" : " is missing") + otherwise);
  return std::nullopt;
}

Texture MaterialLibrary::mtl_texture(const MtlMaterial& source, const MtlMap& map,
                                     const std::filesystem::path& folder) {
  const auto file = mtl_texture_file(map, folder, ": magenta in its place, in material " + in_quotes(source.name));
  if (!file) return Texture::solid_color(Rgb(1.0f, 0.0f, 1.0f));
  Texture texture;
  texture.kind = Texture::Kind::image;
  texture.image = textures.load(*file, map.file);
  check_albedo(textures.images()[texture.image], map.place);
  return texture;
}

Texture MaterialLibrary::mtl_color_or_texture(const MtlMaterial& source, const std::optional<Rgb>& color,
                                              const Rgb& otherwise, const MtlMap& map,
                                              const std::filesystem::path& folder) {
  return map ? mtl_texture(source, map, folder) : mtl_color(source, color, otherwise);
}

float MaterialLibrary::mtl_fuzz(const MtlMaterial& source) {
  const float ns = source.ns.value_or(1000.0f);
  if (ns < 0.0f || ns > 1000.0f) {
    warnings.push_back(source.location + ": material " + in_quotes(source.name) + " has Ns " + number_text(ns) +
                       ", clamped to 0 ... 1000");
  }
  return static_cast<float>(1.0 - std::clamp(double{ns}, 0.0, 1000.0) / 1000.0);
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
  if (source.map_kd && (emits || illum == 3 || illum == 6)) {
    warn("is not lambertian: its map_Kd " + in_quotes(source.map_kd.file) + " is left out");
  }

  Material material;
  material.name = source.name;
  if (illum == 3) {
    material.kind = Material::Kind::metal;
    material.color = mtl_color(source, source.ks, Rgb(1.0f));
    material.fuzz = mtl_fuzz(source);
  } else if (illum == 6) {
    material.kind = Material::Kind::dielectric;
    material.index = source.ni.value_or(material.index);
  } else if (emits) {
    material.kind = Material::Kind::diffuse_light;
    material.color = Texture::solid_color(*source.ke);
  } else {
    material.color = mtl_color_or_texture(source, source.kd, Rgb(0.5f), source.map_kd, folder);
  }
  return material;
}

}  // namespace raylab
