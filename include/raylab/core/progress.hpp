#pragma once
#include <atomic>
#include <optional>
#include <string>

#include "raylab/core/timing.hpp"

namespace raylab {

enum class ProgressKind { automatic, lines, json, none };

/// Shows how far a run has come, on standard error: a bar on a terminal, else a line every 10 s, or JSON lines.
class Progress {
 public:
  /// `done`: the fraction that an earlier run has left, whose time says nothing of this one's.
  explicit Progress(ProgressKind kind, double done = 0.0);

  /// Call often; prints when it is time to. `share`, here and below: of the time that this run takes, where it is known
  /// better than by what was done of all.
  void update(double fraction, std::optional<double> share = {});

  /// The estimated relMSE of what is done, which is shown from now on. From any thread.
  void set_error(double relmse, bool reliable) { error_ = reliable ? relmse : -relmse; }

  /// Prints a line now, whatever the kind, as SIGUSR1 asks for.
  void say(double fraction, std::optional<double> share = {}) const;

  /// Seconds that the whole run is expected to take; infinity while nothing is done.
  double expected_seconds(double fraction, std::optional<double> share = {}) const;

  /// Clears the bar, or prints the last line.
  void finish(double fraction);

 private:
  void print(double fraction, std::optional<double> share) const;
  /// "BEFORE0.0012", and where it is not reliable so much; empty where it is not known.
  std::string error_text(const char* before) const;

  enum class Style { bar, lines, json, none } style_;
  double done_;
  Stopwatch watch_;
  double last_ = 0.0;
  std::atomic<double> error_{0.0};  // negative: not reliable; 0: not known
};

}  // namespace raylab
