#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "raylab/core/vec.hpp"
#include "toml_value.hpp"

namespace raylab {

/// Which numbers a key takes, and how messages say so.
struct Numbers {
  const char* expected;  ///< "a number in [0, 1]"
  bool (*accepts)(float);
};
inline constexpr Numbers kAnyNumber = {"a finite number", [](float) { return true; }};
inline constexpr Numbers kPositive = {"a finite number above 0", [](float x) { return x > 0.0f; }};
inline constexpr Numbers kNotNegative = {"a finite number, at least 0", [](float x) { return x >= 0.0f; }};
inline constexpr Numbers kUnitInterval = {"a number in [0, 1]", [](float x) { return x >= 0.0f && x <= 1.0f; }};

/// The number, integers taken too. Throws Error at the value when it is none, is not finite or not accepted.
float number_of(const TomlValue& value, const std::string& path, const Numbers& numbers);

/// Three numbers, each accepted by `numbers`.
vec3 vec3_of(const TomlValue& value, const std::string& path, const Numbers& numbers);

/// Three numbers of double precision, which fit floats too.
dvec3 dvec3_of(const TomlValue& value, const std::string& path);

/// Reads one table key by key. Each key asked for, present or not, becomes a known key; finish() refuses all
/// others. Getters leave `out` as it is when the key is absent, and return whether it is there.
class TableReader {
 public:
  /// `path` names the table in messages: "camera", "sphere.3". Throws Error when the value is no table.
  TableReader(const TomlValue& table, std::string path);

  const TomlValue* find(const std::string& key);
  /// Throws Error at the table when the key is absent.
  const TomlValue& require(const std::string& key);

  bool number(const std::string& key, float& out, const Numbers& numbers);
  bool vector(const std::string& key, vec3& out, const Numbers& numbers);
  /// An integer of at least 1 that fits an int.
  bool count(const std::string& key, int& out);
  bool boolean(const std::string& key, bool& out);
  /// A string that is not empty.
  bool string(const std::string& key, std::string& out);

  /// Throws Error at the first key no one asked for, naming the nearest of those asked for.
  void finish() const;

  std::string path_of(const std::string& key) const { return path_.empty() ? key : path_ + "." + key; }
  const TomlValue& table() const { return table_; }

 private:
  const TomlValue& table_;
  std::string path_;
  std::vector<std::string> known_;
};

/// The string, which must not be empty.
const std::string& string_of(const TomlValue& value, const std::string& path);

/// The tables of an array of tables, written [[name]]; none when `value` is null.
std::span<const TomlValue> tables_of(const TomlValue* value, const std::string& name);

}  // namespace raylab
