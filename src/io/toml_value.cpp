#include "toml_value.hpp"

// toml++ asserts what does not hold of all texts ("[,"), and lets the compiler rely on it in builds without asserts.
// Without its asserts, its parser goes on to tell the error.
#undef NDEBUG
#define TOML_ASSERT(condition) static_cast<void>(0)
#define TOML_MAX_NESTED_VALUES 32
#include <toml++/toml.h>

#include <algorithm>
#include <sstream>
#include <tuple>

#include "message_text.hpp"
#include "toml_text.hpp"

namespace raylab {
namespace {

std::string location_text(const std::string& file, const toml::source_position& position) {
  return file + ":" + std::to_string(position.line) + ":" + std::to_string(position.column);
}

TomlValue converted(const toml::node& node, const std::string& file) {
  TomlValue value;
  value.location = location_text(file, node.source().begin);
  node.visit([&](const auto& typed) {
    using Kind = TomlValue::Kind;
    if constexpr (toml::is_table<decltype(typed)>) {
      value.kind = Kind::table;
      std::vector<std::tuple<toml::source_position, const toml::key*, const toml::node*>> entries;
      for (const auto& [key, child] : typed) entries.emplace_back(key.source().begin, &key, &child);
      std::sort(entries.begin(), entries.end(),
                [](const auto& a, const auto& b) { return std::get<0>(a) < std::get<0>(b); });
      for (const auto& [position, key, child] : entries) {
        value.items.push_back(converted(*child, file));
        value.items.back().key = std::string(key->str());
        value.items.back().key_location = location_text(file, position);
      }
    } else if constexpr (toml::is_array<decltype(typed)>) {
      value.kind = Kind::array;
      for (const toml::node& child : typed) value.items.push_back(converted(child, file));
    } else if constexpr (toml::is_string<decltype(typed)>) {
      value.kind = Kind::string;
      value.text = *typed;
    } else if constexpr (toml::is_integer<decltype(typed)>) {
      value.kind = Kind::integer;
      value.integer = *typed;
    } else if constexpr (toml::is_floating_point<decltype(typed)>) {
      value.kind = Kind::real;
      value.real = *typed;
    } else if constexpr (toml::is_boolean<decltype(typed)>) {
      value.kind = Kind::boolean;
      value.boolean = *typed;
    } else {
      value.kind = Kind::date;
      std::ostringstream text;
      text << *typed;
      value.text = text.str();
    }
  });
  return value;
}

void mark_overridden(TomlValue& value, const std::string& location) {
  value.location = location;
  value.key_location = location;
  value.overridden = true;
  for (TomlValue& item : value.items) mark_overridden(item, location);
}

}  // namespace

const TomlValue* TomlValue::find(std::string_view name) const {
  if (!is_table()) return nullptr;
  const auto entry = std::find_if(items.begin(), items.end(), [&](const TomlValue& v) { return v.key == name; });
  return entry == items.end() ? nullptr : &*entry;
}

TomlValue* TomlValue::find(std::string_view name) {
  return const_cast<TomlValue*>(static_cast<const TomlValue*>(this)->find(name));
}

std::vector<std::string> TomlValue::keys() const {
  std::vector<std::string> names;
  for (const TomlValue& item : items) names.push_back(item.key);
  return names;
}

std::string TomlValue::found() const {
  switch (kind) {
    case Kind::boolean:
      return boolean ? "true" : "false";
    case Kind::integer:
      return std::to_string(integer);
    case Kind::real:
      return number_text(real);
    case Kind::string:
      return in_quotes(text);
    case Kind::date:
      return text;
    case Kind::table:
      return "a table";
    case Kind::array:
      break;
  }
  constexpr std::size_t most_shown = 8;
  std::string list;
  for (std::size_t i = 0; i < std::min(items.size(), most_shown); ++i) {
    list += (i == 0 ? "" : ", ") + items[i].found();
  }
  return "[" + list + (items.size() > most_shown ? ", ...]" : "]");
}

void TomlValue::fail(const std::string& path, const std::string& expected) const {
  fail_here(path + ": found " + found() + ", expected " + expected);
}

void TomlValue::fail_here(const std::string& message) const {
  throw Error(overridden ? ErrorKind::usage : ErrorKind::input, location, message);
}

void TomlValue::fail_at_key(const std::string& message) const {
  throw Error(overridden ? ErrorKind::usage : ErrorKind::input, key_location, message);
}

TomlValue parse_toml(std::string_view text, const std::string& file) {
  check_toml_text(text, file);
  try {
    // Where the text ends in the middle of a value, toml++ makes a null pointer of it.
    return converted(toml::parse(std::string(text) + '\n'), file);
  } catch (const toml::parse_error& error) {
    throw Error(ErrorKind::input, location_text(file, error.source().begin), on_one_line(error.description()));
  }
}

std::optional<TomlValue> parse_toml_value(std::string_view text, const std::string& location) {
  const std::string document = "value = " + std::string(text) + '\n';
  try {
    check_toml_text(document, location);
    const toml::table table = toml::parse(document);
    // A line break in the text could have smuggled in further keys.
    if (table.size() != 1) return std::nullopt;
    TomlValue value = converted(*table.get("value"), location);
    mark_overridden(value, location);
    return value;
  } catch (const toml::parse_error&) {
    return std::nullopt;
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace raylab
