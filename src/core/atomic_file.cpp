#include "raylab/core/atomic_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <string>
#include <system_error>

#include "raylab/core/error.hpp"

namespace raylab {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail(const fs::path& file, int error) {
  const std::string reason = error != 0 ? std::generic_category().message(error) : "writing failed; is the disk full?";
  throw Error(ErrorKind::output, file.string(), "cannot be written: " + reason);
}

/// Creates an empty file of a name no one uses, with the permissions a new file gets. The name does not grow from
/// the target's, which may already be as long as the file system allows.
fs::path create_temporary(const fs::path& folder, const fs::path& file) {
  static std::atomic<unsigned> counter{0};
  for (;;) {
    fs::path name = folder / (".raylab-" + std::to_string(getpid()) + "-" + std::to_string(counter++) + ".tmp");
    const int descriptor = open(name.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
    if (descriptor >= 0) {
      close(descriptor);
      return name;
    }
    if (errno != EEXIST) fail(file, errno);
  }
}

}  // namespace

AtomicFile::AtomicFile(const fs::path& file) : file_(file), target_(file) {
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
    temporary_ = create_temporary(target_.has_parent_path() ? target_.parent_path() : ".", file);
  }
  errno = 0;
  stream_.open(replaceable ? temporary_ : target_, std::ios::binary | std::ios::out);
  if (!stream_) {
    const int reason = errno;
    if (replaceable) fs::remove(temporary_, error);
    fail(file, reason);
  }
}

AtomicFile::~AtomicFile() {
  std::error_code ignored;
  if (!temporary_.empty()) fs::remove(temporary_, ignored);
}

void AtomicFile::commit() {
  errno = 0;
  stream_.close();
  // An earlier failure has stayed in the stream's state; closing adds that of what was still buffered.
  if (!stream_) fail(file_, errno);
  if (temporary_.empty()) return;
  std::error_code error;
  fs::rename(temporary_, target_, error);
  if (error) fail(file_, error.value());
  temporary_.clear();
}

void check_writable(const fs::path& file) { const AtomicFile probe(file); }

}  // namespace raylab
