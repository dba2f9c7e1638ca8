#include "raylab/core/atomic_file.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "raylab/core/error.hpp"
#include "raylab/core/text.hpp"

namespace raylab {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail(const fs::path& file, int error) {
  const std::string reason = error != 0 ? std::generic_category().message(error) : "writing failed; is the disk full?";
  throw Error(ErrorKind::output, file.string(), "cannot be written: " + reason);
}

constexpr const char *kPrefix = ".raylab-", *kEnding = ".tmp";

/// Removes what killed processes have left in a folder: files that no one has locked, nor written to for a while, as
/// not every file system of a cluster locks.
void sweep(const fs::path& folder) {
  constexpr auto kLeftAlone = std::chrono::minutes(10);
  // Not by std::filesystem, whose listings end the program where memory is out.
  const std::unique_ptr<DIR, int (*)(DIR*)> listing(opendir(folder.c_str()), closedir);
  while (const dirent* const entry = listing ? readdir(listing.get()) : nullptr) {
    const std::string_view name = entry->d_name;
    if (!name.starts_with(kPrefix) || !name.ends_with(kEnding)) continue;
    const fs::path file = folder / name;
    std::error_code ignored;
    const auto written = fs::last_write_time(file, ignored);
    if (ignored || fs::file_time_type::clock::now() - written < kLeftAlone) continue;
    const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
    if (descriptor < 0) continue;
    if (flock(descriptor, LOCK_EX | LOCK_NB) == 0) fs::remove(file, ignored);
    close(descriptor);
  }
}

/// Creates an empty file of a name no one uses, with the permissions a new file gets, and locks it. The name does not
/// grow from the target's, which may already be as long as the file system allows.
int create_temporary(const fs::path& folder, const fs::path& file, fs::path& name) {
  static std::atomic<unsigned> counter{0};
  for (;;) {
    fs::path unused = folder / format("%s%d-%u%s", kPrefix, getpid(), counter++, kEnding);
    const int descriptor = open(unused.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
    if (descriptor >= 0) {
      name = std::move(unused);
      flock(descriptor, LOCK_EX | LOCK_NB);
      return descriptor;
    }
    if (errno != EEXIST) fail(file, errno);
  }
}

/// Where a link that has no file yet says that it is to be.
fs::path without_links(fs::path file) {
  constexpr int kMostLinks = 40;
  std::error_code error;
  for (int i = 0; i < kMostLinks && fs::is_symlink(fs::symlink_status(file, error)); ++i) {
    const fs::path next = fs::read_symlink(file, error);
    file = next.is_absolute() ? next : file.parent_path() / next;
  }
  return file;
}

/// A pipe that no one reads would be waited for without end.
void check_reader(const fs::path& pipe) {
  const int descriptor = open(pipe.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) fail(pipe, errno);
  close(descriptor);
}

fs::path folder_of(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : "."; }

}  // namespace

AtomicFile::AtomicFile(const fs::path& file, fs::path target) : file_(file), target_(std::move(target)) {}

// Once the other constructor has ended, what is thrown here leaves the temporary file to the destructor.
AtomicFile::AtomicFile(const fs::path& file) : AtomicFile(file, without_links(file)) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (fs::is_directory(status)) fail(file, EISDIR);
  if (!file.has_filename()) fail(file, ENOENT);
  const bool replaceable = !fs::exists(status) || fs::is_regular_file(status);
  if (replaceable) {
    if (fs::exists(status)) {
      target_ = fs::canonical(file, error);
      if (error) fail(file, error.value());
    }
    sweep(folder_of(target_));
    descriptor_ = create_temporary(folder_of(target_), file, temporary_);
    // Before there is anything to read in it.
    if (fs::exists(status)) fs::permissions(temporary_, status.permissions(), error);
  } else if (fs::is_fifo(status)) {
    check_reader(file);
  }
  errno = 0;
  stream_.open(replaceable ? temporary_ : target_, std::ios::binary | std::ios::out);
  if (!stream_) fail(file, errno);
}

AtomicFile::~AtomicFile() {
  std::error_code ignored;
  if (!temporary_.empty()) fs::remove(temporary_, ignored);
  if (descriptor_ >= 0) close(descriptor_);
}

void AtomicFile::commit() {
  errno = 0;
  stream_.close();
  // An earlier failure has stayed in the stream's state; closing adds that of what was still buffered.
  if (!stream_) fail(file_, errno);
  if (temporary_.empty()) return;
  // A name must not lead to a file that a crash of the machine finds empty. Some file systems sync nothing.
  if (fsync(descriptor_) != 0 && errno != EINVAL && errno != ENOTSUP) fail(file_, errno);
  std::error_code error;
  fs::rename(temporary_, target_, error);
  if (error) fail(file_, error.value());
  temporary_.clear();
  const int folder = open(folder_of(target_).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return;
  fsync(folder);
  close(folder);
}

void check_writable(const fs::path& file) {
  std::error_code error;
  // To open a pipe and close it again is the end of what its reader reads.
  if (fs::is_fifo(fs::status(file, error))) return;
  const AtomicFile probe(file);
}

FolderLock::FolderLock(const fs::path& folder) : descriptor_(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (descriptor_ < 0) fail(folder, errno);
  if (flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  close(descriptor_);
  throw Error(ErrorKind::output, folder.string(), "is being written to by another program; choose another folder");
}

FolderLock::~FolderLock() { close(descriptor_); }

}  // namespace raylab
