#pragma once
#include <filesystem>
#include <fstream>

namespace raylab {

/// A file written whole or not at all: what is streamed goes to a temporary file in the same folder, and commit()
/// renames that over the file, once the disk has it. Without a commit the temporary file is removed and a file that was
/// there before stays as it was; what a killed process has left is removed by a later one that writes there. The
/// permissions of a file that was there are kept. A symbolic link is followed, to where its file is to be; of a hard
/// link the other names keep the old content, as only a new file can take a name's place at once. A device is written
/// directly, and so is a pipe that someone reads.
class AtomicFile {
 public:
  /// Opens the temporary file. Throws Error (output) with the system's reason: the folder is missing or cannot be
  /// written, the file is a folder, the disk is full.
  explicit AtomicFile(const std::filesystem::path& file);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Binary, and need not be checked while writing: commit() does.
  std::ofstream& stream() { return stream_; }

  /// Puts what was written in the file's place. Throws Error (output) if any of it could not be written.
  void commit();

 private:
  AtomicFile(const std::filesystem::path& file, std::filesystem::path target);

  std::filesystem::path file_;       ///< as the caller named it, for messages
  std::filesystem::path target_;     ///< file_ with links followed
  std::filesystem::path temporary_;  ///< empty when there is none (any more)
  int descriptor_ = -1;              ///< of the temporary file, locked while it is in use
  std::ofstream stream_;
};

/// Throws the Error (output) that writing the file would throw now. Leaves nothing behind.
void check_writable(const std::filesystem::path& file);

/// Keeps a folder from being locked by another while it lives; in one process too. It leaves no file behind, and ends
/// with the process, however that ends. A file system that locks no folders is taken as it is.
class FolderLock {
 public:
  /// Throws Error (output) where another has it.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_;
};

}  // namespace raylab
