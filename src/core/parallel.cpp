#include "raylab/core/parallel.hpp"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#ifndef __aarch64__
#include <xmmintrin.h>
#endif

#include <atomic>
#include <cstdint>

// The thread sanitizer does not see how TBB's library hands work from thread to thread, so it is told here. This
// file itself is left out of its view (see CMakeLists.txt), and with it TBB's headers.
#ifdef RAYLAB_SANITIZE_THREAD
extern "C" void __tsan_acquire(void* address);
extern "C" void __tsan_release(void* address);
#endif

namespace raylab {

namespace {
/// The register that controls how floats round, and its bits that flush denormal results and operands.
#ifdef __aarch64__
constexpr unsigned kFlushDenormals = 1u << 24;  // FZ
unsigned float_control() {
  std::uint64_t control;
  asm volatile("mrs %0, fpcr" : "=r"(control));
  return static_cast<unsigned>(control);
}
void set_float_control(unsigned control) { asm volatile("msr fpcr, %0" : : "r"(std::uint64_t{control}) : "memory"); }
#else
constexpr unsigned kFlushDenormals = 1u << 15 | 1u << 6;  // FTZ and DAZ
unsigned float_control() { return _mm_getcsr(); }
void set_float_control(unsigned control) { _mm_setcsr(control); }
#endif

/// Work that is handed out while it lives: what came before its beginning is seen by the work, and what the work did
/// is seen after its end.
class Handover {
 public:
  Handover() { release(begun_); }
  ~Handover() { acquire(done_); }
  Handover(const Handover&) = delete;
  Handover& operator=(const Handover&) = delete;

  template <class Work>
  void run(const Work& work) {
    const Done done{*this};
    acquire(begun_);
    const FlushDenormals flush;
    work();
  }

 private:
  struct Done {
    Handover& handover;
    ~Done() { release(handover.done_); }
  };

#ifdef RAYLAB_SANITIZE_THREAD
  static void acquire(char& location) { __tsan_acquire(&location); }
  static void release(char& location) { __tsan_release(&location); }
#else
  static void acquire(char&) {}
  static void release(char&) {}
#endif

  char begun_ = 0, done_ = 0;
};

}  // namespace

int hardware_threads() {
  const int threads = tbb::info::default_concurrency();
  return threads > 0 ? threads : 1;
}

ThreadLimit::ThreadLimit(int threads)
    : control_(new tbb::global_control(tbb::global_control::max_allowed_parallelism,
                                       static_cast<std::size_t>(threads > 0 ? threads : hardware_threads()))) {}

ThreadLimit::~ThreadLimit() { delete static_cast<tbb::global_control*>(control_); }

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body) {
  // A shared counter keeps the order that the caller chose, whatever way TBB splits the range.
  std::atomic<std::size_t> next{0};
  Handover handover;
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, count, 1),
      [&](const tbb::blocked_range<std::size_t>& range) {
        handover.run([&] {
          for (std::size_t n = range.size(); n > 0; --n) body(next.fetch_add(1, std::memory_order_relaxed));
        });
      },
      tbb::simple_partitioner());
}

void parallel_invoke(const std::function<void()>& a, const std::function<void()>& b) {
  Handover handover;
  tbb::parallel_invoke([&] { handover.run(a); }, [&] { handover.run(b); });
}

FlushDenormals::FlushDenormals() : saved_(float_control()) { set_float_control(saved_ | kFlushDenormals); }

FlushDenormals::~FlushDenormals() { set_float_control(saved_); }

}  // namespace raylab
