#include "raylab/measure/results.hpp"

#include <algorithm>
#include <array>
#include <ctime>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string_view>

#include "raylab/core/atomic_file.hpp"
#include "raylab/core/error.hpp"

namespace raylab {

namespace fs = std::filesystem;

namespace {

constexpr const char* kJsonName = "results.json";
constexpr const char* kCsvName = "results.csv";

// The fields that say what a row measures; all others say what came out.
constexpr std::array kKeyFields{"suite",     "scene",   "family",     "renderer", "accel",         "intersector",
                                "quality",   "compact", "integrator", "sampler",  "needs",         "rays",
                                "step",      "threads", "triangles",  "width",    "height",        "spp",
                                "max_depth", "segment", "question",   "case",     "target_relmse", "value"};

std::string utc_date() {
  const std::time_t now = std::time(nullptr);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", std::gmtime(&now));
  return text;
}

/// "file:line:column" of a byte of the text.
std::string place_of(const fs::path& file, std::string_view text, std::size_t byte) {
  const std::string_view before = text.substr(0, std::min(byte > 0 ? byte - 1 : 0, text.size()));
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::size_t start = before.rfind('\n');
  const std::size_t column = 1 + before.size() - (start == std::string_view::npos ? 0 : start + 1);
  return file.string() + ":" + std::to_string(line) + ":" + std::to_string(column);
}

Row parse(const fs::path& file, const std::string& text) {
  try {
    return Row::parse(text);
  } catch (const Row::parse_error& e) {
    const bool truncated = e.byte > text.size();
    throw Error(ErrorKind::input, place_of(file, text, e.byte),
                truncated ? "the JSON ends here in the middle: is the file truncated?" : "this is not JSON");
  }
}

void expect(bool condition, const fs::path& file, const std::string& where, const char* expected) {
  if (!condition) throw Error(ErrorKind::input, file.string(), where + ": expected " + expected);
}

void check_rows(const Row& rows, const fs::path& file, const std::string& name) {
  expect(rows.is_array(), file, name, "an array");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::string where = name + "[" + std::to_string(i) + "]";
    expect(rows[i].is_object(), file, where, "an object");
    expect(rows[i].contains("suite") && rows[i]["suite"].is_string(), file, where, "a text \"suite\"");
  }
}

/// Fields of a row with those of objects in it, by name.
std::vector<std::pair<std::string, Row>> flattened(const Row& row) {
  std::vector<std::pair<std::string, Row>> fields;
  for (const auto& [name, value] : row.items()) {
    if (value.is_object()) {
      for (const auto& [inner, x] : value.items()) fields.emplace_back(name + "." + inner, x);
    } else {
      fields.emplace_back(name, value);
    }
  }
  return fields;
}

/// Whether rows of before there was a choice of quality mean the same without the field: all were balanced, but
/// for steps of the ladder, whose name says it.
bool is_implied(const Row& row, std::string_view field) {
  return field == "quality" && (row[field] == "balanced" || row.contains("step"));
}

std::string csv_cell(const Row& value) {
  const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

}  // namespace

std::string row_key(const Row& row) {
  std::string key;
  for (const char* field : kKeyFields) {
    if (!row.contains(field) || is_implied(row, field)) continue;
    if (!key.empty()) key += ' ';
    key.append(field).append("=").append(csv_cell(row[field]));
  }
  return key;
}

Results read_results(const fs::path& folder) {
  const fs::path file = folder / kJsonName;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw Error(ErrorKind::input, file.string(), "cannot be read: is this a folder of results?");
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  const Row document = parse(file, text);
  expect(document.is_object(), file, "the document", "an object with \"machine\" and \"rows\"");
  expect(document.contains("machine") && document["machine"].is_object(), file, "machine", "an object");
  expect(document.contains("rows"), file, "rows", "an array");
  check_rows(document["rows"], file, "rows");
  Results results{document["machine"], {}, document["rows"]};
  if (document.contains("runs")) {
    check_rows(document["runs"], file, "runs");
    results.runs = document["runs"].get<std::vector<Row>>();
  }
  return results;
}

std::string to_csv(const std::vector<Row>& rows) {
  std::vector<std::string> columns;
  for (const Row& row : rows) {
    std::size_t after = 0;  // new columns go beside their neighbours in the row, not to the end
    for (const auto& [name, value] : flattened(row)) {
      auto column = std::find(columns.begin(), columns.end(), name);
      if (column == columns.end())
        column = columns.insert(columns.begin() + static_cast<std::ptrdiff_t>(after), name);
      after = static_cast<std::size_t>(column - columns.begin()) + 1;
    }
  }
  std::ostringstream csv;
  for (std::size_t i = 0; i < columns.size(); ++i) csv << (i > 0 ? "," : "") << columns[i];
  csv << "\r\n";
  for (const Row& row : rows) {
    const auto fields = flattened(row);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (i > 0) csv << ",";
      const auto field =
          std::find_if(fields.begin(), fields.end(), [&](const auto& f) { return f.first == columns[i]; });
      if (field != fields.end()) csv << csv_cell(field->second);
    }
    csv << "\r\n";
  }
  return csv.str();
}

ResultsFolder::ResultsFolder(fs::path folder, const std::string& suite, const std::string& command)
    : folder_(std::move(folder)), command_(command) {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) throw Error(ErrorKind::output, folder_.string(), "cannot be made: " + error.message());
  check_writable(folder_ / kJsonName);
  check_writable(folder_ / kCsvName);
  if (fs::exists(folder_ / kJsonName)) results_ = read_results(folder_);
  const Row here = describe_machine();
  if (!results_.rows.empty() && !same_machine(results_.machine, here)) {
    throw Error(ErrorKind::usage, folder_.string(), "holds results of another machine; choose another folder");
  }
  results_.machine = here;
  std::erase_if(results_.runs, [&](const Row& run) { return run.value("command", "") == command; });
  results_.runs.push_back({{"suite", suite}, {"command", command}, {"date", utc_date()}, {"complete", false}});
}

void ResultsFolder::add(const std::vector<Row>& rows) {
  for (const Row& row : rows) {
    const std::string key = row_key(row);
    const auto old =
        std::find_if(results_.rows.begin(), results_.rows.end(), [&](const Row& r) { return row_key(r) == key; });
    if (old != results_.rows.end()) {
      *old = row;
    } else {
      results_.rows.push_back(row);
    }
  }
  write();
}

void ResultsFolder::finish() {
  results_.runs.back()["complete"] = true;
  write();
}

void ResultsFolder::write() const {
  // One row a line: version control then shows what changed.
  const auto lines = [](const std::vector<Row>& rows) {
    std::string text = "[";
    for (std::size_t i = 0; i < rows.size(); ++i) text += (i > 0 ? ",\n  " : "\n  ") + rows[i].dump();
    return text + (rows.empty() ? "]" : "\n ]");
  };
  AtomicFile json(folder_ / kJsonName);
  json.stream() << "{\n \"machine\": " << results_.machine.dump() << ",\n \"runs\": " << lines(results_.runs)
                << ",\n \"rows\": " << lines(results_.rows) << "\n}\n";
  AtomicFile csv(folder_ / kCsvName);
  csv.stream() << to_csv(results_.rows);
  json.commit();
  csv.commit();
}

}  // namespace raylab
