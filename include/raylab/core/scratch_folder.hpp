#pragma once
#include <filesystem>
#include <string>

namespace raylab {

/// A new empty folder among the system's temporary files, which no other user may enter; it is removed with what is
/// in it when its owner goes.
class ScratchFolder {
 public:
  /// The folder's name starts with `name`. Throws Error (output) where it cannot be made.
  explicit ScratchFolder(const std::string& name);
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

}  // namespace raylab
