#pragma once
// What the fuzzers share: a file in memory that holds the input, and what may come of reading it.
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "raylab/core/error.hpp"

namespace raylab::fuzz {

/// A folder of this process, gone at its end.
inline const std::filesystem::path& folder() {
  struct Folder {
    std::filesystem::path path = "/dev/shm/raylab-fuzz-" + std::to_string(getpid());
    Folder() { std::filesystem::create_directory(path); }
    ~Folder() {
      std::error_code ignored;
      std::filesystem::remove_all(path, ignored);
    }
  };
  static const Folder made;
  return made.path;
}

/// Writes a file in the folder and returns its path.
inline std::filesystem::path write(const char* name, std::string_view bytes) {
  const std::filesystem::path file = folder() / name;
  std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return file;
}

/// Reading may fail only with an error that has its place, on one line; anything else ends the program.
template <class Read>
void read_or_tell(const Read& read) {
  try {
    read();
  } catch (const Error& error) {
    const std::string_view text = error.what();
    if (error.location().empty() || error.kind() == ErrorKind::output || text.find('\n') != text.npos) std::abort();
  }
}

}  // namespace raylab::fuzz

/// The input as text.
#define RAYLAB_FUZZ(text)                                                             \
  static void fuzz_one(std::string_view text);                                        \
  extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) { \
    fuzz_one({reinterpret_cast<const char*>(data), size});                            \
    return 0;                                                                         \
  }                                                                                   \
  static void fuzz_one(std::string_view text)
