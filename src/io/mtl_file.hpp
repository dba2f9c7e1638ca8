#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "raylab/core/vec.hpp"

namespace raylab {

/// What an MTL file says of one material. What it does not say is absent, which is not the same as zero.
struct MtlMaterial {
  std::string name;
  std::string location;  ///< file:line of its newmtl
  std::optional<Rgb> kd, ks, ke;
  std::optional<float> ns, ni;
  std::optional<int> illum;
  std::string map_kd;        ///< file name with forward slashes; empty: none
  std::string map_kd_place;  ///< file:line of it
};

/// Reads the statements of an MTL file that materials are made from. Others that would change the picture give one
/// warning a kind, with the first file:line. Of two materials with one name the first counts, with a warning.
/// Throws Error (input) with file:line for numbers that are none, negative colours, an index that is not above 0.
std::vector<MtlMaterial> read_mtl(const std::filesystem::path& file, std::vector<std::string>& warnings);

}  // namespace raylab
