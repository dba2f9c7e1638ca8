#include "overrides.hpp"

#include <charconv>
#include <utility>
#include <vector>

#include "message_text.hpp"

namespace raylab {
namespace {

[[noreturn]] void usage(const std::string& location, const std::string& message) {
  throw Error(ErrorKind::usage, location, message);
}

std::vector<std::string> path_parts(const std::string& key, const std::string& location) {
  std::vector<std::string> parts(1);
  bool quoted = false;
  for (const char c : key) {
    if (c == '"') {
      quoted = !quoted;
    } else if (c == '.' && !quoted) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  for (const std::string& part : parts) {
    if (part.empty() || quoted) usage(location, "expected a path of keys joined by dots, such as camera.vfov");
  }
  return parts;
}

TomlValue value_of(const std::string& text, const std::string& location) {
  if (text.empty()) usage(location, "no value after \"=\"");
  if (auto value = parse_toml_value(text, location)) return std::move(*value);
  if (std::string_view("[{\"'").find(text.front()) != std::string_view::npos) {
    usage(location, "found " + in_quotes(text) + ", expected a TOML value");
  }
  TomlValue bare_word;
  bare_word.kind = TomlValue::Kind::string;
  bare_word.text = text;
  bare_word.location = location;
  bare_word.overridden = true;
  return bare_word;
}

TomlValue& array_item(TomlValue& array, const std::string& part, const std::string& path, const std::string& location) {
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), index);
  if (error != std::errc() || end != part.data() + part.size() || index >= array.items.size()) {
    const std::string expected = array.items.empty()
                                     ? "but it is empty"
                                     : "expected an index from 0 to " + std::to_string(array.items.size() - 1);
    usage(location, path + ": found " + in_quotes(part) + ", " + expected);
  }
  return array.items[index];
}

TomlValue& add_key(TomlValue& table, const std::string& key, TomlValue value, const std::string& location) {
  value.key = key;
  value.key_location = location;
  value.location = location;
  value.overridden = true;
  table.items.push_back(std::move(value));
  return table.items.back();
}

}  // namespace

void apply_override(TomlValue& root, const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0) {
    usage("--set " + assignment, "expected KEY=VALUE, such as camera.vfov=30");
  }
  const std::string key(trimmed(std::string_view(assignment).substr(0, equals)));
  const std::string location = "--set " + key;
  const std::vector<std::string> parts = path_parts(key, location);
  TomlValue value = value_of(std::string(trimmed(std::string_view(assignment).substr(equals + 1))), location);

  TomlValue* node = &root;
  std::string path;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const bool last = i + 1 == parts.size();
    TomlValue* child = nullptr;
    if (node->is_array()) {
      child = &array_item(*node, parts[i], path, location);
    } else if (node->is_table()) {
      child = node->find(parts[i]);
      if (child == nullptr) {
        // Only top-level tables come into being this way: a misspelt material must not become a new one.
        if (!last && node != &root) {
          usage(location, path + " has no " + in_quotes(parts[i]) + nearest_hint(parts[i], node->keys(), "one"));
        }
        child = &add_key(*node, parts[i], TomlValue{}, location);
      }
    } else {
      usage(location, path + " is " + node->found() + ": it has no " + in_quotes(parts[i]));
    }
    node = child;
    path += (i == 0 ? "" : ".") + parts[i];
  }
  value.key = node->key;
  value.key_location = node->key_location;
  *node = std::move(value);
}

}  // namespace raylab
