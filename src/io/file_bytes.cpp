#include "file_bytes.hpp"

#include <array>
#include <bit>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <vector>

#include "raylab/core/error.hpp"

namespace raylab {
namespace {

[[noreturn]] void unreadable(const std::filesystem::path& file) {
  const int reason = errno;
  throw Error(ErrorKind::input, file.string(),
              std::string("cannot be read: ") + (reason != 0 ? std::strerror(reason) : "reading failed"));
}

std::ifstream open_file(const std::filesystem::path& file) {
  // A folder can be opened, and only fails at the first read.
  std::error_code no_access;  // which opening the file tells
  const bool is_folder = std::filesystem::is_directory(file, no_access);
  errno = is_folder ? EISDIR : 0;
  std::ifstream in(file, std::ios::binary);
  if (!in || errno == EISDIR) unreadable(file);
  return in;
}

constexpr std::uint64_t kPrime1 = 0x9e3779b185ebca87u, kPrime2 = 0xc2b2ae3d27d4eb4fu;

std::uint64_t mixed(std::uint64_t lane, std::uint64_t word) { return std::rotl(lane + word * kPrime2, 31) * kPrime1; }

}  // namespace

std::string read_file(const std::filesystem::path& file) {
  std::ifstream in = open_file(file);
  std::error_code no_size;
  const auto size = std::filesystem::file_size(file, no_size);
  // Pipes and the like have no size: they are read until they end.
  std::string bytes(no_size ? 0 : static_cast<std::size_t>(size), '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  for (char c; in.get(c);) bytes.push_back(c);
  if (in.bad()) unreadable(file);
  return bytes;
}

std::string file_start(const std::filesystem::path& file, std::size_t count, std::uintmax_t& size) {
  std::ifstream in = open_file(file);
  std::error_code no_size;
  size = std::filesystem::file_size(file, no_size);
  std::string bytes(count, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(count));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  if (in.bad()) unreadable(file);
  return bytes;
}

bool is_file(const std::filesystem::path& file) noexcept {
  std::error_code no_access;
  return std::filesystem::is_regular_file(file, no_access);
}

void ContentHash::add(const std::string& bytes) {
  add_bytes(bytes.data(), bytes.size());
  lanes_[0] = mixed(lanes_[0], bytes.size());
}

void ContentHash::add_file(const std::filesystem::path& file) {
  std::ifstream in = open_file(file);
  std::vector<char> buffer(kBlock << 12);
  std::uint64_t length = 0;
  while (in.read(buffer.data(), static_cast<std::streamsize>(buffer.size())) || in.gcount() > 0) {
    add_bytes(buffer.data(), static_cast<std::size_t>(in.gcount()));
    length += static_cast<std::uint64_t>(in.gcount());
  }
  if (in.bad()) unreadable(file);
  lanes_[0] = mixed(lanes_[0], length);
}

void ContentHash::add_bytes(const char* bytes, std::size_t count) {
  for (; count >= kBlock; bytes += kBlock, count -= kBlock) {
    std::array<std::uint64_t, 4> words;
    std::memcpy(words.data(), bytes, kBlock);
    for (std::size_t i = 0; i < words.size(); ++i) lanes_[i] = mixed(lanes_[i], words[i]);
  }
  if (count == 0) return;
  std::array<char, kBlock> last{};
  std::memcpy(last.data(), bytes, count);
  add_bytes(last.data(), kBlock);
}

std::uint64_t ContentHash::value() const {
  std::uint64_t value = 0;
  for (const std::uint64_t lane : lanes_) value = mixed(value, lane);
  value = (value ^ value >> 33) * kPrime2;
  value = (value ^ value >> 29) * kPrime1;
  return value ^ value >> 32;
}

}  // namespace raylab
