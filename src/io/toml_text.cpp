#include "toml_text.hpp"

#include <algorithm>

#include "raylab/core/error.hpp"
#include "raylab/core/text.hpp"

namespace raylab {
namespace {

constexpr int kMostKeyParts = 32;

class TomlText {
 public:
  TomlText(std::string_view text, const std::string& file) : text_(text), file_(file) {}

  void check() {
    if (text_.starts_with("\xef\xbb\xbf")) start_ = at_ = 3;  // byte order mark
    int parts = 1;
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (c == '#') {
        at_ = std::min(text_.find('\n', at_), text_.size());
        continue;
      }
      if (c == '"' || c == '\'') {
        skip_string(c);
        continue;
      }
      if (c == '.' && ++parts > kMostKeyParts) fail(format("a key of more than %d parts", kMostKeyParts));
      if (std::string_view("\n=,[]{}").find(c) != std::string_view::npos) parts = 1;
      ++at_;
    }
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    const std::string_view before = text_.substr(start_, at_ - start_);
    const std::string_view row = before.substr(before.rfind('\n') + 1);
    // Columns count characters: bytes that go on with one are left out.
    const auto column = 1 + std::count_if(row.begin(), row.end(), [](char c) { return (c & 0xc0) != 0x80; });
    const auto line = 1 + std::count(before.begin(), before.end(), '\n');
    throw Error(ErrorKind::input, file_ + ":" + std::to_string(line) + ":" + std::to_string(column), message);
  }

  bool three(char quote) const { return text_.substr(at_, 3) == std::string(3, quote); }

  /// Goes past a string, or to where it breaks off.
  void skip_string(char quote) {
    const bool of_lines = three(quote);
    at_ += of_lines ? 3 : 1;
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (c == quote && (!of_lines || three(quote))) {
        at_ += of_lines ? 3 : 1;
        // A text of lines may end with two quotes of its own.
        for (int own = 0; of_lines && own < 2 && at_ < text_.size() && text_[at_] == quote; ++own) ++at_;
        return;
      }
      if (c == '\n' && !of_lines) return;
      at_ += c == '\\' && quote == '"' ? 2 : 1;
    }
  }

  std::string_view text_;
  const std::string& file_;
  std::size_t start_ = 0, at_ = 0;
};

}  // namespace

void check_toml_text(std::string_view text, const std::string& file) { TomlText(text, file).check(); }

}  // namespace raylab
