#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace raylab {

/// Takes a text apart into words, and knows the line at hand. A line may end in LF, CR LF or CR. A byte order mark at
/// the beginning is no word.
class WordReader {
 public:
  /// `text` must outlive the reader; `file` is its name in messages.
  WordReader(std::string_view text, std::string file) : text_(text), file_(std::move(file)) {
    if (text.starts_with("\xEF\xBB\xBF")) at_ = 3;
  }

  /// Goes on to the next word, which may stand on a later line; false when there is none.
  bool find_word();
  /// The next word of this line; empty at its end.
  std::string_view word();
  /// What is left of this line, without the spaces around it.
  std::string_view rest_of_line();

  /// How many bytes were taken so far.
  std::size_t at() const { return at_; }
  std::size_t bytes_left() const { return text_.size() - at_; }
  std::size_t line() const { return line_; }
  /// "file:line"
  std::string location() const { return file_ + ":" + std::to_string(line_); }

  /// Throws Error (input): "file:line: found WORD, expected ...". An empty word is the end of the line or the file.
  [[noreturn]] void fail(std::string_view word, const std::string& expected) const;

 private:
  std::string_view text_;
  std::string file_;
  std::size_t at_ = 0;
  std::size_t line_ = 1;
};

/// The decimal number that the word is, which may be infinite or not a number ("inf", "nan").
std::optional<double> number_of_word(std::string_view word);

}  // namespace raylab
