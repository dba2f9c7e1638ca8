#include "toml_reader.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "message_text.hpp"
#include "raylab/core/text.hpp"

namespace raylab {

using Kind = TomlValue::Kind;

float number_of(const TomlValue& value, const std::string& path, const Numbers& numbers) {
  if (value.kind != Kind::integer && value.kind != Kind::real) value.fail(path, numbers.expected);
  const float number = value.kind == Kind::integer ? static_cast<float>(value.integer) : static_cast<float>(value.real);
  if (!std::isfinite(number) || !numbers.accepts(number)) value.fail(path, numbers.expected);
  return number;
}

vec3 vec3_of(const TomlValue& value, const std::string& path, const Numbers& numbers) {
  if (!value.is_array() || value.items.size() != 3) {
    value.fail(path, std::string("three numbers [x, y, z], each ") + numbers.expected);
  }
  vec3 v;
  for (int axis = 0; axis < 3; ++axis) {
    v[axis] = number_of(value.items[static_cast<std::size_t>(axis)], path, numbers);
  }
  return v;
}

dvec3 dvec3_of(const TomlValue& value, const std::string& path) {
  vec3_of(value, path, kAnyNumber);  // refuses what is none
  const auto component = [&](std::size_t axis) {
    const TomlValue& number = value.items[axis];
    return number.kind == Kind::integer ? static_cast<double>(number.integer) : number.real;
  };
  return {component(0), component(1), component(2)};
}

const std::string& string_of(const TomlValue& value, const std::string& path) {
  if (value.kind != Kind::string || value.text.empty()) value.fail(path, "a text in quotes");
  return value.text;
}

std::span<const TomlValue> tables_of(const TomlValue* value, const std::string& name) {
  if (value == nullptr) return {};
  const std::string expected = "an array of tables, written [[" + name + "]]";
  if (!value->is_array()) value->fail(name, expected);
  for (const TomlValue& item : value->items) {
    if (!item.is_table()) item.fail(name, expected);
  }
  return value->items;
}

TableReader::TableReader(const TomlValue& table, std::string path) : table_(table), path_(std::move(path)) {
  if (!table.is_table()) table.fail(path_, "a table");
}

const TomlValue* TableReader::find(const std::string& key) {
  known_.push_back(key);
  return table_.find(key);
}

const TomlValue& TableReader::require(const std::string& key) {
  const TomlValue* value = find(key);
  if (value == nullptr) {
    const auto like = std::find_if(table_.items.begin(), table_.items.end(),
                                   [&](const TomlValue& v) { return edit_distance(v.key, key) <= 2; });
    const std::string hint = like == table_.items.end() ? "" : "; there is " + in_quotes(like->key);
    table_.fail_here(path_ + " has no " + in_quotes(key) + ", which is required" + hint);
  }
  return *value;
}

bool TableReader::number(const std::string& key, float& out, const Numbers& numbers) {
  const TomlValue* value = find(key);
  if (value != nullptr) out = number_of(*value, path_of(key), numbers);
  return value != nullptr;
}

bool TableReader::vector(const std::string& key, vec3& out, const Numbers& numbers) {
  const TomlValue* value = find(key);
  if (value != nullptr) out = vec3_of(*value, path_of(key), numbers);
  return value != nullptr;
}

bool TableReader::count(const std::string& key, int& out) {
  const TomlValue* value = find(key);
  if (value == nullptr) return false;
  if (value->kind != Kind::integer || value->integer < 1 || value->integer > std::numeric_limits<int>::max()) {
    value->fail(path_of(key), "an integer, at least 1");
  }
  out = static_cast<int>(value->integer);
  return true;
}

bool TableReader::boolean(const std::string& key, bool& out) {
  const TomlValue* value = find(key);
  if (value == nullptr) return false;
  if (value->kind != TomlValue::Kind::boolean) value->fail(path_of(key), "true or false");
  out = value->boolean;
  return true;
}

bool TableReader::string(const std::string& key, std::string& out) {
  const TomlValue* value = find(key);
  if (value != nullptr) out = string_of(*value, path_of(key));
  return value != nullptr;
}

void TableReader::finish() const {
  for (const TomlValue& item : table_.items) {
    if (std::find(known_.begin(), known_.end(), item.key) != known_.end()) continue;
    const std::string where = path_.empty() ? "" : " in " + path_;
    item.fail_at_key("unknown key " + in_quotes(item.key) + where + nearest_hint(item.key, known_, "key"));
  }
}

}  // namespace raylab
