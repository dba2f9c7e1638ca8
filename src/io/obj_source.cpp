#include "obj_source.hpp"

#include <cstring>
#include <utility>

#include "message_text.hpp"
#include "raylab/core/error.hpp"

namespace raylab {
namespace {

bool is_space(char c) { return c == ' ' || c == '\t'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Cuts the next word, or nothing, off the front of `rest`.
std::string_view next_word(std::string_view& rest) {
  std::size_t begin = 0;
  while (begin < rest.size() && is_space(rest[begin])) ++begin;
  std::size_t end = begin;
  while (end < rest.size() && !is_space(rest[end])) ++end;
  const std::string_view word = rest.substr(begin, end - begin);
  rest.remove_prefix(end);
  return word;
}

std::size_t skip_digits(std::string_view word, std::size_t at) {
  while (at < word.size() && is_digit(word[at])) ++at;
  return at;
}

std::size_t skip_sign(std::string_view word, std::size_t at) {
  return at < word.size() && (word[at] == '+' || word[at] == '-') ? at + 1 : at;
}

/// [sign] digits with at most one point, [e [sign] digits]. Four digits of exponent are enough for any finite
/// number.
bool is_number(std::string_view word) {
  const std::size_t whole = skip_sign(word, 0);
  std::size_t at = skip_digits(word, whole);
  std::size_t digits = at - whole;
  if (at < word.size() && word[at] == '.') {
    const std::size_t fraction = ++at;
    at = skip_digits(word, at);
    digits += at - fraction;
  }
  if (digits == 0) return false;
  if (at < word.size() && (word[at] == 'e' || word[at] == 'E')) {
    const std::size_t exponent = skip_sign(word, at + 1);
    at = skip_digits(word, exponent);
    if (at == exponent || at - exponent > 4) return false;
  }
  return at == word.size();
}

/// Length of the index that starts at `at`: [sign] digits, not zero, few enough for an int; 0 when there is none.
std::size_t index_length(std::string_view word, std::size_t at) {
  const std::size_t digits = skip_sign(word, at);
  const std::size_t end = skip_digits(word, digits);
  if (end == digits || end - digits > 9) return 0;
  if (word.find_first_not_of('0', digits) >= end) return 0;
  return end - at;
}

}  // namespace

ObjSource::ObjSource(std::string text, std::string file, Statement other)
    : text_(std::move(text)), file_(std::move(file)), other_(std::move(other)) {
  if (text_.starts_with("\xEF\xBB\xBF")) end_ = 3;  // byte order mark
  if (!text_.empty() && text_.back() != '\n') text_ += '\n';
}

ObjSource::Counts ObjSource::counts() const {
  Counts counts;
  for (const char* at = text_.c_str(); *at != '\0';) {
    if (at[0] == 'f' && is_space(at[1])) ++counts.faces;
    if (at[0] == 'v') {
      counts.vertices += is_space(at[1]) ? 1 : 0;
      counts.normals += at[1] == 'n' ? 1 : 0;
      counts.texcoords += at[1] == 't' ? 1 : 0;
    }
    const char* end = std::strchr(at, '\n');
    if (end == nullptr) break;
    at = end + 1;
  }
  return counts;
}

void ObjSource::fail(std::string_view found, const std::string& expected) const {
  throw Error(ErrorKind::input, location(), "found " + in_quotes(found) + ", expected " + expected);
}

void ObjSource::fail(const std::string& expected) const {
  fail(trimmed(std::string_view(text_).substr(begin_, end_ - begin_)), expected);
}

/// Index of the '\n' that ends the line that starts at `from`. A line may end in \n, \r\n or \r.
std::size_t ObjSource::line_end(std::size_t from) {
  std::size_t end = from;
  while (text_[end] != '\n' && text_[end] != '\r') ++end;  // ends, as the text ends with \n
  if (text_[end] == '\n') return end;
  if (text_[end + 1] != '\n') {
    text_[end] = '\n';
    return end;
  }
  text_[end] = ' ';
  return end + 1;
}

/// Moves on to the next statement and makes it one line, if it was continued by backslashes. False at the end.
bool ObjSource::next_statement() {
  begin_ = end_;
  line_ = next_line_;
  if (begin_ >= text_.size()) return false;
  const std::size_t first = text_.find_first_not_of(" \t", begin_);
  const bool is_comment = first != std::string::npos && text_[first] == '#';
  for (std::size_t from = begin_;;) {
    const std::size_t end = line_end(from);
    ++next_line_;
    end_ = end + 1;
    std::size_t last = end;
    while (last > from && is_space(text_[last - 1])) --last;
    const bool continued = last > from && text_[last - 1] == '\\' && !is_comment && end_ < text_.size();
    if (!continued) return true;
    text_[last - 1] = ' ';
    text_[end] = ' ';
    from = end_;
  }
}

void ObjSource::check_numbers(std::string_view rest, int least) const {
  int count = 0;
  for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest), ++count) {
    if (!is_number(word)) fail(word, "a finite number");
  }
  if (count < least) fail(std::to_string(least) + (least == 1 ? " number" : " numbers"));
}

void ObjSource::check_corners(std::string_view rest) {
  for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) {
    std::size_t at = index_length(word, 0);
    bool good = at > 0;
    for (int more = 0; more < 2 && good && at < word.size(); ++more) {
      good = word[at] == '/';
      // An index may be left out, as in 1//3.
      if (good && ++at < word.size() && word[at] != '/') {
        const std::size_t length = index_length(word, at);
        good = length > 0;
        at += length;
      }
    }
    if (!good || at != word.size()) {
      fail(word, "a corner v, v/vt, v//vn or v/vt/vn with indices from 1 up, or from -1 down");
    }
    // After a last slash tinyobjloader would take the next corner's index for the one left out here.
    for (auto last = static_cast<std::size_t>(word.data() - text_.data()) + word.size() - 1; text_[last] == '/';
         --last) {
      text_[last] = ' ';
    }
  }
}

ObjSource::int_type ObjSource::underflow() {
  while (next_statement()) {
    const std::string_view statement(text_.data() + begin_, end_ - 1 - begin_);
    std::string_view rest = statement;
    const std::string_view keyword = next_word(rest);
    if (keyword.empty() || keyword[0] == '#') continue;
    const bool is_face = keyword == "f";
    if (!is_face && keyword != "v" && keyword != "vn" && keyword != "vt") {
      other_(keyword, trimmed(rest));
      continue;
    }
    if (const std::size_t comment = rest.find('#'); comment != std::string_view::npos) {
      const std::size_t at = static_cast<std::size_t>(rest.data() - text_.data()) + comment;
      std::memset(text_.data() + at, ' ', end_ - 1 - at);
      rest = rest.substr(0, comment);
    }
    if (is_face) {
      check_corners(rest);
    } else {
      check_numbers(rest, keyword == "vt" ? 1 : 3);
    }
    setg(text_.data() + begin_, text_.data() + begin_, text_.data() + end_);
    return traits_type::to_int_type(*gptr());
  }
  return traits_type::eof();
}

}  // namespace raylab
