#include "message_text.hpp"

#include <algorithm>
#include <charconv>

#include "raylab/core/text.hpp"

namespace raylab {
namespace {

template <typename Real>
std::string shortest(Real value) {
  char buffer[64];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value);
  return {buffer, end.ptr};
}

}  // namespace

std::string number_text(float value) { return shortest(value); }
std::string number_text(double value) { return shortest(value); }

std::string color_text(const Rgb& color) {
  std::string text = "(";
  text += number_text(color.r) + ", " + number_text(color.g) + ", " + number_text(color.b);
  return text += ")";
}

std::string on_one_line(std::string_view text) {
  std::string line(text);
  for (char& c : line) {
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  }
  return line;
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t longest = 80;
  std::string result = "\"";
  result += on_one_line(text.substr(0, longest));
  return result += text.size() > longest ? "...\"" : "\"";
}

std::string nearest_hint(std::string_view name, std::span<const std::string> candidates, std::string_view kind) {
  const std::string nearest = nearest_name(name, candidates);
  if (nearest.empty()) return {};
  // Of long names the start decides, as in nearest_name().
  const std::string_view a = name.substr(0, 64), b = std::string_view(nearest).substr(0, 64);
  if (2 * edit_distance(a, b) <= std::max(a.size(), b.size())) {
    return ": the nearest known " + std::string(kind) + " is " + in_quotes(nearest);
  }
  constexpr std::size_t most_listed = 24;
  std::string list;
  for (const std::string& candidate : candidates.first(std::min(candidates.size(), most_listed))) {
    list += (list.empty() ? "" : ", ") + in_quotes(candidate);
  }
  return ": known " + std::string(kind) + "s are " + list + (candidates.size() > most_listed ? ", ..." : "");
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

}  // namespace raylab
