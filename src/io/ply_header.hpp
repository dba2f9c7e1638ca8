#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "word_reader.hpp"

namespace raylab {

enum class PlyType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

/// Bytes of a number in a binary file.
std::size_t size_of(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;
  std::optional<PlyType> count;  ///< type of the number of values before a list's
  std::size_t line = 0;

  /// Bytes of the shortest value in a binary file: an empty list's.
  std::size_t smallest() const { return size_of(count.value_or(type)); }
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
  std::size_t line = 0;

  /// Index of the property of that name.
  std::optional<std::size_t> find(std::string_view name) const;
  bool has_lists() const;
  /// Bytes of one in a binary file with all lists empty.
  std::size_t smallest() const;
};

struct PlyHeader {
  enum class Format : std::uint8_t { ascii, little_endian, big_endian };
  Format format = Format::ascii;
  std::vector<PlyElement> elements;
  std::string texture;  ///< file name with forward slashes, of the first comment TextureFile; empty: none
  std::size_t texture_line = 0;
  std::size_t end = 0;  ///< byte where the elements begin
};

/// Reads up to end_header and its line end. Nothing of it is checked against what follows. Lines that are not
/// understood are left out with a warning. Throws Error (input) with file:line.
PlyHeader read_ply_header(std::string_view text, WordReader& words, std::vector<std::string>& warnings);

}  // namespace raylab
