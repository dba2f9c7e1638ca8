#include "watched_files.hpp"

#include <system_error>

namespace raylab {

bool WatchedFiles::changed() {
  std::vector<Stamp> now = look();
  std::swap(now, last_);
  return last_ == now && last_ != remembered_;
}

std::vector<WatchedFiles::Stamp> WatchedFiles::look() const {
  std::vector<Stamp> stamps;
  for (const auto& file : files_) {
    std::error_code error;  // of a file that is absent both have values of their own
    const auto time = std::filesystem::last_write_time(file, error);
    stamps.emplace_back(time, std::filesystem::file_size(file, error));
  }
  return stamps;
}

}  // namespace raylab
