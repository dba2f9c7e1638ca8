#pragma once
// The entry of a run in results.json: what was run, and which parts of it are measured, so that it can be gone on with.
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "raylab/measure/row_schema.hpp"

namespace raylab {

/// Makes the last of the runs that of this command: a new one in the place of an older one or, where it is resumed, the
/// older one itself. Options in another order make no other command, nor do --out and --resume. Throws Error (usage,
/// placed at the folder) where the run to be resumed is of another version, or where the folder has none of the command
/// but an interrupted one of the suite, naming what they differ in. Returns whether a run is gone on with.
bool begin_run(std::vector<Row>& runs, const std::string& suite, const std::string& command, bool resume,
               const std::filesystem::path& folder);

/// Whether a part was measured before the run was interrupted: all of them where it was not.
bool has_measured(const Row& run, const std::string& part);

/// The rows of what was under way are part of nothing yet: begun again, it may have others.
std::vector<std::string> keys_under_way(const Row& run);

/// Notes a row by its key, and a part whose rows are those that came since the part before.
void note_row(Row& run, const std::string& key);
void note_part(Row& run, const std::string& part);

/// Notes the hash of a scene that is measured. Throws Error (input) where the run knows it by another hash.
void note_scene(Row& run, const std::string& file, std::uint64_t hash);

/// Notes that the run came to its end.
void finish_run(Row& run);

}  // namespace raylab
