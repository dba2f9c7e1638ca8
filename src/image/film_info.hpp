#pragma once
// What a film file says of its film, as the attributes of its header.
#include "raylab/image/film_file.hpp"

namespace raylab::detail {

/// FNV-1a, 64 bits (Fowler, Noll, Vo), of names and values, each followed by a zero.
std::uint64_t hash_of(const std::map<std::string, std::string>& texts);

/// With a hash of them all.
Attributes attributes_of(const FilmInfo& info, int width, int height);

/// Throws Error (input) at the file where the attributes are of another format version.
void check_version(const Attributes& attributes, const std::filesystem::path& file);

/// The inverse of attributes_of(). Throws Error (input) at the file where they are damaged.
FilmInfo info_of(const Attributes& attributes, int width, int height, const std::filesystem::path& file);

}  // namespace raylab::detail
