#include "file_bytes.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>

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
  add_length(bytes.size());
}

void ContentHash::add_file(const std::filesystem::path& file) {
  std::ifstream in = open_file(file);
  std::vector<char> buffer(std::size_t{1} << 16);
  std::uint64_t length = 0;
  while (in.read(buffer.data(), static_cast<std::streamsize>(buffer.size())) || in.gcount() > 0) {
    add_bytes(buffer.data(), static_cast<std::size_t>(in.gcount()));
    length += static_cast<std::uint64_t>(in.gcount());
  }
  if (in.bad()) unreadable(file);
  add_length(length);
}

void ContentHash::add_bytes(const char* bytes, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    value_ = (value_ ^ static_cast<unsigned char>(bytes[i])) * 0x100000001b3u;
  }
}

void ContentHash::add_length(std::uint64_t length) {
  for (int i = 0; i < 8; ++i, length >>= 8) {
    const char byte = static_cast<char>(length & 0xff);
    add_bytes(&byte, 1);
  }
}

}  // namespace raylab
