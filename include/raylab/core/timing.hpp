#pragma once
#include <time.h>

#include <chrono>

namespace raylab {

/// Wall-clock seconds since construction, from the monotonic clock.
class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Whose processor time a CpuStopwatch counts.
enum class CpuClock : clockid_t { thread = CLOCK_THREAD_CPUTIME_ID, process = CLOCK_PROCESS_CPUTIME_ID };

/// Processor seconds since construction: time that went to other programs does not count.
class CpuStopwatch {
 public:
  explicit CpuStopwatch(CpuClock clock) : clock_(clock), start_(now()) {}
  double seconds() const { return now() - start_; }

 private:
  double now() const {
    timespec time{};
    clock_gettime(static_cast<clockid_t>(clock_), &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }

  CpuClock clock_;
  double start_;
};

}  // namespace raylab
