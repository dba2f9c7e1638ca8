#pragma once
// Measurement rows and the folder they are kept in: results.json, and the same rows as results.csv.
#include <filesystem>
#include <string>
#include <vector>

#include "raylab/core/atomic_file.hpp"
#include "raylab/measure/row_schema.hpp"

namespace raylab {

/// Everything measured on one machine.
struct Results {
  Row machine;            ///< see describe_machine()
  std::vector<Row> runs;  ///< what was run: suite, command, date (UTC), and whether it came to its end
  std::vector<Row> rows;
};

/// Processor, threads, memory, system, compiler and version of this program.
Row describe_machine();

/// Whether times of the two may be compared: same processor, threads and memory.
bool same_machine(const Row& a, const Row& b);

/// What a row measures, without what was measured: equal for two rows that can be compared.
std::string row_key(const Row& row);

/// Reads results.json of the folder. Throws Error (input) with file:line:column for broken JSON, and with the
/// place inside the document, row and field, for what does not conform to the schema.
Results read_results(const std::filesystem::path& folder);

/// The rows as CSV (RFC 4180), a column for each field that any of them has, in the order of the schema; parts of
/// a field as `mrays_per_second.median`.
std::string to_csv(const std::vector<Row>& rows);

/// The results of a folder while they are added to. What is there already stays, except that a row takes the place
/// of one with the same key: a folder holds the latest measurement of each. Both files are replaced whole whenever
/// rows come in, so that an interrupted run leaves what it measured; and the folder is locked meanwhile, as of two that
/// write to one each would replace the rows of the other.
class ResultsFolder {
 public:
  /// Makes the folder if need be. Throws Error (output) when it cannot be written or another is writing there, and
  /// Error (usage) when it holds the results of another machine.
  ResultsFolder(std::filesystem::path folder, const std::string& suite, const std::string& command);

  /// Rows that conform to the schema, which is an invariant. A number that is not finite, which JSON does not
  /// have, is left out.
  void add(const std::vector<Row>& rows);

  /// Removes the rows that have all these values, with the next rows that are added.
  void remove(const Row& values);

  /// Notes that the run came to its end.
  void finish();

  const std::filesystem::path& path() const { return folder_; }
  const Results& results() const { return results_; }

 private:
  void write() const;

  std::filesystem::path folder_;
  FolderLock lock_;
  Results results_;
  std::string command_;
};

}  // namespace raylab
