#pragma once
// A TOML document as a small tree that knows the place of every value. toml++ is slow to compile, so only
// toml_value.cpp sees it.
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "raylab/core/error.hpp"

namespace raylab {

struct TomlValue {
  enum class Kind : std::uint8_t { boolean, integer, real, string, date, array, table };

  Kind kind = Kind::table;
  bool overridden = false;  ///< from the command line: its errors are usage errors
  bool boolean = false;
  std::int64_t integer = 0;
  double real = 0.0;
  std::string text;              ///< of a string; of a date as written
  std::vector<TomlValue> items;  ///< of an array; of a table in the order of the file
  std::string location;          ///< file:line:column, or the option that gave it
  std::string key;               ///< in its table
  std::string key_location;

  bool is_table() const { return kind == Kind::table; }
  bool is_array() const { return kind == Kind::array; }

  /// The value of a key of this table, or null.
  const TomlValue* find(std::string_view name) const;
  TomlValue* find(std::string_view name);

  /// Keys of this table.
  std::vector<std::string> keys() const;

  /// The value as messages show it: numbers and strings as written, arrays of them, "a table".
  std::string found() const;

  /// Throws Error at the value: "PATH: found ..., expected ...".
  [[noreturn]] void fail(const std::string& path, const std::string& expected) const;
  /// Throws Error at the value, or at its key, with another message.
  [[noreturn]] void fail_here(const std::string& message) const;
  [[noreturn]] void fail_at_key(const std::string& message) const;
};

/// Parses a whole document. Throws Error (input) with file:line:column for syntax errors.
TomlValue parse_toml(std::string_view text, const std::string& file);

/// Parses one value as it stands to the right of "=", all of it placed at `location` and marked overridden; nullopt
/// when it is no TOML.
std::optional<TomlValue> parse_toml_value(std::string_view text, const std::string& location);

}  // namespace raylab
