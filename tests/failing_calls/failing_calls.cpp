// Loaded before a program's other libraries (LD_PRELOAD), it makes one call to the system fail, or all from one on:
//   FAIL_AT=N          the Nth call, from 1, that opens a file to be written, writes, syncs, renames, truncates or
//                      closes it
//   FAIL_UNDER=FOLDER  of those whose file is below this folder
//   FAIL_ONWARDS=1     and each later one that opens or writes, as on a disk that stays full
//   FAIL_ALLOCATION=N  the Nth allocation since main() began
//   FAIL_REPORT=FILE   which call that was, a word and the file, is written there; no file: there were fewer calls
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <initializer_list>

namespace {

std::atomic<long> calls{0}, allocations{0};
std::atomic<bool> in_main{false};

long number(const char* name) {
  const char* const text = std::getenv(name);
  return text ? std::atol(text) : 0;
}

/// Without any of the calls that are wrapped here.
void report(const char* call, const char* file) {
  const char* const name = std::getenv("FAIL_REPORT");
  if (!name) return;
  const int to = static_cast<int>(syscall(SYS_openat, AT_FDCWD, name, O_WRONLY | O_CREAT | O_TRUNC, 0666));
  for (const char* text : {call, " ", file, "\n"}) syscall(SYS_write, to, text, std::strlen(text));
  syscall(SYS_close, to);
}

/// Counts a call; whether it is to fail.
bool fails(const char* call, const char* file, int error, bool fails_onwards = false) {
  static const char* const under = std::getenv("FAIL_UNDER");
  static const long at = number("FAIL_AT");
  static const bool onwards = number("FAIL_ONWARDS") != 0;
  if (!file || !under || at == 0 || std::strncmp(file, under, std::strlen(under)) != 0) return false;
  const long n = ++calls;
  if (n != at && !(onwards && fails_onwards && n > at)) return false;
  if (n == at) report(call, file);
  errno = error;
  return true;
}

bool fails(const char* call, int descriptor, int error, bool fails_onwards = false) {
  char link[64], file[4096];
  std::snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  const long length = readlink(link, file, sizeof file - 1);
  if (length < 0) return false;
  file[length] = '\0';
  return fails(call, file, error, fails_onwards);
}

bool is_written(int descriptor) {
  const int flags = fcntl(descriptor, F_GETFL);
  return flags >= 0 && (flags & O_ACCMODE) != O_RDONLY;
}

template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

bool allocation_fails() {
  static const long at = number("FAIL_ALLOCATION");
  if (!in_main || at == 0 || ++allocations != at) return false;
  report("allocate", "");
  errno = ENOMEM;
  return true;
}

int (*program_main)(int, char**, char**);
int counted_main(int argc, char** argv, char** environment) {
  in_main = true;
  return program_main(argc, argv, environment);
}

}  // namespace

extern "C" {

void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

void* malloc(std::size_t size) { return allocation_fails() ? nullptr : __libc_malloc(size); }
void* calloc(std::size_t count, std::size_t size) { return allocation_fails() ? nullptr : __libc_calloc(count, size); }
void* realloc(void* block, std::size_t size) { return allocation_fails() ? nullptr : __libc_realloc(block, size); }
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  return allocation_fails() ? nullptr : __libc_memalign(alignment, size);
}
int posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  if (allocation_fails()) return ENOMEM;
  *block = __libc_memalign(alignment, size);
  return *block ? 0 : ENOMEM;
}

int __libc_start_main(int (*main)(int, char**, char**), int argc, char** argv, void (*init)(), void (*fini)(),
                      void (*rtld_fini)(), void* stack_end) {
  program_main = main;
  return next<int(int (*)(int, char**, char**), int, char**, void (*)(), void (*)(), void (*)(), void*)>(
      "__libc_start_main")(counted_main, argc, argv, init, fini, rtld_fini, stack_end);
}

int open(const char* file, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(arguments, mode_t) : 0;
  va_end(arguments);
  if ((flags & O_ACCMODE) != O_RDONLY && fails("open", file, ENOSPC, true)) return -1;
  return static_cast<int>(syscall(SYS_openat, AT_FDCWD, file, flags, mode));
}

FILE* fopen64(const char* file, const char* mode) {
  static auto* const real = next<FILE*(const char*, const char*)>("fopen64");
  return mode[0] != 'r' && fails("fopen", file, ENOSPC, true) ? nullptr : real(file, mode);
}
FILE* fopen(const char* file, const char* mode) { return fopen64(file, mode); }

ssize_t write(int descriptor, const void* bytes, std::size_t size) {
  if (fails("write", descriptor, ENOSPC, true)) return -1;
  return syscall(SYS_write, descriptor, bytes, size);
}

ssize_t writev(int descriptor, const iovec* parts, int count) {
  if (fails("writev", descriptor, ENOSPC, true)) return -1;
  return syscall(SYS_writev, descriptor, parts, count);
}

int fsync(int descriptor) {
  return fails("fsync", descriptor, EIO) ? -1 : static_cast<int>(syscall(SYS_fsync, descriptor));
}

int rename(const char* from, const char* to) {
  return fails("rename", to, EIO) ? -1 : static_cast<int>(syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
}

int ftruncate(int descriptor, off_t size) {
  return fails("ftruncate", descriptor, EIO) ? -1 : static_cast<int>(syscall(SYS_ftruncate, descriptor, size));
}

int truncate(const char* file, off_t size) {
  return fails("truncate", file, EIO) ? -1 : static_cast<int>(syscall(SYS_truncate, file, size));
}

// What fails to close is closed all the same.
int close(int descriptor) {
  const bool failed = is_written(descriptor) && fails("close", descriptor, EIO);
  const int result = static_cast<int>(syscall(SYS_close, descriptor));
  if (failed) errno = EIO;
  return failed ? -1 : result;
}

int fclose(FILE* file) {
  static auto* const real = next<int(FILE*)>("fclose");
  const bool failed = is_written(fileno(file)) && fails("fclose", fileno(file), EIO);
  const int result = real(file);
  if (failed) errno = EIO;
  return failed ? EOF : result;
}

}  // extern "C"
