// What exporters say of a material beyond the convention of mtl_material.cpp, and the nearest material to it. The
// format leaves much open, and programs write the same statements in several senses: each rule has its reason beside
// it.
#include <algorithm>
#include <cmath>

#include "material_library.hpp"
#include "message_text.hpp"
#include "raylab/image/image.hpp"
#include "raylab/image/image_file.hpp"
#include "surface_description.hpp"

namespace raylab {
namespace {

bool is_grey(const Rgb& c) { return c.r == c.g && c.g == c.b; }
float mean(const Rgb& c) { return (c.r + c.g + c.b) / 3.0f; }

/// Whether the extension for physically based materials is used, as by Blender when asked to.
bool is_physical(const MtlMaterial& m) { return m.pr || m.pm || m.map_pr || m.map_pm; }

/// Models with transparency: with refraction (6, 7), with or without traced reflections (4, 9).
bool has_glass_illum(const MtlMaterial& m) { return m.illum == 4 || m.illum == 6 || m.illum == 7 || m.illum == 9; }

float opacity_of(const MtlMaterial& m) {
  // Where map_d says how opaque the surface is, old exporters wrote d 0.
  if (m.d) return *m.d == 0.0f && m.has_map_d ? 1.0f : *m.d;
  // Tr is 1 - d. d goes first because some write Tr 1 beside d 1, and Tr 1 alone is opaque too: MeshLab writes it so,
  // and what is not to be seen at all is seldom exported.
  return m.tr && *m.tr < 1.0f ? 1.0f - *m.tr : 1.0f;
}

/// How much light goes through.
float transmission_of(const MtlMaterial& m) {
  const float opacity = opacity_of(m);
  float through = 1.0f - opacity;
  if (m.tf) {
    const float filter = mean(glm::min(*m.tf, Rgb(1.0f)));
    if (is_physical(m) && !m.tr) {
      // Blender's transmission. It never writes Tr; 3ds Max and those that follow it write Tf 1 1 1 beside Tr, which is
      // the filter of the format: the colour that light takes on its way through, if it does.
      through = std::max(through, filter);
    } else if (m.illum == 4 && m.ni.value_or(1.0f) == 1.0f && opacity == 1.0f) {
      // Maya gives every material illum 4 and Ni 1, and Tf 1 1 1 to the opaque ones.
      return 1.0f - filter;
    } else if (!m.d && !m.tr && filter < 1.0f) {
      through = filter;  // nothing else says how clear it is, and white is the default
    }
  }
  // Blender marks with 9 whatever is not quite opaque, leaves that fade away too.
  const bool mostly_opaque = opacity > 0.75f && opacity < 1.0f;
  if (!has_glass_illum(m) || (mostly_opaque && (m.illum == 4 || m.illum == 9))) return through;
  return through < 0.5f ? 1.0f : through;
}

/// What a material with illum 3, 5 or 8 reflects like a mirror.
struct Reflection {
  enum class Color { kd, ks, ka };
  Color color = Color::kd;
  float metallic = 0.0f;
  bool is_sharp = false;  ///< Ns is the exponent of highlights alone
};

Reflection reflection_of(const MtlMaterial& m) {
  if (m.illum != 3 && m.illum != 5 && m.illum != 8) return {};
  const bool has_ka = m.ka && !is_black(*m.ka);
  // Traced reflections have the colour Ks by the format. Blender's Ks is a number, 0.5 if untouched, written three
  // times: the strength of a highlight. Its metals have their colour in Kd, and in Ka how metallic they are. Its
  // comment tells its files; where that was cut off, a grey Ks darker than Kd beside an ambient colour does.
  const bool is_kd_brighter = m.map_kd || (m.kd && m.ks && max_component(*m.kd) > max_component(*m.ks));
  const bool looks_like_blender = m.illum == 3 && has_ka && m.ks && !m.map_ks && is_kd_brighter;
  const bool is_blender = (m.writer != MtlWriter::unknown || looks_like_blender) && (!m.ks || is_grey(*m.ks));
  if (!is_blender) {
    const bool has_kd_alone = !m.ks && !m.map_ks && (m.kd || m.map_kd);
    return {has_kd_alone ? Reflection::Color::kd : Reflection::Color::ks, 1.0f, true};
  }
  Reflection result;
  result.metallic = has_ka ? std::min(mean(*m.ka), 1.0f) : 1.0f;
  // Up to 2.79, told by Ni 1 where later ones write 1.45 or 1.5, Ka is the colour of a sharp mirror over a coloured
  // body. If the body is grey the mirror is what is seen; if not, it is the colour that people gave the metal.
  result.is_sharp = m.writer != MtlWriter::blender_with_number && m.ni == 1.0f;
  if (result.is_sharp && has_ka && !m.map_kd && (!m.kd || is_grey(*m.kd))) result.color = Reflection::Color::ka;
  return result;
}

/// Of Blender's Ns = 1000 (1 - roughness)², which others' exponents are near to.
float roughness_of_exponent(float ns) { return 1.0f - std::sqrt(std::clamp(ns, 0.0f, 1000.0f) / 1000.0f); }

/// Of a material without Pr and map_Pr.
float roughness_of(const MtlMaterial& m, const SurfaceDescription& surface, const Reflection& reflection) {
  if (surface.is_metal()) {
    if (reflection.is_sharp) return 0.0f;
    return m.ns ? roughness_of_exponent(*m.ns) : 0.5f;  // Blender's default
  }
  if (surface.is_clear()) return 0.0f;  // Ns is of the highlights, and glass is seldom ground
  return m.ns && m.ks && !is_black(*m.ks) ? roughness_of_exponent(*m.ns) : 1.0f;
}

}  // namespace

const MaterialLibrary::MtlPicture& MaterialLibrary::mtl_picture(const std::filesystem::path& file,
                                                                const std::string& name) {
  const auto [entry, is_new] = mtl_pictures_.try_emplace(std::filesystem::weakly_canonical(file));
  if (!is_new) return entry->second;
  const TextureImage image = read_texture(file, name);
  files.push_back(file);
  // Pictures of numbers are decoded like those of colours: that is taken back. EXR holds numbers as they are.
  const bool is_decoded = lowercase_ending(file) != ".exr";
  constexpr float black = 0.0025f;  // 8 / 255 in sRGB: in JPEG little is quite black
  double sum = 0.0;
  std::size_t black_texels = 0;
  for (const Rgb& texel : image.texels) {
    for (int i = 0; i < 3; ++i) sum += double{is_decoded ? linear_to_srgb(texel[i]) : std::min(texel[i], 1.0f)};
    black_texels += max_component(texel) < black ? 1 : 0;
  }
  entry->second.mean = static_cast<float>(sum / static_cast<double>(3 * image.texels.size()));
  entry->second.is_mostly_black = black_texels > image.texels.size() / 2;
  return entry->second;
}

/// A number in [0, 1], or the mean of the picture in its place.
std::optional<float> MaterialLibrary::mtl_share(const std::optional<float>& number, const MtlMap& map,
                                                const std::filesystem::path& folder) {
  if (!map) return number;
  const auto file = mtl_texture_file(map, folder, " and left out");
  return file ? mtl_picture(*file, map.file).mean : number;
}

Texture MaterialLibrary::mtl_emission(const MtlMaterial& source, const std::filesystem::path& folder,
                                      std::vector<std::string>& left_out) {
  const Rgb ke = source.ke.value_or(Rgb(0.0f));
  const MtlMap& map = source.map_ke;
  if (!map) return Texture::solid_color(ke);
  const auto file = mtl_texture_file(map, folder, " and left out");
  if (!file) return Texture::solid_color(ke);
  if (mtl_picture(*file, map.file).is_mostly_black) {
    // It marks spots, such as the lamps of a car, on a body that only reflects: as a light the body would be black.
    left_out.emplace_back("its light, as most of map_Ke is black");
    return Texture::solid_color(Rgb(0.0f));
  }
  // Beside a picture, Ke 0 is of exporters that do not multiply the two.
  if (!is_black(ke) && ke != Rgb(1.0f)) left_out.push_back("its factor Ke " + color_text(ke));
  Texture texture;
  texture.kind = Texture::Kind::image;
  texture.image = textures.load(*file, map.file);
  return texture;
}

Material MaterialLibrary::from_exported_mtl(const MtlMaterial& source, const std::filesystem::path& folder,
                                            std::vector<std::string>& left_out) {
  const Reflection reflection = reflection_of(source);
  const std::optional<float> metallic = mtl_share(source.pm, source.map_pm, folder);
  const std::optional<float> roughness = mtl_share(source.pr, source.map_pr, folder);
  if (source.illum == 10) {
    warnings.push_back(source.location + ": material " + in_quotes(source.name) +
                       " has illum 10, which is not understood: read as illum 2");
  }

  SurfaceDescription surface;
  surface.name = source.name;
  surface.emission = mtl_emission(source, folder, left_out);
  surface.transmission = transmission_of(source);
  // Panes often have illum 3 beside their d: no metal lets light through.
  surface.metallic = metallic.value_or(surface.is_clear() ? 0.0f : reflection.metallic);
  surface.roughness = roughness ? *roughness : roughness_of(source, surface, reflection);
  // The picture is read below, if it is used.
  if (!source.map_kd) surface.base_color = Texture::solid_color(source.kd.value_or(Rgb(0.5f)));

  // Ni 1 is what exporters write that know of no refraction: glass would not be seen. What is wholly clear without a
  // word of glass is not meant to be: of index 1, it is not.
  const bool has_index = source.ni && (*source.ni != 1.0f || is_physical(source));
  const float opacity = opacity_of(source);
  const bool is_unseen = !has_index && !is_physical(source) && !has_glass_illum(source) && opacity == 0.0f;
  if (has_index) surface.index = *source.ni;
  if (is_unseen) surface.index = 1.0f;

  Material material = nearest_material(surface, left_out);
  switch (material.kind) {
    case Material::Kind::lambertian:
      material.color = mtl_color_or_texture(source, source.kd, Rgb(0.5f), source.map_kd, folder);
      break;
    case Material::Kind::metal:
      if (metallic || reflection.color == Reflection::Color::kd) {
        material.color = mtl_color_or_texture(source, source.kd, Rgb(0.5f), source.map_kd, folder);
      } else if (reflection.color == Reflection::Color::ka) {
        material.color = mtl_color(source, source.ka, Rgb(1.0f));
      } else {
        material.color = mtl_color_or_texture(source, source.ks, Rgb(1.0f), source.map_ks, folder);
        // As in a plain material.
        if (source.illum == 3 && !roughness) material.fuzz = mtl_fuzz(source);
      }
      break;
    case Material::Kind::dielectric:
      if (is_unseen) {
        left_out.emplace_back("all of it, as it is wholly clear (d 0)");
      } else if (source.ni == 1.0f && !has_index) {
        left_out.emplace_back("its index (1)");
      }
      if (surface.transmission == 1.0f && opacity > 0.0f && opacity < 1.0f) {
        left_out.push_back("its opacity (" + number_text(opacity) + ")");
      }
      break;
    case Material::Kind::diffuse_light:
      break;
  }
  return material;
}

}  // namespace raylab
