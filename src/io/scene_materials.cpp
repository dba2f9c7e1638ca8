// [material.NAME].
#include <algorithm>
#include <initializer_list>

#include "file_bytes.hpp"
#include "message_text.hpp"
#include "scene_sections.hpp"
#include "toml_reader.hpp"

namespace raylab {
namespace {

/// Reads a colour key: three numbers, { image = "..." } or { checker = SIZE, even = [..], odd = [..] }.
class ColorReader {
 public:
  ColorReader(const std::filesystem::path& folder, TextureFiles& textures) : folder_(folder), textures_(textures) {}

  Texture read(const TomlValue& value, const std::string& path, const Numbers& range) const {
    if (value.is_array()) return Texture::solid_color(vec3_of(value, path, range));
    if (!value.is_table()) {
      value.fail(path, "a colour [r, g, b], { image = \"...\" } or { checker = SIZE, even = [...], odd = [...] }");
    }
    TableReader reader(value, path);
    const TomlValue* image = reader.find("image");
    const TomlValue* checker = reader.find("checker");
    if (image != nullptr && checker != nullptr) value.fail_here(path + ": expected only one of image, checker");
    if (image != nullptr) {
      reader.finish();
      return picture(*image, path, range);
    }
    Texture texture;
    texture.kind = Texture::Kind::checker;
    reader.find("even");
    reader.find("odd");
    reader.finish();
    texture.size = number_of(reader.require("checker"), path + ".checker", kPositive);
    texture.a = vec3_of(reader.require("even"), path + ".even", range);
    texture.b = vec3_of(reader.require("odd"), path + ".odd", range);
    return texture;
  }

 private:
  Texture picture(const TomlValue& value, const std::string& path, const Numbers& range) const {
    const std::string name = string_of(value, path + ".image");
    const std::filesystem::path file = folder_ / name;
    if (!is_file(file)) value.fail(path + ".image", "an existing file");
    Texture texture;
    texture.kind = Texture::Kind::image;
    texture.image = textures_.load(file, name);
    if (!range.accepts(2.0f)) check_albedo(textures_.images()[texture.image], value.location);
    return texture;
  }

  const std::filesystem::path& folder_;
  TextureFiles& textures_;
};

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

Material::Kind kind_of(const TomlValue& type, const std::string& path) {
  const std::vector<std::string> names(kMaterialKindNames.begin(), kMaterialKindNames.end());
  const std::string& name = string_of(type, path);
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    std::string known = names.front();
    for (std::size_t i = 1; i < names.size(); ++i) known += (i + 1 == names.size() ? " or " : ", ") + names[i];
    type.fail(path, known + nearest_hint(name, names, "type"));
  }
  return static_cast<Material::Kind>(found - names.begin());
}

/// A key that another kind of material has gets a message that says so.
void check_key(const TomlValue& table, Material::Kind kind, const char* key, std::initializer_list<Material::Kind> of) {
  const TomlValue* value = table.find(key);
  if (value == nullptr || std::find(of.begin(), of.end(), kind) != of.end()) return;
  std::string names;
  for (const Material::Kind k : of)
    names += (names.empty() ? "" : " and ") + std::string(kMaterialKindNames[static_cast<std::size_t>(k)]);
  value->fail_at_key("unknown key " + in_quotes(key) + " in material." + table.key + ", which is " +
                     kMaterialKindNames[static_cast<std::size_t>(kind)] + ": it is a key of " + names);
}

Material read_material(const TomlValue& table, const ColorReader& colors) {
  TableReader reader(table, "material." + table.key);
  Material material;
  material.name = table.key;
  material.kind = kind_of(reader.require("type"), reader.path_of("type"));
  using enum Material::Kind;
  check_key(table, material.kind, "albedo", {lambertian, metal});
  check_key(table, material.kind, "fuzz", {metal});
  check_key(table, material.kind, "index", {dielectric});
  check_key(table, material.kind, "radiance", {diffuse_light});
  const auto color = [&](const std::string& key, const Numbers& range, const Rgb& otherwise) {
    const TomlValue* value = reader.find(key);
    material.color =
        value == nullptr ? Texture::solid_color(otherwise) : colors.read(*value, reader.path_of(key), range);
  };
  switch (material.kind) {
    case Material::Kind::lambertian:
      color("albedo", kUnitInterval, Rgb(0.5f));
      break;
    case Material::Kind::metal:
      color("albedo", kUnitInterval, Rgb(1.0f));
      reader.number("fuzz", material.fuzz, kUnitInterval);
      break;
    case Material::Kind::dielectric:
      reader.number("index", material.index, kPositive);
      break;
    case Material::Kind::diffuse_light:
      color("radiance", kNotNegative, Rgb(1.0f));
      break;
  }
  reader.finish();
  return material;
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

SceneMaterials::SceneMaterials(const TomlValue* table, const std::filesystem::path& folder, MaterialLibrary& library) {
  if (table == nullptr) return;
  if (!table->is_table()) table->fail("material", "tables, written [material.NAME]");
  const ColorReader colors(folder, library.textures);
  for (const TomlValue& item : table->items) {
    if (!item.is_table()) item.fail("material." + item.key, "a table, written [material." + item.key + "]");
    by_name_[item.key] = entries_.size();
    entries_.push_back({&item, library.add(read_material(item, colors), item.location), false});
  }
}

std::uint32_t SceneMaterials::use(const TomlValue& name, const std::string& path) {
  const std::string& wanted = string_of(name, path);
  const auto found = by_name_.find(wanted);
  if (found != by_name_.end()) {
    entries_[found->second].used = true;
    return entries_[found->second].index;
  }
  std::vector<std::string> known;
  for (const Entry& entry : entries_) known.push_back(entry.table->key);
  const std::string none = known.empty() ? ": the scene defines none" : nearest_hint(wanted, known, "material");
  name.fail_here(path + ": no material is named " + in_quotes(wanted) + none);
}

void SceneMaterials::check_all_used() const {
  for (const Entry& entry : entries_) {
    if (!entry.used) {
      entry.table->fail_at_key("material " + in_quotes(entry.table->key) + " is used by no mesh and no sphere");
    }
  }
}

}  // namespace raylab
