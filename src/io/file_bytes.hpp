#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace raylab {

/// The whole file. Throws Error (input) naming the file and the reason.
std::string read_file(const std::filesystem::path& file);

/// At most `count` bytes from the start of the file, and how large all of it is. Throws Error (input).
std::string file_start(const std::filesystem::path& file, std::size_t count, std::uintmax_t& size);

/// Whether there is a file, or a link to one, that is neither a folder nor a device.
bool is_file(const std::filesystem::path& file) noexcept;

/// FNV-1a, 64 bits (Fowler, Noll, Vo), over pieces of bytes, each followed by its length so that moving bytes
/// from one piece to the next changes the hash.
class ContentHash {
 public:
  void add(const std::string& bytes);
  /// Throws Error (input) when the file cannot be read.
  void add_file(const std::filesystem::path& file);
  std::uint64_t value() const { return value_; }

 private:
  void add_bytes(const char* bytes, std::size_t count);
  void add_length(std::uint64_t length);

  std::uint64_t value_ = 0xcbf29ce484222325u;
};

}  // namespace raylab
