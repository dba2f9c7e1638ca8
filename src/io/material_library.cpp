#include "material_library.hpp"

#include <algorithm>
#include <utility>

#include "file_bytes.hpp"
#include "message_text.hpp"

namespace raylab {
namespace {

std::string texture_text(const Texture& texture, const std::vector<TextureImage>& images) {
  switch (texture.kind) {
    case Texture::Kind::solid:
      return color_text(texture.a);
    case Texture::Kind::checker:
      return "checker of " + number_text(texture.size) + " in " + color_text(texture.a) + " and " +
             color_text(texture.b);
    case Texture::Kind::image:
      break;
  }
  const TextureImage& image = images[texture.image];
  return in_quotes(image.name) + " (" + std::to_string(image.width) + " x " + std::to_string(image.height) + ")";
}

}  // namespace

std::string describe(const Material& material, const std::vector<TextureImage>& textures) {
  const std::string name = "material " + in_quotes(material.name) + ": ";
  const std::string color = texture_text(material.color, textures);
  switch (material.kind) {
    case Material::Kind::lambertian:
      return name + "lambertian, albedo " + color;
    case Material::Kind::metal:
      return name + "metal, albedo " + color + ", fuzz " + number_text(material.fuzz);
    case Material::Kind::dielectric:
      return name + "dielectric, index " + number_text(material.index);
    case Material::Kind::diffuse_light:
      break;
  }
  return name + "diffuse_light, radiance " + color;
}

std::uint32_t MaterialLibrary::add(Material material, const std::string& place) {
  notes.push_back(place + ": " + describe(material, textures.images()));
  materials.push_back(std::move(material));
  return static_cast<std::uint32_t>(materials.size() - 1);
}

std::uint32_t MaterialLibrary::default_material(const std::string& place) {
  if (!default_) {
    Material grey;
    grey.name = "default";
    grey.color = Texture::solid_color(Rgb(0.5f));
    default_ = add(std::move(grey), place);
  }
  return *default_;
}

bool MaterialLibrary::open_mtl(const std::filesystem::path& file) {
  const std::filesystem::path canonical = std::filesystem::weakly_canonical(file);
  if (mtl_files_.contains(canonical)) return true;
  if (!is_file(file)) return false;
  MtlFile mtl{file, {}};
  for (MtlMaterial& material : read_mtl(file, warnings)) {
    mtl.entries.push_back({std::move(material), std::nullopt});
  }
  mtl_files_.emplace(canonical, std::move(mtl));
  files.push_back(file);
  return true;
}

std::optional<std::uint32_t> MaterialLibrary::find(const std::filesystem::path& mtl_file,
                                                   const std::string& name) {
  const auto mtl = mtl_files_.find(std::filesystem::weakly_canonical(mtl_file));
  if (mtl == mtl_files_.end()) return std::nullopt;
  auto& entries = mtl->second.entries;
  const auto entry =
      std::find_if(entries.begin(), entries.end(), [&](const MtlEntry& e) { return e.source.name == name; });
  if (entry == entries.end()) return std::nullopt;
  if (!entry->index) {
    entry->index = add(from_mtl(entry->source, mtl->second.path.parent_path()), entry->source.place);
  }
  return entry->index;
}

}  // namespace raylab
