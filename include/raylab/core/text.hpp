#pragma once
// Words of messages.
#include <span>
#include <string>
#include <string_view>

namespace raylab {

/// What printf makes of it.
[[gnu::format(printf, 1, 2)]] std::string format(const char* pattern, ...);

/// Least number of insertions, deletions and substitutions of characters that turn a into b (Levenshtein).
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The candidate with the smallest edit distance, of which the first 64 characters count, the first of equals; empty
/// when there are none.
std::string nearest_name(std::string_view name, std::span<const std::string> candidates);

}  // namespace raylab
