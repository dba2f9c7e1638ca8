#include "material_library.hpp"

#include <algorithm>
#include <utility>

#include "file_bytes.hpp"
#include "message_text.hpp"

namespace raylab {

std::uint32_t MaterialLibrary::add(Material material, const std::string& location) {
  notes.push_back(location + ": " + describe(material, textures.images()));
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

bool MaterialLibrary::open_mtl(const std::filesystem::path& file) {
  if (!is_file(file)) return false;
  const std::filesystem::path canonical = std::filesystem::weakly_canonical(file);
  if (mtl_files_.contains(canonical)) return true;
  MtlFile mtl{file, {}};
  for (MtlMaterial& material : read_mtl(file, warnings)) {
    mtl.entries.push_back({std::move(material), std::nullopt});
  }
  mtl_files_.emplace(canonical, std::move(mtl));
  files.push_back(file);
  return true;
}

std::optional<std::uint32_t> MaterialLibrary::find(const std::filesystem::path& mtl_file, const std::string& name) {
  const auto mtl = mtl_files_.find(std::filesystem::weakly_canonical(mtl_file));
  if (mtl == mtl_files_.end()) return std::nullopt;
  auto& entries = mtl->second.entries;
  const auto entry =
      std::find_if(entries.begin(), entries.end(), [&](const MtlEntry& e) { return e.source.name == name; });
  if (entry == entries.end()) return std::nullopt;
  if (!entry->index) {
    entry->index = add(from_mtl(entry->source, mtl->second.path.parent_path()), entry->source.location);
  }
  return entry->index;
}

}  // namespace raylab
