#include "raylab/core/interrupt.hpp"

#include <unistd.h>

#include <csignal>

namespace raylab {

namespace {

constexpr int kImpatient = 3;
volatile std::sig_atomic_t signals = 0;

void on_interrupt(int) {
  signals = signals + 1;
  if (signals >= kImpatient) _exit(kInterrupted);
}

}  // namespace

InterruptGuard::InterruptGuard() {
  signals = 0;
  struct sigaction action {};
  action.sa_handler = on_interrupt;
  sigaction(SIGINT, &action, &old_int_);
  sigaction(SIGTERM, &action, &old_term_);
}

InterruptGuard::~InterruptGuard() {
  sigaction(SIGINT, &old_int_, nullptr);
  sigaction(SIGTERM, &old_term_, nullptr);
}

bool InterruptGuard::interrupted() { return signals > 0; }

}  // namespace raylab
