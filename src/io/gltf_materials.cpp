#include "gltf_materials.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "message_text.hpp"
#include "raylab/image/image_file.hpp"
#include "surface_description.hpp"

namespace raylab {
namespace {

using tinygltf::Value;

/// The number of that name, or what stands for it where there is none.
double number(const Value& object, const char* name, double otherwise) {
  if (!object.Has(name)) return otherwise;
  const Value& value = object.Get(name);
  return value.IsNumber() ? value.GetNumberAsDouble() : otherwise;
}

/// The first numbers of an array of that name.
dvec3 numbers(const Value& object, const char* name, const dvec3& otherwise) {
  dvec3 result = otherwise;
  if (!object.Has(name)) return result;
  const Value& array = object.Get(name);
  for (int i = 0; i < 3 && static_cast<std::size_t>(i) < array.ArrayLen(); ++i) {
    if (array.Get(i).IsNumber()) result[i] = array.Get(i).GetNumberAsDouble();
  }
  return result;
}

const Value* find(const tinygltf::ExtensionMap& extensions, const char* name) {
  const auto found = extensions.find(name);
  return found == extensions.end() ? nullptr : &found->second;
}

dvec3 first_three(const std::vector<double>& values) {  // tinygltf has counted them
  return {values[0], values[1], values[2]};
}

float unit(double x) { return static_cast<float>(std::clamp(x, 0.0, 1.0)); }

bool is_mostly_black(const TextureImage& image) {
  const auto black = static_cast<std::size_t>(std::count_if(image.texels.begin(), image.texels.end(), is_black));
  return black > image.texels.size() / 2;
}

}  // namespace

const GltfMaterial& GltfMaterials::get(int material) {
  if (const auto known = made_.find(material); known != made_.end()) return known->second;
  const std::string name = "material " + std::to_string(material);
  GltfMaterial made;
  if (material == -1) {
    made.index = library_.default_material(document_.file().string());
  } else {
    const auto& materials = document_.model().materials;
    if (material < 0 || static_cast<std::size_t>(material) >= materials.size()) document_.fail("there is no " + name);
    const auto& source = materials[static_cast<std::size_t>(material)];
    made = make(source, source.name.empty() ? name : source.name);
  }
  return made_[material] = made;
}

/// KHR_texture_transform, as its text and the viewers have it: a positive angle turns the coordinates from v towards u.
GltfMaterials::Use GltfMaterials::use_of(int texture, int set, const tinygltf::ExtensionMap& extensions) const {
  Use use{texture, {}};
  use.texcoords.set = set;
  if (const Value* transform = find(extensions, "KHR_texture_transform")) {
    const dvec3 offset = numbers(*transform, "offset", dvec3(0.0)), scale = numbers(*transform, "scale", dvec3(1.0));
    const double angle = number(*transform, "rotation", 0.0);
    const double sine = std::sin(angle), cosine = std::cos(angle);
    use.texcoords.rows = {dvec3(cosine * scale.x, sine * scale.y, offset.x),
                          dvec3(-sine * scale.x, cosine * scale.y, offset.y)};
    use.texcoords.set = static_cast<int>(std::clamp(number(*transform, "texCoord", set), 0.0, 1e6));
  }
  return use;
}

GltfMaterials::Use GltfMaterials::use_of(const Value& info) const {
  tinygltf::ExtensionMap extensions;
  if (info.Has("extensions") && info.Get("extensions").Has("KHR_texture_transform")) {
    extensions["KHR_texture_transform"] = info.Get("extensions").Get("KHR_texture_transform");
  }
  const auto index = [&](const char* name, double otherwise) {
    return static_cast<int>(std::clamp(number(info, name, otherwise), -1.0, 1e9));
  };
  return use_of(index("index", -1.0), index("texCoord", 0.0), extensions);
}

/// Sets `image` to the index of the texture's picture; nullopt, with a warning, where it is missing.
std::optional<GltfDocument::Image> GltfMaterials::image_of(int texture, int& image) {
  const auto& textures = document_.model().textures;
  const std::string what = "texture " + std::to_string(texture);
  if (texture < 0 || static_cast<std::size_t>(texture) >= textures.size()) document_.fail("there is no " + what);
  const tinygltf::Texture& source = textures[static_cast<std::size_t>(texture)];
  std::optional<GltfDocument::Image> found;
  image = source.source;
  if (image != -1) found = document_.image(image);
  if (!found) document_.warn("the picture of " + what + " is missing: magenta in its place");
  const auto& samplers = document_.model().samplers;
  if (source.sampler >= 0 && static_cast<std::size_t>(source.sampler) < samplers.size()) {
    const tinygltf::Sampler& sampler = samplers[static_cast<std::size_t>(source.sampler)];
    if (sampler.wrapS != TINYGLTF_TEXTURE_WRAP_REPEAT || sampler.wrapT != TINYGLTF_TEXTURE_WRAP_REPEAT) {
      document_.warn("wrapping of textures is left out: they repeat");
    }
  }
  return found;
}

Texture GltfMaterials::color(const Use& use, const Rgb& factor, bool is_albedo) {
  if (use.texture == -1 || is_black(factor)) return Texture::solid_color(factor);
  int number = -1;
  const auto image = image_of(use.texture, number);
  if (!image) return Texture::solid_color(Rgb(1.0f, 0.0f, 1.0f));
  Texture texture;
  texture.kind = Texture::Kind::image;
  if (!image->file.empty() && factor == Rgb(1.0f)) {
    texture.image = library_.textures.load(image->file, image->name);
  } else {
    const std::string place = document_.file().string() + ": image " + std::to_string(number);
    texture.image = library_.textures.add(place + " times " + color_text(factor), [&] {
      if (!image->file.empty()) library_.files.push_back(image->file);
      Image picture = image->file.empty() ? read_image(image->bytes, place) : read_image(image->file);
      for (Rgb& pixel : picture.pixels) pixel *= factor;
      return make_texture(std::move(picture), image->name);
    });
  }
  if (is_albedo) check_albedo(library_.textures.images()[texture.image], document_.file().string());
  return texture;
}

/// Mean of a channel of the numbers that a texture holds, which are no colours; 1 where there is none.
double GltfMaterials::mean(const Use& use, int channel) {
  if (use.texture == -1) return 1.0;
  int number = -1;
  const auto image = image_of(use.texture, number);
  if (!image) return 1.0;
  const auto [known, is_new] = means_.try_emplace(number, 0.0);
  if (is_new) {
    if (!image->file.empty()) library_.files.push_back(image->file);
    const std::string place = document_.file().string() + ": image " + std::to_string(number);
    const Image8 picture = image->file.empty() ? read_image8(image->bytes, place) : read_image8(image->file);
    std::array<std::uint64_t, 3> sums{};
    for (std::size_t i = 0; i < picture.rgb.size(); ++i) sums[i % 3] += picture.rgb[i];
    const double most = 255.0 * picture.width * picture.height;
    for (int c = 0; c < 3; ++c) known->second[c] = static_cast<double>(sums[static_cast<std::size_t>(c)]) / most;
  }
  return known->second[channel];
}

GltfMaterial GltfMaterials::make(const tinygltf::Material& source, const std::string& name) {
  const std::string quoted = "material " + in_quotes(name);
  const auto albedo = [&](const dvec3& given) {
    const dvec3 clamped = glm::clamp(given, 0.0, 1.0);
    if (clamped != given) {
      document_.warn(quoted + " has albedo " + color_text(Rgb(glm::clamp(given, -1e30, 1e30))) +
                     ", clamped to 0 ... 1");
    }
    return Rgb(clamped);
  };
  if (source.alphaMode != "OPAQUE") document_.warn("transparency (alpha) of materials is left out");
  if (source.normalTexture.index != -1) document_.warn("normal maps are left out");

  const tinygltf::PbrMetallicRoughness& pbr = source.pbrMetallicRoughness;
  std::vector<std::string> left_out;
  SurfaceDescription surface;
  surface.name = name;
  Use base, emission;
  if (const Value* specular = find(source.extensions, "KHR_materials_pbrSpecularGlossiness")) {
    if (specular->Has("diffuseTexture")) base = use_of(specular->Get("diffuseTexture"));
    surface.base_color = color(base, albedo(numbers(*specular, "diffuseFactor", dvec3(1.0))), true);
    surface.roughness = unit(1.0 - number(*specular, "glossinessFactor", 1.0));
    left_out.emplace_back("the colour that it reflects as a mirror");
  } else {
    const auto& texture = pbr.baseColorTexture;
    base = use_of(texture.index, texture.texCoord, texture.extensions);
    surface.base_color = color(base, albedo(first_three(pbr.baseColorFactor)), true);
    const Use rough = use_of(pbr.metallicRoughnessTexture.index, 0, {});
    surface.metallic = unit(pbr.metallicFactor * mean(rough, 2));
    surface.roughness = unit(pbr.roughnessFactor * mean(rough, 1));
    if (rough.texture != -1) left_out.emplace_back("how its metalness and roughness vary");
  }
  if (const Value* transmission = find(source.extensions, "KHR_materials_transmission")) {
    const Use use = transmission->Has("transmissionTexture") ? use_of(transmission->Get("transmissionTexture")) : Use{};
    surface.transmission = unit(number(*transmission, "transmissionFactor", 0.0) * mean(use, 0));
  }
  if (const Value* ior = find(source.extensions, "KHR_materials_ior")) {
    const double index = number(*ior, "ior", 1.5);
    if (index >= 1.0 && index <= 100.0) {
      surface.index = static_cast<float>(index);
    } else {
      document_.warn(quoted + " has an index of refraction of " + number_text(index) + ": 1.5 in its place");
    }
  }
  if (find(source.extensions, "KHR_materials_unlit") != nullptr) {
    surface.metallic = 0.0f;
    surface.roughness = 1.0f;
  }
  const Value* strength = find(source.extensions, "KHR_materials_emissive_strength");
  const double times = strength != nullptr ? number(*strength, "emissiveStrength", 1.0) : 1.0;
  constexpr double brightest = 1e30;
  const Rgb radiance(glm::clamp(first_three(source.emissiveFactor) * times, 0.0, brightest));
  const auto& texture = source.emissiveTexture;
  emission = use_of(texture.index, texture.texCoord, texture.extensions);
  surface.emission = color(emission, radiance, false);
  if (surface.emission.kind == Texture::Kind::image &&
      is_mostly_black(library_.textures.images()[surface.emission.image])) {
    surface.emission = Texture::solid_color(Rgb(0.0f));
    left_out.emplace_back("its emission, which most of it has none of");
  }

  const Material material = nearest_material(surface, left_out);
  GltfMaterial made;
  made.texcoords = (material.kind == Material::Kind::diffuse_light ? emission : base).texcoords;
  if (material.color.kind != Texture::Kind::image) made.texcoords = {};
  made.index = library_.add(material, document_.file().string(), left_out);
  return made;
}

}  // namespace raylab
