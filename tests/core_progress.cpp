#include <chrono>
#include <cmath>
#include <thread>

#include "catch.hpp"
#include "raylab/core/progress.hpp"

using namespace raylab;

TEST_CASE("the time that is left goes by what was done of all, and not by what an earlier run did", "[unit][core]") {
  for (const double before : {0.0, 0.25}) {
    const Stopwatch outer;
    const Progress progress(ProgressKind::none, before);
    const Stopwatch inner;
    CHECK(std::isinf(progress.expected_seconds(before)));
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    // Of a thousand samples in passes of 16, 16, 32, 64, …, each of them as long: wherever in a pass it is asked.
    for (const int samples : {260, 272, 300, 512, 900, 1000}) {
      const double done = samples / 1000.0, scale = (1.0 - before) / (done - before);
      const double least = inner.seconds();
      const double expected = progress.expected_seconds(done);
      CHECK(expected >= scale * least * (1.0 - 1e-12));
      CHECK(expected <= scale * outer.seconds() * (1.0 + 1e-12));
      // A share of the time that is known takes its place.
      const double by_share = progress.expected_seconds(done, 0.5);
      CHECK(by_share >= 2.0 * least);
      CHECK(by_share <= 2.0 * outer.seconds());
    }
  }
}
