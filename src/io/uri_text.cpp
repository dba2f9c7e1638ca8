#include "uri_text.hpp"

#include <array>

namespace raylab {

std::string with_percents_decoded(std::string_view text) {
  const auto digit = [&](std::size_t at) {
    const std::string_view digits = "0123456789abcdef";
    const auto value = at < text.size() ? digits.find(static_cast<char>(text[at] | 0x20)) : std::string_view::npos;
    return value == std::string_view::npos ? -1 : static_cast<int>(value);
  };
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%' || digit(i + 1) < 0 || digit(i + 2) < 0) {
      result += text[i];
      continue;
    }
    result += static_cast<char>(16 * digit(i + 1) + digit(i + 2));
    i += 2;
  }
  return result;
}

std::optional<std::string> from_base64(std::string_view text) {
  static const auto table = [] {
    std::array<int, 256> values;
    values.fill(-1);
    const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (int i = 0; i < 64; ++i) values[static_cast<unsigned char>(digits[i])] = i;
    return values;
  }();
  for (int i = 0; i < 2 && text.ends_with('='); ++i) text.remove_suffix(1);
  if (text.size() % 4 == 1) return std::nullopt;
  const auto value = [&](std::size_t at) { return table[static_cast<unsigned char>(text[at])]; };
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3 + 2);
  int all = 0;  // negative once a value is
  std::size_t at = 0;
  for (; at + 4 <= text.size(); at += 4) {
    const int a = value(at), b = value(at + 1), c = value(at + 2), d = value(at + 3);
    all |= a | b | c | d;
    const char three[] = {static_cast<char>(a * 4 | b >> 4), static_cast<char>(b * 16 | c >> 2),
                          static_cast<char>(c * 64 | d)};
    bytes.append(three, 3);
  }
  if (at < text.size()) {
    const int a = value(at), b = value(at + 1), c = at + 2 < text.size() ? value(at + 2) : 0;
    all |= a | b | c;
    bytes.push_back(static_cast<char>(a * 4 | b >> 4));
    if (at + 2 < text.size()) bytes.push_back(static_cast<char>(b * 16 | c >> 2));
  }
  if (all < 0) return std::nullopt;
  return bytes;
}

}  // namespace raylab
