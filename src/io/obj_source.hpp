#pragma once
#include <functional>
#include <streambuf>
#include <string>
#include <string_view>

namespace raylab {

/// Feeds an OBJ file to tinyobjloader one statement at a time, so that its callbacks know the line they come from, and
/// refuses what tinyobjloader silently misreads: it takes malformed numbers for 0 and index 0 for no index, does not
/// continue lines, and ends a material's name at its first space. tinyobjloader sees the v, vn, vt and f statements
/// alone; all others go to `other`.
class ObjSource : public std::streambuf {
 public:
  using Statement = std::function<void(std::string_view keyword, std::string_view rest)>;

  /// `text` is the whole file, `file` its name in messages.
  ObjSource(std::string text, std::string file, Statement other);

  /// Statements of each kind, for reserving memory; statements that are indented or continued may be missed.
  struct Counts {
    std::size_t vertices = 0, normals = 0, texcoords = 0, faces = 0;
  };
  Counts counts() const;

  /// First line of the statement read last, from 1.
  int line() const { return line_; }
  /// "file:line" of it.
  std::string location() const { return file_ + ":" + std::to_string(line_); }

  /// Throws Error (input): "file:line: found VALUE, expected ...".
  [[noreturn]] void fail(std::string_view found, const std::string& expected) const;
  /// The same with the whole statement as what was found.
  [[noreturn]] void fail(const std::string& expected) const;

 protected:
  int_type underflow() override;

 private:
  std::size_t line_end(std::size_t from);
  bool next_statement();
  void check_numbers(std::string_view rest, int least) const;
  void check_corners(std::string_view rest);

  std::string text_;
  std::string file_;
  Statement other_;
  bool has_returns_ = false;         // '\r', which few files have
  std::size_t begin_ = 0, end_ = 0;  // of the statement, its line end included
  int line_ = 0;
  int next_line_ = 1;
};

}  // namespace raylab
