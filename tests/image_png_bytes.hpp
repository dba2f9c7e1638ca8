#pragma once
#include <array>
#include <cstdint>
#include <string>

namespace raylab::test {

/// What a PNG file can hold: the colour types of its specification.
enum class PngColour : std::uint8_t { grey = 0, rgb = 2, palette = 3, grey_alpha = 4, rgb_alpha = 6 };

namespace detail {

inline std::string big_endian(std::uint32_t x) {
  return {static_cast<char>(x >> 24), static_cast<char>(x >> 16), static_cast<char>(x >> 8), static_cast<char>(x)};
}

inline std::uint32_t crc32(const std::string& bytes) {
  std::uint32_t crc = 0xffffffffu;
  for (const char byte : bytes) {
    crc ^= static_cast<std::uint8_t>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1u) != 0 ? 0xedb88320u : 0u);
  }
  return ~crc;
}

inline std::string png_chunk(const std::string& type, const std::string& data) {
  return big_endian(static_cast<std::uint32_t>(data.size())) + type + data + big_endian(crc32(type + data));
}

/// A zlib stream that stores its bytes, fewer than 65536, uncompressed.
inline std::string zlib_stored(const std::string& data) {
  std::uint32_t a = 1, b = 0;
  for (const char byte : data) {
    a = (a + static_cast<std::uint8_t>(byte)) % 65521;
    b = (b + a) % 65521;
  }
  const auto size = static_cast<std::uint16_t>(data.size());
  const auto little_endian = [](std::uint16_t x) {
    return std::string{static_cast<char>(x), static_cast<char>(x >> 8)};
  };
  return "\x78\x01\x01" + little_endian(size) + little_endian(static_cast<std::uint16_t>(~size)) + data +
         big_endian(b << 16 | a);
}

}  // namespace detail

/// The bytes of a PNG file one pixel high. samples: the row's bytes; palette: R, G, B of each entry.
inline std::string png_row(int width, int bits, PngColour colour, const std::string& samples,
                           const std::string& palette = "") {
  using namespace detail;
  std::string header = big_endian(static_cast<std::uint32_t>(width)) + big_endian(1);
  header += {static_cast<char>(bits), static_cast<char>(colour), 0, 0, 0};
  std::string file = "\x89PNG\r\n\x1a\n" + png_chunk("IHDR", header);
  if (!palette.empty()) file += png_chunk("PLTE", palette);
  return file + png_chunk("IDAT", zlib_stored(std::string(1, '\0') + samples)) + png_chunk("IEND", "");
}

}  // namespace raylab::test
