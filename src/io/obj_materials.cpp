#include "obj_materials.hpp"

#include <algorithm>
#include <cctype>
#include <limits>
#include <optional>
#include <utility>

#include "message_text.hpp"
#include "raylab/core/error.hpp"

namespace raylab {
namespace {

/// The file names of an mtllib statement. They may hold spaces: a name ends where a word ends in .mtl.
std::vector<std::string> library_names(std::string_view rest) {
  std::vector<std::string> names;
  while (!(rest = trimmed(rest)).empty()) {
    std::size_t end = rest.size();
    for (std::size_t at = rest.find_first_of(" \t"); at < rest.size(); at = rest.find_first_of(" \t", at + 1)) {
      std::string ending(rest.substr(at < 4 ? 0 : at - 4, std::min<std::size_t>(at, 4)));
      std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
      if (ending == ".mtl") {
        end = at;
        break;
      }
    }
    std::string name(rest.substr(0, end));
    std::replace(name.begin(), name.end(), '\\', '/');
    names.push_back(std::move(name));
    rest.remove_prefix(end);
  }
  return names;
}

}  // namespace

ObjMaterials::ObjMaterials(const std::filesystem::path& file, const ObjOptions& options)
    : file_(file), options_(options) {}

bool ObjMaterials::statement(std::string_view keyword, std::string_view rest, const std::string& location,
                             MaterialLibrary& library) {
  if (keyword == "mtllib") {
    if (!options_.ignore_materials) open_libraries(rest, location, library);
    return true;
  }
  if (keyword != "usemtl") return false;
  current_ = {std::string(rest), location};
  changed_ = true;
  return true;
}

void ObjMaterials::open_libraries(std::string_view names, const std::string& location, MaterialLibrary& library) {
  for (const std::string& name : library_names(names)) {
    const auto file = library.named_files.find(file_.parent_path(), name, "material file", location, library.warnings);
    if (const auto number = file ? library.open_mtl(*file) : std::nullopt) {
      if (std::find(mtl_files_.begin(), mtl_files_.end(), *number) == mtl_files_.end()) mtl_files_.push_back(*number);
    } else {
      library.warnings.push_back(location + ": material file " + in_quotes(name) + " is missing");
    }
  }
}

void ObjMaterials::add_triangle(std::size_t triangle_count, int line) {
  if (options_.ignore_materials) return;
  if (changed_) {
    changed_ = false;
    if (current_.location.empty()) current_.location = file_.string() + ":" + std::to_string(line);
    if (uses_.size() > std::numeric_limits<std::uint16_t>::max()) {
      throw Error(ErrorKind::input, current_.location, "more than 65536 materials");
    }
    const auto [entry, is_new] = use_of_.try_emplace(current_.name, static_cast<std::uint16_t>(uses_.size()));
    if (is_new) uses_.push_back(current_);
    current_use_ = entry->second;
    // Until now there was one material.
    if (per_triangle_.empty() && uses_.size() > 1) per_triangle_.resize(triangle_count - 1, 0);
  }
  if (uses_.size() > 1) per_triangle_.push_back(current_use_);
}

std::uint32_t ObjMaterials::index_of(const Use& use, MaterialLibrary& library) const {
  if (use.name.empty()) return library.default_material(use.location);
  for (const std::size_t file : mtl_files_) {
    if (const auto index = library.find(file, use.name, options_.plain_materials)) return *index;
  }
  library.warnings.push_back(use.location + ": material " + in_quotes(use.name) +
                             " is not defined: grey (0.5) in its place");
  return library.default_material(use.location);
}

MeshMaterials ObjMaterials::finish(MaterialLibrary& library) {
  MeshMaterials result;
  std::vector<std::uint32_t> indices;
  for (const Use& use : uses_) indices.push_back(index_of(use, library));
  if (indices.empty()) return result;
  result.common = indices[0];
  if (std::all_of(indices.begin(), indices.end(), [&](std::uint32_t i) { return i == indices[0]; })) return result;
  if (library.materials.size() > std::size_t{std::numeric_limits<std::uint16_t>::max()} + 1) {
    throw Error(ErrorKind::input, file_.string(), "more than 65536 materials in the scene");
  }
  for (std::uint16_t& use : per_triangle_) use = static_cast<std::uint16_t>(indices[use]);
  result.per_triangle = std::move(per_triangle_);
  return result;
}

}  // namespace raylab
