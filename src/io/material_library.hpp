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

  /// Adds a material and the note of it; returns its index in `materials`.
  std::uint32_t add(Material material, const std::string& location);

  /// What has no material: lambertian grey (0.5).
  std::uint32_t default_material(const std::string& location);

  /// Makes the materials of an MTL file known, if they are not, and returns the file's number; nullopt when there is no
  /// such file. Throws Error.
  std::optional<std::size_t> open_mtl(const std::filesystem::path& file);

  /// Index in `materials` of a material of a file opened before; nullopt when the file has none of that name.
  std::optional<std::uint32_t> find(std::size_t mtl_file, const std::string& name);

 private:
  struct MtlEntry {
    MtlMaterial source;
    std::optional<std::uint32_t> index;  // once it is used
  };
  struct MtlFile {
    std::filesystem::path path;
    std::map<std::string, MtlEntry> entries;  // by name
  };
  Material from_mtl(const MtlMaterial& source, const std::filesystem::path& folder);
  Texture mtl_color(const MtlMaterial& source, const std::optional<Rgb>& color, const Rgb& otherwise);
  Texture mtl_texture(const MtlMaterial& source, const std::filesystem::path& folder);

  std::vector<MtlFile> mtl_files_;
  std::map<std::filesystem::path, std::size_t> mtl_number_;  // by canonical path
  std::optional<std::uint32_t> default_;
};

/// A material in words: `material "white": lambertian, albedo (0.73, 0.73, 0.73)`.
std::string describe(const Material& material, const std::vector<TextureImage>& textures);

}  // namespace raylab
