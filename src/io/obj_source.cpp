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

/// The word that starts at `at`.
std::string_view word_at(std::string_view text, std::size_t at) {
  text.remove_prefix(at);
  return next_word(text);
}

std::size_t skip_space(std::string_view text, std::size_t at) {
  while (at < text.size() && is_space(text[at])) ++at;
  return at;
}

/// The end of the number that starts at `at`: [sign] digits with at most one point, [e [sign] digits]; `at` when there
/// is none. Four digits of exponent are enough for any finite number.
std::size_t number_end(std::string_view text, std::size_t at) {
  const std::size_t whole = skip_sign(text, at);
  std::size_t end = skip_digits(text, whole);
  std::size_t digits = end - whole;
  if (end < text.size() && text[end] == '.') {
    const std::size_t fraction = ++end;
    end = skip_digits(text, end);
    digits += end - fraction;
  }
  if (digits == 0) return at;
  if (end < text.size() && (text[end] == 'e' || text[end] == 'E')) {
    const std::size_t exponent = skip_sign(text, end + 1);
    end = skip_digits(text, exponent);
    if (end == exponent || end - exponent > 4) return at;
  }
  return end;
}

/// The end of the index that starts at `at`: [sign] digits, not zero, few enough for an int; `at` when there is none.
std::size_t index_end(std::string_view text, std::size_t at) {
  const std::size_t digits = skip_sign(text, at);
  std::size_t end = digits;
  bool is_zero = true;
  for (; end < text.size() && is_digit(text[end]); ++end) is_zero = is_zero && text[end] == '0';
  return is_zero || end - digits > 9 ? at : end;
}

}  // namespace

ObjSource::ObjSource(std::string text, std::string file, Statement other)
    : text_(std::move(text)), file_(std::move(file)), other_(std::move(other)) {
  if (text_.starts_with("\xEF\xBB\xBF")) end_ = 3;  // byte order mark
  if (!text_.empty() && text_.back() != '\n') text_ += '\n';
  has_returns_ = text_.find('\r') != std::string::npos;
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
  if (!has_returns_) return text_.find('\n', from);  // is there, as the text ends with \n
  std::size_t end = from;
  while (text_[end] != '\n' && text_[end] != '\r') ++end;
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
  const bool is_comment = text_[skip_space(text_, begin_)] == '#';  // the text ends with no space
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
  for (std::size_t at = skip_space(rest, 0); at < rest.size(); ++count) {
    const std::size_t end = number_end(rest, at), next = skip_space(rest, end);
    if (end == at || (next == end && end < rest.size())) fail(word_at(rest, at), "a finite number");
    at = next;
  }
  if (count < least) fail(std::to_string(least) + (least == 1 ? " number" : " numbers"));
}

void ObjSource::check_corners(std::string_view rest) {
  for (std::size_t at = skip_space(rest, 0); at < rest.size();) {
    std::size_t end = index_end(rest, at);
    bool good = end > at;
    for (int more = 0; more < 2 && good && end < rest.size() && rest[end] == '/'; ++more) {
      const std::size_t index = ++end;
      if (index == rest.size() || is_space(rest[index]) || rest[index] == '/') continue;  // left out, as in 1//3
      end = index_end(rest, index);
      good = end > index;
    }
    if (!good || (end < rest.size() && !is_space(rest[end]))) {
      fail(word_at(rest, at), "a corner v, v/vt, v//vn or v/vt/vn with indices from 1 up, or from -1 down");
    }
    // After a last slash tinyobjloader would take the next corner's index for the one left out here.
    for (std::size_t last = static_cast<std::size_t>(rest.data() - text_.data()) + end - 1; text_[last] == '/';
         --last) {
      text_[last] = ' ';
    }
    at = skip_space(rest, end);
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
