#pragma once
// The only place that knows oneTBB.
#include <cstddef>
#include <functional>

namespace raylab {

/// Threads the machine offers, at least 1.
int hardware_threads();

/// While it lives, no more than this many threads work in parallel_for, or in a library that uses TBB.
/// Zero or less means hardware_threads().
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  void* control_;
};

/// Calls body(i) once for each i in [0, count), in parallel, starting with the smallest: item 0 is never
/// started after item count-1. Exceptions of body reach the caller. Every worker runs with denormals
/// flushed (see FlushDenormals), so all accelerators see the same arithmetic.
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body);

/// Calls both, perhaps at the same time, and returns when both are done; for tasks that split themselves.
/// Exceptions reach the caller. Denormals are flushed as in parallel_for.
void parallel_invoke(const std::function<void()>& a, const std::function<void()>& b);

/// Flushes denormal operands and results to zero in this thread while it lives (FTZ and DAZ of x86, FZ of Arm),
/// and restores what was set. Embree asks for it; every backend is measured under the same setting.
class FlushDenormals {
 public:
  FlushDenormals();
  ~FlushDenormals();
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
  unsigned saved_;
};

}  // namespace raylab
