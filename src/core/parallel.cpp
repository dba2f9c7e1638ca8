#include "raylab/core/parallel.hpp"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <xmmintrin.h>

#include <atomic>

namespace raylab {

namespace {
constexpr unsigned kFlushToZero = 1u << 15;
constexpr unsigned kDenormalsAreZero = 1u << 6;
}  // namespace

int hardware_threads() {
  const int threads = tbb::info::default_concurrency();
  return threads > 0 ? threads : 1;
}

ThreadLimit::ThreadLimit(int threads)
    : control_(new tbb::global_control(
          tbb::global_control::max_allowed_parallelism,
          static_cast<std::size_t>(threads > 0 ? threads : hardware_threads()))) {}

ThreadLimit::~ThreadLimit() { delete static_cast<tbb::global_control*>(control_); }

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body) {
  // A shared counter keeps the order that the caller chose, whatever way TBB splits the range.
  std::atomic<std::size_t> next{0};
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, count, 1),
      [&](const tbb::blocked_range<std::size_t>& range) {
        const FlushDenormals flush;
        for (std::size_t n = range.size(); n > 0; --n) body(next.fetch_add(1, std::memory_order_relaxed));
      },
      tbb::simple_partitioner());
}

void parallel_invoke(const std::function<void()>& a, const std::function<void()>& b) {
  const auto flushed = [](const std::function<void()>& task) {
    return [&task] {
      const FlushDenormals flush;
      task();
    };
  };
  tbb::parallel_invoke(flushed(a), flushed(b));
}

FlushDenormals::FlushDenormals() : saved_(_mm_getcsr()) {
  _mm_setcsr(saved_ | kFlushToZero | kDenormalsAreZero);
}

FlushDenormals::~FlushDenormals() { _mm_setcsr(saved_); }

}  // namespace raylab
