#pragma once
// What a measurement row may hold: one schema, bench/report/schema.json, which is compiled in and which the charts
// read too.
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

namespace raylab {

/// One measurement: an object of the fields that the schema names. `suite` is always there; a field that does not
/// apply is absent.
using Row = nlohmann::ordered_json;

enum class RowFieldType { string, strings, boolean, integer, number };

/// A field that a row may have.
struct RowField {
  std::string name;
  RowFieldType type;
  bool is_key;                      ///< says what was measured, not what came out: see row_key
  std::vector<std::string> parts;   ///< of an object of such values, such as median, min and max; none: one value
  std::vector<std::string> suites;  ///< that have the field; none: all
};

/// The fields of the schema, in its order.
std::span<const RowField> row_fields();

/// What keeps the row from conforming to the schema, such as "spp: expected an integer"; empty when it conforms.
std::string row_fault(const Row& row);

}  // namespace raylab
