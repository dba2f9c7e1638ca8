#include "named_file.hpp"

#include <algorithm>
#include <cctype>

#include "file_bytes.hpp"
#include "message_text.hpp"

namespace raylab {
namespace {

std::string in_small_letters(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

}  // namespace

std::optional<std::filesystem::path> NamedFiles::find_in(const std::filesystem::path& folder, const std::string& name) {
  if (is_file(folder / name)) return folder / name;
  const auto [listing, is_new] = listings_.try_emplace(folder);
  if (is_new) {
    std::error_code error;  // a folder that cannot be listed holds nothing to be found
    std::filesystem::directory_iterator entry(folder, error);
    for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
      const std::filesystem::path& file = entry->path();
      const auto [same, is_first] = listing->second.try_emplace(in_small_letters(file.filename().string()), file);
      // Of names that differ in case alone the first in the order of bytes, whatever the order of the listing.
      if (!is_first) same->second = std::min(same->second, file);
    }
  }
  const auto found = listing->second.find(in_small_letters(name));
  if (found == listing->second.end() || !is_file(found->second)) return std::nullopt;
  return found->second;
}

std::optional<std::filesystem::path> NamedFiles::find(const std::filesystem::path& folder, const std::string& name,
                                                      const std::string& what, const std::string& location,
                                                      std::vector<std::string>& warnings) {
  const std::filesystem::path named = folder / name;
  if (is_file(named)) return named;
  const std::filesystem::path here = folder.empty() ? std::filesystem::path(".") : folder;  // the current folder
  const std::string last = named.filename().string();
  auto found = named.has_parent_path() ? find_in(named.parent_path(), last) : std::nullopt;
  if (!found) found = find_in(here, last);
  if (!found) return std::nullopt;
  const std::string shown = found->lexically_relative(here).string();
  warnings.push_back(location + ": " + what + " " + in_quotes(name) + " is missing: " + in_quotes(shown) +
                     " in its place");
  return found;
}

}  // namespace raylab
