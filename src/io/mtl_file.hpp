#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "raylab/core/vec.hpp"

namespace raylab {

/// A picture that an MTL file names.
struct MtlMap {
  std::string file;   ///< with forward slashes; empty: none
  std::string place;  ///< file:line of it

  explicit operator bool() const { return !file.empty(); }
};

/// What wrote an MTL file, by its first comments.
enum class MtlWriter : std::uint8_t {
  unknown,
  blender,              ///< no number in its comment: up to 3.0
  blender_with_number,  ///< from 3.1 on
};

/// What an MTL file says of one material. What it does not say is absent, which is not the same as zero.
struct MtlMaterial {
  std::string name;
  std::string location;  ///< file:line of its newmtl
  MtlWriter writer = MtlWriter::unknown;
  std::optional<Rgb> ka, kd, ks, ke, tf;
  std::optional<float> ns, ni;
  std::optional<float> pr, pm, d, tr;  ///< in [0, 1]
  std::optional<int> illum;
  MtlMap map_kd, map_ks, map_ke, map_pr, map_pm;
  bool has_map_d = false;
  std::string ni_place;  ///< file:line of Ni

  /// Whether none of the statements is there that the convention of mtl_material.cpp leaves out and exporters write:
  /// d, Tr, Tf, Pr, Pm, illum 4, 5 and 7 to 9, map_Ke, map_Ks, map_Pr, map_Pm.
  bool is_plain() const;
};

/// Reads the statements of an MTL file that materials are made from. Others that would change the picture give one
/// warning a kind, with the first file:line. Of two materials with one name the first counts, with a warning.
/// Values beyond [0, 1] of Pr, Pm, d and Tr are clamped with a warning.
/// Throws Error (input) with file:line for numbers that are none, negative colours, an index that is not above 0. In a
/// material that is not plain such an index is left out with a warning: exporters write 0 or -1 where there is none.
std::vector<MtlMaterial> read_mtl(const std::filesystem::path& file, std::vector<std::string>& warnings);

}  // namespace raylab
