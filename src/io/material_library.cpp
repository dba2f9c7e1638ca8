#include "material_library.hpp"

#include <utility>

#include "file_bytes.hpp"
#include "message_text.hpp"

namespace raylab {

std::uint32_t MaterialLibrary::add(Material material, const std::string& location,
                                   const std::vector<std::string>& left_out) {
  std::string note = location + ": " + describe(material, textures.images());
  for (std::size_t i = 0; i < left_out.size(); ++i) note += (i == 0 ? "; left out: " : ", ") + left_out[i];
  notes.push_back(std::move(note));
  materials.push_back(std::move(material));
  return static_cast<std::uint32_t>(materials.size() - 1);
}

std::uint32_t MaterialLibrary::default_material(const std::string& location) {
  if (!default_) {
    Material grey;
    grey.name = "default";
    grey.color = Texture::solid_color(Rgb(0.5f));
    default_ = add(std::move(grey), location);
  }
  return *default_;
}

std::optional<std::size_t> MaterialLibrary::open_mtl(const std::filesystem::path& file) {
  if (!is_file(file)) return std::nullopt;
  const std::filesystem::path canonical = std::filesystem::weakly_canonical(file);
  if (const auto known = mtl_number_.find(canonical); known != mtl_number_.end()) return known->second;
  MtlFile mtl{file, {}};
  for (MtlMaterial& material : read_mtl(file, warnings)) {
    std::string name = material.name;
    mtl.entries.try_emplace(std::move(name), MtlEntry{std::move(material), std::nullopt, std::nullopt});
  }
  mtl_files_.push_back(std::move(mtl));
  files.push_back(file);
  return mtl_number_[canonical] = mtl_files_.size() - 1;
}

std::optional<std::uint32_t> MaterialLibrary::find(std::size_t mtl_file, const std::string& name, bool plain) {
  MtlFile& mtl = mtl_files_[mtl_file];
  const auto found = mtl.entries.find(name);
  if (found == mtl.entries.end()) return std::nullopt;
  const MtlMaterial& source = found->second.source;
  const bool simplified = plain && !source.is_plain();
  std::optional<std::uint32_t>& index = simplified ? found->second.plain_index : found->second.index;
  if (index) return index;
  const std::filesystem::path folder = mtl.path.parent_path();
  std::vector<std::string> left_out;
  Material material =
      plain || source.is_plain() ? from_mtl(source, folder) : from_exported_mtl(source, folder, left_out);
  if (simplified) left_out.emplace_back("what only exporters write");
  index = add(std::move(material), source.location, left_out);
  return index;
}

}  // namespace raylab
