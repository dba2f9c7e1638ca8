#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mtl_file.hpp"
#include "named_file.hpp"
#include "raylab/scene/material.hpp"
#include "texture_files.hpp"

namespace raylab {

/// The materials of a scene with their textures, and what reading them had to say. One library serves all meshes:
/// an MTL file is read once, and a material of it exists once, from the first face that uses it.
class MaterialLibrary {
 public:
  std::vector<Material> materials;
  TextureFiles textures;
  NamedFiles named_files;
  std::vector<std::string> warnings;         ///< "file:line: message"
  std::vector<std::string> notes;            ///< one line a material: its place and how it was understood
  std::vector<std::filesystem::path> files;  ///< read so far, textures excepted

  /// Adds a material and the note of it, with what was left out of it; returns its index in `materials`.
  std::uint32_t add(Material material, const std::string& location, const std::vector<std::string>& left_out = {});

  /// What has no material: lambertian grey (0.5).
  std::uint32_t default_material(const std::string& location);

  /// Makes the materials of an MTL file known, if they are not, and returns the file's number; nullopt when there is no
  /// such file. Throws Error.
  std::optional<std::size_t> open_mtl(const std::filesystem::path& file);

  /// Index in `materials` of a material of a file opened before; nullopt when the file has none of that name.
  /// `plain`: by the plain convention, also where exporters say more.
  std::optional<std::uint32_t> find(std::size_t mtl_file, const std::string& name, bool plain);

 private:
  struct MtlEntry {
    MtlMaterial source;
    std::optional<std::uint32_t> index, plain_index;  // once it is used
  };
  struct MtlFile {
    std::filesystem::path path;
    std::map<std::string, MtlEntry> entries;  // by name
  };
  // Of plain materials, in mtl_material.cpp.
  Material from_mtl(const MtlMaterial& source, const std::filesystem::path& folder);
  float mtl_fuzz(const MtlMaterial& source);
  Texture mtl_color(const MtlMaterial& source, const std::optional<Rgb>& color, const Rgb& otherwise);
  std::optional<std::filesystem::path> mtl_texture_file(const MtlMap& map, const std::filesystem::path& folder,
                                                        const std::string& otherwise);
  Texture mtl_texture(const MtlMaterial& source, const MtlMap& map, const std::filesystem::path& folder);
  Texture mtl_color_or_texture(const MtlMaterial& source, const std::optional<Rgb>& color, const Rgb& otherwise,
                               const MtlMap& map, const std::filesystem::path& folder);
  // Of those that exporters say more of, in mtl_exported.cpp.
  Material from_exported_mtl(const MtlMaterial& source, const std::filesystem::path& folder,
                             std::vector<std::string>& left_out);
  struct MtlPicture {
    float mean = 0.0f;  // of the numbers in the file, in [0, 1]
    bool is_mostly_black = false;
  };
  const MtlPicture& mtl_picture(const std::filesystem::path& file, const std::string& name);
  std::optional<float> mtl_share(const std::optional<float>& number, const MtlMap& map,
                                 const std::filesystem::path& folder);
  Texture mtl_emission(const MtlMaterial& source, const std::filesystem::path& folder,
                       std::vector<std::string>& left_out);

  std::vector<MtlFile> mtl_files_;
  std::map<std::filesystem::path, std::size_t> mtl_number_;   // by canonical path
  std::map<std::filesystem::path, MtlPicture> mtl_pictures_;  // by canonical path
  std::optional<std::uint32_t> default_;
};

/// A material in words: `material "white": lambertian, albedo (0.73, 0.73, 0.73)`.
std::string describe(const Material& material, const std::vector<TextureImage>& textures);

}  // namespace raylab
