#pragma once
#include "raylab/core/timing.hpp"

namespace raylab {

enum class ProgressKind { automatic, lines, json, none };

/// Shows how far a run has come, on standard error: a bar on a terminal, else a line every 10 s, or JSON lines.
class Progress {
 public:
  explicit Progress(ProgressKind kind);

  /// Call often; prints when it is time to.
  void update(double fraction);

  /// Clears the bar, or prints the last line.
  void finish(double fraction);

 private:
  void print(double fraction);

  enum class Style { bar, lines, json, none } style_;
  Stopwatch watch_;
  double last_ = 0.0;
};

}  // namespace raylab
