#include "raylab/core/progress.hpp"

#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

#include "raylab/core/text.hpp"

namespace raylab {

namespace {
constexpr double kBarSeconds = 0.2;
constexpr double kLineSeconds = 10.0;
constexpr double kJsonSeconds = 1.0;
constexpr int kBarWidth = 40;
}  // namespace

Progress::Progress(ProgressKind kind, double done) : done_(done) {
  switch (kind) {
    case ProgressKind::automatic:
      style_ = isatty(STDERR_FILENO) ? Style::bar : Style::lines;
      break;
    case ProgressKind::lines:
      style_ = Style::lines;
      break;
    case ProgressKind::json:
      style_ = Style::json;
      break;
    case ProgressKind::none:
      style_ = Style::none;
      break;
  }
}

void Progress::update(double fraction, std::optional<double> share) {
  const double interval = style_ == Style::bar ? kBarSeconds : style_ == Style::lines ? kLineSeconds : kJsonSeconds;
  if (style_ == Style::none || watch_.seconds() - last_ < interval) return;
  last_ = watch_.seconds();
  print(fraction, share);
}

void Progress::finish(double fraction) {
  if (style_ == Style::bar) std::fprintf(stderr, "\r\033[K");
  if (style_ == Style::json) print(fraction, {});
}

double Progress::expected_seconds(double fraction, std::optional<double> share) const {
  if (fraction <= done_) return std::numeric_limits<double>::infinity();
  return share ? watch_.seconds() / *share : watch_.seconds() * (1.0 - done_) / (fraction - done_);
}

void Progress::say(double fraction, std::optional<double> share) const {
  const double elapsed = watch_.seconds();
  if (style_ == Style::bar) std::fprintf(stderr, "\r\033[K");
  std::fprintf(stderr, "%5.1f%% after %.0f s%s", 100.0 * fraction, elapsed, error_text(", relMSE about ").c_str());
  if (fraction > done_) std::fprintf(stderr, ", about %.0f s left", expected_seconds(fraction, share) - elapsed);
  std::fprintf(stderr, "\n");
}

std::string Progress::error_text(const char* before) const {
  const double relmse = error_;
  if (relmse == 0.0) return "";
  return before + format("%.3g%s", std::abs(relmse), relmse > 0.0 ? "" : " (not reliable)");
}

void Progress::print(double fraction, std::optional<double> share) const {
  const double elapsed = watch_.seconds();
  const double left = fraction > done_ ? expected_seconds(fraction, share) - elapsed : 0.0;
  if (style_ == Style::bar) {
    const int full = static_cast<int>(fraction * kBarWidth);
    const std::string bar = std::string(full, '#') + std::string(kBarWidth - full, '.');
    std::fprintf(stderr, "\r[%s] %5.1f%%  %.0f s, %.0f s left%s \033[K", bar.c_str(), 100.0 * fraction, elapsed, left,
                 error_text(", relMSE ").c_str());
  } else if (style_ == Style::json) {
    std::string error;
    if (const double relmse = error_; relmse != 0.0) {
      error = format(", \"estimated_relmse\": %.6g, \"estimated_relmse_reliable\": %s", std::abs(relmse),
                     relmse > 0.0 ? "true" : "false");
    }
    std::fprintf(stderr, "{\"progress\": %.6f, \"seconds\": %.3f, \"seconds_left\": %.3f%s}\n", fraction, elapsed, left,
                 error.c_str());
  } else {
    say(fraction, share);
  }
  std::fflush(stderr);
}

}  // namespace raylab
