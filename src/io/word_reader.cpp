#include "word_reader.hpp"

#include <charconv>

#include "message_text.hpp"
#include "raylab/core/error.hpp"

namespace raylab {
namespace {

bool is_space(char c) { return c == ' ' || c == '\t'; }
bool is_line_end(char c) { return c == '\n' || c == '\r'; }

}  // namespace

bool WordReader::find_word() {
  for (; at_ < text_.size(); ++at_) {
    const char c = text_[at_];
    if (is_line_end(c)) {
      if (c == '\r' && at_ + 1 < text_.size() && text_[at_ + 1] == '\n') ++at_;
      ++line_;
    } else if (!is_space(c)) {
      return true;
    }
  }
  return false;
}

std::string_view WordReader::word() {
  while (at_ < text_.size() && is_space(text_[at_])) ++at_;
  const std::size_t begin = at_;
  while (at_ < text_.size() && !is_space(text_[at_]) && !is_line_end(text_[at_])) ++at_;
  return text_.substr(begin, at_ - begin);
}

std::string_view WordReader::rest_of_line() {
  const std::size_t begin = at_;
  while (at_ < text_.size() && !is_line_end(text_[at_])) ++at_;
  return trimmed(text_.substr(begin, at_ - begin));
}

void WordReader::fail(std::string_view word, const std::string& expected) const {
  const std::string found = !word.empty()       ? in_quotes(word)
                            : bytes_left() == 0 ? "the end of the file"
                                                : "the end of the line";
  throw Error(ErrorKind::input, location(), "found " + found + ", expected " + expected);
}

std::optional<double> number_of_word(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

}  // namespace raylab
