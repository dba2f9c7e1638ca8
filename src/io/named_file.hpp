#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace raylab {

/// Finds the files that models name. Models come from other machines, whose paths they keep, and from systems that do
/// not tell large from small letters.
class NamedFiles {
 public:
  /// `name`, with forward slashes, relative to `folder`. Where there is none, a file of the same name, else of one that
  /// differs in the case of ASCII letters, is taken from the folder named, else from `folder`, with the warning
  /// "LOCATION: WHAT "NAME" is missing: "FILE" in its place". nullopt when there is none of these, without a warning.
  std::optional<std::filesystem::path> find(const std::filesystem::path& folder, const std::string& name,
                                            const std::string& what, const std::string& location,
                                            std::vector<std::string>& warnings);

 private:
  std::optional<std::filesystem::path> find_in(const std::filesystem::path& folder, const std::string& name);

  /// Files by their names in small letters, of each folder that was searched: once, however many names are missing.
  std::map<std::filesystem::path, std::map<std::string, std::filesystem::path>> listings_;
};

}  // namespace raylab
