#pragma once
// What every suite of raylab-bench has in common.
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "commands.hpp"
#include "raylab/accel/accelerator.hpp"
#include "raylab/core/interrupt.hpp"
#include "raylab/core/progress.hpp"
#include "raylab/core/text.hpp"
#include "raylab/io/scene_file.hpp"
#include "raylab/measure/results.hpp"
#include "raylab/measure/statistics.hpp"

namespace raylab::bench {

/// The run was interrupted; what was measured is written, if anything was.
struct Interrupted {};

/// One run of a suite: where its rows go, and how far it has come.
class Suite {
 public:
  /// Throws as ResultsFolder's constructor.
  Suite(const CommonOptions& options, const std::string& name);

  /// Work to be done in all, in any unit, and work done since the last call.
  void expect(double work) { expected_ += work; }
  void advance(double work) { done_ += work; }

  /// Shows the progress; throws Interrupted when the user wants to stop. `ahead` is work under way.
  void check(double ahead = 0.0);

  /// Whether a part was measured before the run that is gone on with was interrupted. Its work is then done.
  bool measured(const std::string& part, double work = 0.0);

  /// Writes the rows to the folder, and a line on standard output for each. See ResultsFolder::add for parts.
  void add(const std::vector<Row>& rows, const std::vector<std::string>& lines, const std::string& part = "");
  void end_part(const std::string& part) { add({}, {}, part); }

  /// A line on standard error, the bar out of the way.
  void note(const std::string& line);

  void finish();

  ResultsFolder& folder() { return folder_; }
  const ResultsFolder& folder() const { return folder_; }

  /// Whether rows were written, in this process.
  static bool any_written();

 private:
  ResultsFolder folder_;
  Progress progress_;
  double expected_ = 0.0;
  double done_ = 0.0;
};

/// Loads the scene, telling its warnings; its name is that of the file without folder and ending. Throws Error (input)
/// where it is not the scene of the run that is gone on with.
LoadedScene load(Suite& suite, const std::string& file, const std::vector<std::string>& overrides = {});

/// An accelerator and, where it has a choice, its triangle test and how it is built.
struct Variant {
  std::string accel;
  std::string intersector;              ///< empty: its default, or the accelerator has no choice
  std::optional<BuildQuality> quality;  ///< absent: the accelerator has no choice
  bool compact = false;

  std::string name() const;  ///< see variant_name
  AcceleratorOptions options(int threads) const;
  std::vector<std::string> arguments() const;  ///< of raylab-render, which choose it
};

/// The accelerators named, or all but the exact one, with each of the qualities named, or the default, and each of
/// the intersectors named, or all, or with `all_intersectors` off the accelerator's default: what it has a choice
/// of. Throws Error (usage) for unknown names.
std::vector<Variant> variants(const CommonOptions& options, bool all_intersectors = true);

/// The same, but where no accelerator is named of the default one alone, and of default triangle tests.
std::vector<Variant> variants_or_default(CommonOptions options);

/// Whether scenes of so many primitives are not too large for it.
bool is_fit(const Variant& variant, std::size_t primitives);

/// Builds it, several times while that takes no time worth saving.
struct Built {
  Variant variant;
  std::unique_ptr<Accelerator> accelerator;
  Spread build_seconds;
};
Built build(const Variant& variant, const Geometry& geometry, int threads);
/// The same, of an accelerator that has no name, or with options that a Variant does not tell.
Built build(const Variant& variant, const AcceleratorFactory& make, const Geometry& geometry,
            const AcceleratorOptions& options);

/// Fields of a row that name the variant.
void add_fields(Row& row, const Variant& variant);
/// The variant that those fields name, for people: balanced quality, which is usual, is left out.
std::string variant_name(const Row& row);
/// The same, and those that the accelerator brings along.
void add_fields(Row& row, const Variant& variant, const Geometry& geometry, const Built& built);

void add_build_times(Row& row, const Spread& seconds);

Row to_row(const Spread& spread);

}  // namespace raylab::bench
