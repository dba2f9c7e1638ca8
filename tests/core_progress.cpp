#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "catch.hpp"
#include "raylab/core/progress.hpp"
#include "temp_folder.hpp"

using namespace raylab;
using namespace raylab::test;

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

TEST_CASE("the estimated error is shown once it is known, and that it is not reliable", "[unit][core]") {
  const TempFolder folder;
  const std::string file = (folder / "said").string();
  const auto said = [&](ProgressKind kind, double relmse, bool reliable) {
    Progress progress(kind);
    if (relmse > 0.0) progress.set_error(relmse, reliable);
    const int before = dup(STDERR_FILENO);
    std::FILE* const out = std::fopen(file.c_str(), "w");
    dup2(fileno(out), STDERR_FILENO);
    kind == ProgressKind::json ? progress.finish(0.5) : progress.say(0.5);
    std::fflush(stderr);
    dup2(before, STDERR_FILENO);
    close(before);
    std::fclose(out);
    return read_text(file);
  };
  CHECK(said(ProgressKind::lines, 0.0, false).find("relMSE") == std::string::npos);
  CHECK(said(ProgressKind::lines, 0.0021, true).find(" s, relMSE about 0.0021, about ") != std::string::npos);
  CHECK(said(ProgressKind::lines, 0.0021, false).find("relMSE about 0.0021 (not reliable), ") != std::string::npos);
  CHECK_FALSE(nlohmann::json::parse(said(ProgressKind::json, 0.0, false)).contains("estimated_relmse"));
  for (const bool reliable : {false, true}) {
    const auto json = nlohmann::json::parse(said(ProgressKind::json, 0.0021, reliable));
    CHECK(json.at("estimated_relmse") == 0.0021);
    CHECK(json.at("estimated_relmse_reliable") == reliable);
  }
}
