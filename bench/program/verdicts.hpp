#pragma once
// What a continuous integration system is told: which figures passed, and which are too bad.
#include <optional>
#include <string>
#include <vector>

namespace raylab::bench {

/// What makes a command exit with 1.
struct FailOn {
  std::optional<double> slower;  ///< from this share on, such as 0.05
  bool wrong = false;            ///< an answer that is wrong, or wrong more often than before
};

/// Reads "slower=5%" and "wrong". Throws Error (usage) at anything else.
FailOn parse_fail_on(const std::vector<std::string>& parts);

struct Verdict {
  std::string name;     ///< what was judged
  std::string failure;  ///< empty where it passed
};

/// Writes the verdicts to `junit` as a test suite in the XML of JUnit, where a file is named, and the failures on
/// standard error. Returns the exit code: 1 when one failed, else 0. Throws Error (output) as AtomicFile does.
int conclude(const std::string& suite, const std::vector<Verdict>& verdicts, const std::string& junit);

}  // namespace raylab::bench
