#include "ply_values.hpp"

#include <cmath>

#include "message_text.hpp"
#include "raylab/core/error.hpp"

namespace raylab {

bool is_whole(double number, double end) { return number >= 0.0 && number < end && number == std::floor(number); }

void PlyValues::fail_at(std::size_t place, const std::string& found, const std::string& expected) const {
  throw Error(ErrorKind::input, location(place), "found " + found + ", expected " + expected);
}

void PlyValues::fail(double number, const std::string& expected) const {
  if (is_text_) words_.fail(word_, expected);
  fail_at(number_at_, number_text(number), expected);
}

void PlyValues::check_size(const PlyElement& element) const {
  const std::size_t least = is_text_ ? 2 * element.properties.size() : element.smallest();
  const std::size_t left = bytes_left() + (is_text_ ? 1 : 0);  // the last line may lack its end
  if (least == 0 || element.count <= left / least) return;
  fail_at(place(), std::to_string(bytes_left()) + " bytes",
          std::to_string(element.count) + " of element " + in_quotes(element.name) + ", each of " +
              std::to_string(least) + " bytes or more");
}

std::size_t PlyValues::begin(const PlyElement& element) {
  if (is_text_ && !words_.find_word()) words_.fail("", "another " + in_quotes(element.name));
  return place();
}

void PlyValues::end() {
  if (!is_text_) return;
  if (const std::string_view word = words_.word(); !word.empty()) words_.fail(word, "the end of the line");
}

void PlyValues::skip(const PlyElement& element) {
  check_size(element);
  if (element.properties.empty()) return;
  if (!is_text_ && !element.has_lists()) return advance(element.count * element.smallest());
  for (std::uint64_t i = 0; i < element.count; ++i) {
    begin(element);
    for (const PlyProperty& property : element.properties) skip(property);
    end();
  }
}

double PlyValues::number(PlyType type, const PlyProperty& property) {
  if (is_text_) {
    word_ = words_.word();
    const auto number = number_of_word(word_);
    if (!number) words_.fail(word_, "a number for " + in_quotes(property.name));
    return *number;
  }
  if (bytes_left() < size_of(type)) fail_at(at_, "the end of the file", "a number for " + in_quotes(property.name));
  const auto number = [&]() -> double {
    switch (type) {
      case PlyType::int8:
        return peek<std::int8_t>(0);
      case PlyType::uint8:
        return peek<std::uint8_t>(0);
      case PlyType::int16:
        return peek<std::int16_t>(0);
      case PlyType::uint16:
        return peek<std::uint16_t>(0);
      case PlyType::int32:
        return peek<std::int32_t>(0);
      case PlyType::uint32:
        return peek<std::uint32_t>(0);
      case PlyType::float32:
        return double{peek<float>(0)};
      case PlyType::float64:
        return peek<double>(0);
    }
    return 0.0;
  }();
  number_at_ = at_;
  advance(size_of(type));
  return number;
}

float PlyValues::finite_number(const PlyProperty& property) {
  const double given = number(property.type, property);
  const float rounded = static_cast<float>(given);
  if (!std::isfinite(rounded)) fail(given, "a finite number for " + in_quotes(property.name));
  return rounded;
}

std::size_t PlyValues::list_count(const PlyProperty& property) {
  const double count = number(*property.count, property);
  const std::size_t most = bytes_left() / (is_text_ ? 2 : size_of(property.type));
  if (!is_whole(count, static_cast<double>(most) + 1.0)) {
    fail(count, "how many values of " + in_quotes(property.name) + " follow, up to the " + std::to_string(most) +
                    " that the file has bytes for");
  }
  return static_cast<std::size_t>(count);
}

void PlyValues::skip(const PlyProperty& property) {
  const std::size_t count = property.count ? list_count(property) : 1;
  if (property.count && !is_text_) return advance(count * size_of(property.type));
  for (std::size_t i = 0; i < count; ++i) number(property.type, property);
}

}  // namespace raylab
