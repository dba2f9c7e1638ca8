#include "raylab/measure/row_schema.hpp"

#include <algorithm>
#include <map>

namespace raylab {

namespace {

constexpr const char* kSchema =
#include "row_schema_text.inc"
    ;

RowFieldType parse_type(const std::string& name) {
  static const std::map<std::string, RowFieldType> kTypes{{"string", RowFieldType::string},
                                                          {"strings", RowFieldType::strings},
                                                          {"boolean", RowFieldType::boolean},
                                                          {"integer", RowFieldType::integer},
                                                          {"number", RowFieldType::number}};
  return kTypes.at(name);
}

std::vector<RowField> parse_fields() {
  const Row schema = Row::parse(kSchema);
  std::vector<RowField> fields;
  for (const Row& field : schema["fields"]) {
    const auto list = [&](const char* name) { return field.value(name, std::vector<std::string>()); };
    fields.push_back(
        {field["name"], parse_type(field["type"]), field.value("key", false), list("parts"), list("suites")});
  }
  return fields;
}

bool has_type(const Row& value, RowFieldType type) {
  switch (type) {
    case RowFieldType::string:
      return value.is_string();
    case RowFieldType::strings:
      return value.is_array() && std::all_of(value.begin(), value.end(), [](const Row& v) { return v.is_string(); });
    case RowFieldType::boolean:
      return value.is_boolean();
    case RowFieldType::integer:
      return value.is_number_integer();
    case RowFieldType::number:
      return value.is_number();
  }
  return false;
}

std::string type_text(RowFieldType type) {
  switch (type) {
    case RowFieldType::string:
      return "a string";
    case RowFieldType::strings:
      return "an array of strings";
    case RowFieldType::boolean:
      return "true or false";
    case RowFieldType::integer:
      return "an integer";
    case RowFieldType::number:
      return "a number";
  }
  return "";
}

bool conforms(const Row& value, const RowField& field) {
  if (field.parts.empty()) return has_type(value, field.type);
  return value.is_object() && value.size() == field.parts.size() &&
         std::all_of(field.parts.begin(), field.parts.end(), [&](const std::string& part) {
           return value.contains(part) && has_type(value[part], field.type);
         });
}

std::string expected_text(const RowField& field) {
  std::string text = type_text(field.type);
  for (std::size_t i = 0; i < field.parts.size(); ++i) text += (i == 0 ? " for each of " : ", ") + field.parts[i];
  return text;
}

}  // namespace

std::span<const RowField> row_fields() {
  static const std::vector<RowField> kFields = parse_fields();
  return kFields;
}

std::string row_fault(const Row& row) {
  if (!row.is_object()) return "expected an object";
  if (!row.contains("suite")) return "suite: expected a string";
  for (const auto& item : row.items()) {
    const std::string& name = item.key();
    const auto fields = row_fields();
    const auto field = std::find_if(fields.begin(), fields.end(), [&](const RowField& f) { return f.name == name; });
    if (field == fields.end()) return name + ": no field of the schema";
    if (!conforms(item.value(), *field)) return name + ": expected " + expected_text(*field);
    const auto& suites = field->suites;
    const auto named = [&](const std::string& suite) { return row["suite"] == suite; };
    if (!suites.empty() && std::none_of(suites.begin(), suites.end(), named))
      return name + ": no field of the suite " + row["suite"].dump();
  }
  return "";
}

}  // namespace raylab
