#pragma once
// Measurement rows and the folder they are kept in: results.json, and the same rows as results.csv.
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "raylab/core/atomic_file.hpp"
#include "raylab/measure/row_schema.hpp"

namespace raylab {

/// Everything measured on one machine.
struct Results {
  Row machine;  ///< see describe_machine()
  /// What was run: suite, command, date (UTC), version, hashes of scenes, whether it came to its end and, where it did
  /// not, which parts of it are measured.
  std::vector<Row> runs;
  std::vector<Row> rows;
};

/// Processor, threads, memory, system, compiler and version of this program.
Row describe_machine();

/// Whether times of the two may be compared: same processor, threads and memory.
bool same_machine(const Row& a, const Row& b);

/// What a row measures, without what was measured: equal for two rows that can be compared.
std::string row_key(const Row& row);

/// Whether the row has all fields of the other one, with their values.
bool has_values(const Row& row, const Row& values);

/// Reads results.json of the folder. Throws Error (input) with file:line:column for broken JSON, with the place inside
/// the document, row and field, for what does not conform to the schema, and for a later version of the format.
Results read_results(const std::filesystem::path& folder);

/// The rows as CSV (RFC 4180), a column for each field that any of them has, in the order of the schema; parts of
/// a field as `mrays_per_second.median`.
std::string to_csv(const std::vector<Row>& rows);

/// The results of a folder while they are added to. What is there already stays, except that a row takes the place
/// of one with the same key: a folder holds the latest measurement of each. Both files are replaced whole whenever
/// rows come in, so that an interrupted run leaves what it measured; and the folder is locked meanwhile, as of two that
/// write to one each would replace the rows of the other.
///
/// A run consists of parts, by names of the suite's own. One that was interrupted is gone on with at the first part
/// that was not measured whole, and its folder ends with the rows of a run that was not.
class ResultsFolder {
 public:
  /// Makes the folder if need be. With `resume` the run of the same command is gone on with, if the folder has one.
  /// Throws Error (output) when it cannot be written or another is writing there, and Error (usage) when it holds the
  /// results of another machine, or a run to go on with that differs in its version or its command.
  ResultsFolder(std::filesystem::path folder, const std::string& suite, const std::string& command,
                bool resume = false);

  /// Whether a run is gone on with, and whether it has measured the part: always where it came to its end.
  bool resumed() const { return resumed_; }
  bool measured(const std::string& part) const;

  /// Rows that conform to the schema, which is an invariant. A number that is not finite, which JSON does not
  /// have, is left out. A `part` that is named is measured herewith: its rows are those added since the part before.
  void add(const std::vector<Row>& rows, const std::string& part = "");

  /// Notes the hash of a scene that the run measures. Throws Error (input) when a run that is gone on with knows it by
  /// another.
  void note_scene(const std::string& file, std::uint64_t hash);

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
  bool resumed_ = false;
};

}  // namespace raylab
