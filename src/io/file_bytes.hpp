#pragma once
#include <array>
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

/// A hash of 64 bits over pieces of bytes, each followed by its length so that moving bytes from one piece to the next
/// changes the hash. Words of eight bytes go to four lanes in turn by the rounds of xxHash (Collet), which do not wait
/// for each other: a hash byte by byte would take longer than reading a binary model.
class ContentHash {
 public:
  void add(const std::string& bytes);
  /// Throws Error (input) when the file cannot be read.
  void add_file(const std::filesystem::path& file);
  std::uint64_t value() const;

 private:
  /// Only the last bytes of a piece may be no multiple of kBlock.
  void add_bytes(const char* bytes, std::size_t count);

  static constexpr std::size_t kBlock = 32;
  std::array<std::uint64_t, 4> lanes_{1, 2, 3, 4};
};

}  // namespace raylab
