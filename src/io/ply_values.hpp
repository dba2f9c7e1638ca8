#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <string>
#include <string_view>

#include "ply_header.hpp"
#include "word_reader.hpp"

namespace raylab {

/// Takes the elements of a PLY file number by number, from text or bytes of either order. A place is a line, or a byte
/// of a binary file. Throws Error (input) with it.
class PlyValues {
 public:
  /// `words` has read the header of `bytes`, which must outlive the reader.
  PlyValues(std::string_view bytes, const WordReader& words, const PlyHeader& header, std::string file)
      : bytes_(bytes),
        words_(words),
        file_(std::move(file)),
        is_text_(header.format == PlyHeader::Format::ascii),
        swapped_((header.format == PlyHeader::Format::big_endian) != (std::endian::native == std::endian::big)),
        at_(header.end) {}

  bool is_text() const { return is_text_; }
  std::size_t bytes_left() const { return is_text_ ? words_.bytes_left() : bytes_.size() - at_; }
  std::size_t place() const { return is_text_ ? words_.line() : at_; }
  /// "file:line" or "file, byte N"
  std::string location(std::size_t place) const { return file_ + (is_text_ ? ":" : ", byte ") + std::to_string(place); }

  [[noreturn]] void fail_at(std::size_t place, const std::string& found, const std::string& expected) const;
  /// With the number that was read last, which this is, as what was found.
  [[noreturn]] void fail(double number, const std::string& expected) const;

  /// Refuses more of an element than the file has bytes for: neither memory nor time is spent on them.
  void check_size(const PlyElement& element) const;
  /// Goes on to the next of an element, which has a line of its own in a text, and returns its place.
  std::size_t begin(const PlyElement& element);
  void end();
  void skip(const PlyElement& element);

  double number(PlyType type, const PlyProperty& property);
  float finite_number(const PlyProperty& property);
  /// How many values of a list follow: no more than the file has bytes for.
  std::size_t list_count(const PlyProperty& property);
  void skip(const PlyProperty& property);
  /// Whether anything is left.
  bool find_more() { return is_text_ ? words_.find_word() : at_ < bytes_.size(); }

  /// Of a binary file: the number `offset` bytes on. It must be there.
  template <class T>
  T peek(std::size_t offset) const {
    std::array<char, sizeof(T)> bytes;
    std::memcpy(bytes.data(), bytes_.data() + at_ + offset, sizeof(T));
    if (swapped_) std::reverse(bytes.begin(), bytes.end());
    return std::bit_cast<T>(bytes);
  }
  void advance(std::size_t bytes) { at_ += bytes; }

 private:
  std::string_view bytes_;
  WordReader words_;
  std::string file_;
  bool is_text_;
  bool swapped_;
  std::size_t at_;             // in a binary file
  std::size_t number_at_ = 0;  // where the number read last began, in a binary file
  std::string_view word_;      // the number read last, in a text
};

/// Whether it is one of 0, 1, 2 ... and less than `end`.
bool is_whole(double number, double end);

}  // namespace raylab
