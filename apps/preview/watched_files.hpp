#pragma once
#include <filesystem>
#include <utility>
#include <vector>

namespace raylab {

/// Files that someone else may write to.
class WatchedFiles {
 public:
  /// Remembers them as they are now; one may be absent.
  explicit WatchedFiles(std::vector<std::filesystem::path> files) : files_(std::move(files)) { remember(); }

  void remember() { last_ = remembered_ = look(); }

  /// Whether the files differ from what is remembered, by time or size, and have not changed since the last call: a
  /// file that is still being written to can wait.
  bool changed();

 private:
  using Stamp = std::pair<std::filesystem::file_time_type, std::uintmax_t>;
  std::vector<Stamp> look() const;

  std::vector<std::filesystem::path> files_;
  std::vector<Stamp> remembered_, last_;
};

}  // namespace raylab
