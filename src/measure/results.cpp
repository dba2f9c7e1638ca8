#include "raylab/measure/results.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string_view>

#include "measurement_run.hpp"
#include "raylab/core/check.hpp"
#include "raylab/core/error.hpp"
#include "raylab/core/text.hpp"

namespace raylab {

namespace fs = std::filesystem;

namespace {

constexpr const char* kJsonName = "results.json";
constexpr const char* kCsvName = "results.csv";
/// Of the format of results.json. Files without one are older than versions are, and are read as of the first.
constexpr int kVersion = 1;

/// "file:line:column" of a byte of the text.
std::string place_of(const fs::path& file, std::string_view text, std::size_t byte) {
  const std::string_view before = text.substr(0, std::min(byte > 0 ? byte - 1 : 0, text.size()));
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::size_t start = before.rfind('\n');
  const std::size_t column = 1 + before.size() - (start == std::string_view::npos ? 0 : start + 1);
  return file.string() + ":" + std::to_string(line) + ":" + std::to_string(column);
}

Row parse(const fs::path& file, const std::string& text) {
  // The parser and its callback know no places, but the stream knows how far they came.
  std::istringstream stream(text);
  const auto read = [&] {
    return static_cast<std::size_t>(stream.rdbuf()->pubseekoff(0, std::ios::cur, std::ios::in));
  };
  // What comes after the parser, copies to begin with, recurs.
  constexpr int most_levels = 32;
  const auto check_depth = [&](int depth, Row::parse_event_t event, const Row&) {
    const bool opens = event == Row::parse_event_t::array_start || event == Row::parse_event_t::object_start;
    if (opens && depth >= most_levels) {
      throw Error(ErrorKind::input, place_of(file, text, read()), format("nested more than %d deep", most_levels));
    }
    return true;
  };
  try {
    return Row::parse(stream, check_depth);
  } catch (const Row::out_of_range&) {
    const std::size_t last = text.find_last_of("0123456789", read() - 1);
    const std::size_t first = text.find_last_not_of("+-.0123456789eE", last) + 1;
    throw Error(
        ErrorKind::input, place_of(file, text, first + 1),
        "found " + text.substr(first, std::min<std::size_t>(last + 1 - first, 80)) + ", which is no finite number");
  } catch (const Row::parse_error& e) {
    const bool truncated = e.byte > text.size();
    throw Error(ErrorKind::input, place_of(file, text, e.byte),
                truncated ? "the JSON ends here in the middle: is the file truncated?" : "this is not JSON");
  }
}

void expect(bool condition, const fs::path& file, const std::string& where, const char* expected) {
  if (!condition) throw Error(ErrorKind::input, file.string(), where + ": expected " + expected);
}

/// Refuses files of a later version.
void check_version(const Row& document, const fs::path& file) {
  if (!document.contains("version")) return;
  const Row& version = document["version"];
  expect(version.is_number_integer() && version >= 1, file, "version", "an integer, at least 1");
  if (version > kVersion) {
    throw Error(
        ErrorKind::input, file.string(),
        "its results are of format version " + version.dump() + ", and this program reads " + std::to_string(kVersion));
  }
}

void check_rows(const Row& rows, const fs::path& file) {
  expect(rows.is_array(), file, "rows", "an array");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::string fault = row_fault(rows[i]);
    if (!fault.empty()) throw Error(ErrorKind::input, file.string(), "rows[" + std::to_string(i) + "]: " + fault);
  }
}

bool is_finite(const Row& value) {
  if (value.is_object()) return std::all_of(value.begin(), value.end(), is_finite);
  return !value.is_number_float() || std::isfinite(value.get<double>());
}

Row without_infinities(const Row& row) {
  Row finite;
  for (const auto& [name, value] : row.items()) {
    if (is_finite(value)) finite[name] = value;
  }
  return finite;
}

/// Whether a row without the field means the same, as rows do that were measured before there was a choice of
/// quality: all were balanced, but for steps of the ladder, whose name says it.
bool is_implied(const Row& row, const std::string& field) {
  return field == "quality" && (row[field] == "balanced" || row.contains("step"));
}

std::string csv_cell(const Row& value) {
  std::string text = value.is_string() ? value.get<std::string>() : value.dump();
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

fs::path made(fs::path folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw Error(ErrorKind::output, folder.string(), "cannot be made: " + error.message());
  return folder;
}

}  // namespace

std::string row_key(const Row& row) {
  std::string key;
  for (const RowField& field : row_fields()) {
    if (!field.is_key || !row.contains(field.name) || is_implied(row, field.name)) continue;
    if (!key.empty()) key += ' ';
    key.append(field.name).append("=").append(csv_cell(row[field.name]));
  }
  return key;
}

bool has_values(const Row& row, const Row& values) {
  for (const auto& value : values.items()) {
    if (!row.contains(value.key()) || row[value.key()] != value.value()) return false;
  }
  return true;
}

Results read_results(const fs::path& folder) {
  const fs::path file = folder / kJsonName;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw Error(ErrorKind::input, file.string(), "cannot be read: is this a folder of results?");
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  const Row document = parse(file, text);
  expect(document.is_object(), file, "the document", "an object with \"machine\" and \"rows\"");
  check_version(document, file);
  expect(document.contains("machine") && document["machine"].is_object(), file, "machine", "an object");
  expect(document.contains("rows"), file, "rows", "an array");
  check_rows(document["rows"], file);
  Results results{document["machine"], {}, document["rows"]};
  if (document.contains("runs")) {
    const Row& runs = document["runs"];
    expect(runs.is_array() && std::all_of(runs.begin(), runs.end(), [](const Row& r) { return r.is_object(); }), file,
           "runs", "an array of objects");
    results.runs = document["runs"].get<std::vector<Row>>();
  }
  return results;
}

std::string to_csv(const std::vector<Row>& rows) {
  std::vector<Row::json_pointer> columns;
  std::string csv;
  const auto add_cell = [&](std::size_t column, const std::string& cell) { csv += (column > 0 ? "," : "") + cell; };
  const auto add_column = [&](const std::string& name, const Row::json_pointer& place) {
    add_cell(columns.size(), name);
    columns.push_back(place);
  };
  for (const RowField& field : row_fields()) {
    if (std::none_of(rows.begin(), rows.end(), [&](const Row& row) { return row.contains(field.name); })) continue;
    const auto place = Row::json_pointer() / field.name;
    if (field.parts.empty()) add_column(field.name, place);
    for (const std::string& part : field.parts) add_column(field.name + "." + part, place / part);
  }
  csv += "\r\n";
  for (const Row& row : rows) {
    for (std::size_t i = 0; i < columns.size(); ++i)
      add_cell(i, row.contains(columns[i]) ? csv_cell(row[columns[i]]) : "");
    csv += "\r\n";
  }
  return csv;
}

ResultsFolder::ResultsFolder(fs::path folder, const std::string& suite, const std::string& command, bool resume)
    : folder_(made(std::move(folder))), lock_(folder_) {
  check_writable(folder_ / kJsonName);
  check_writable(folder_ / kCsvName);
  if (fs::exists(folder_ / kJsonName)) results_ = read_results(folder_);
  const Row here = describe_machine();
  if (!results_.rows.empty() && !same_machine(results_.machine, here)) {
    throw Error(ErrorKind::usage, folder_.string(), "holds results of another machine; choose another folder");
  }
  results_.machine = here;
  resumed_ = begin_run(results_.runs, suite, command, resume, folder_);
  for (const std::string& key : keys_under_way(results_.runs.back()))
    std::erase_if(results_.rows, [&](const Row& row) { return row_key(row) == key; });
}

bool ResultsFolder::measured(const std::string& part) const {
  return resumed_ && has_measured(results_.runs.back(), part);
}

void ResultsFolder::note_scene(const std::string& file, std::uint64_t hash) {
  raylab::note_scene(results_.runs.back(), file, hash);
}

void ResultsFolder::add(const std::vector<Row>& rows, const std::string& part) {
  for (const Row& measured : rows) {
    const Row row = without_infinities(measured);
    if (const std::string fault = row_fault(row); !fault.empty())
      detail::check_failed((row.dump() + ": " + fault).c_str(), __FILE__, __LINE__);
    const std::string key = row_key(row);
    const auto old =
        std::find_if(results_.rows.begin(), results_.rows.end(), [&](const Row& r) { return row_key(r) == key; });
    if (old != results_.rows.end()) {
      *old = row;
    } else {
      results_.rows.push_back(row);
    }
    note_row(results_.runs.back(), key);
  }
  if (!part.empty()) note_part(results_.runs.back(), part);
  write();
}

void ResultsFolder::remove(const Row& values) {
  std::erase_if(results_.rows, [&](const Row& row) { return has_values(row, values); });
}

void ResultsFolder::finish() {
  finish_run(results_.runs.back());
  write();
}

void ResultsFolder::write() const {
  // Names on a command line need not be UTF-8, which JSON is.
  const auto json_text = [](const Row& row) { return row.dump(-1, ' ', false, Row::error_handler_t::replace); };
  // One row a line: version control then shows what changed.
  const auto lines = [&](const std::vector<Row>& rows) {
    std::string text = "[";
    for (std::size_t i = 0; i < rows.size(); ++i) text += (i > 0 ? ",\n  " : "\n  ") + json_text(rows[i]);
    return text + (rows.empty() ? "]" : "\n ]");
  };
  // Before there are files, as where memory is out it may not throw.
  const std::string document =
      "{\n \"version\": " + std::to_string(kVersion) + ",\n \"machine\": " + json_text(results_.machine) +
      ",\n \"runs\": " + lines(results_.runs) + ",\n \"rows\": " + lines(results_.rows) + "\n}\n";
  const std::string table = to_csv(results_.rows);
  AtomicFile json(folder_ / kJsonName);
  json.stream() << document;
  AtomicFile csv(folder_ / kCsvName);
  csv.stream() << table;
  json.commit();
  csv.commit();
}

}  // namespace raylab
