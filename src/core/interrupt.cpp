#include "raylab/core/interrupt.hpp"

#include <unistd.h>

#include <csignal>

namespace raylab {

namespace {

constexpr int kImpatient = 3;
volatile std::sig_atomic_t signals = 0;
volatile std::sig_atomic_t asked = 0;

void on_interrupt(int) {
  signals = signals + 1;
  if (signals >= kImpatient) _exit(kInterrupted);
}

void on_question(int) { asked = 1; }

}  // namespace

InterruptGuard::InterruptGuard() {
  signals = 0;
  struct sigaction action {};
  action.sa_handler = on_interrupt;
  sigaction(SIGINT, &action, &old_int_);
  sigaction(SIGTERM, &action, &old_term_);
  // nohup has it ignored, and means it.
  sigaction(SIGHUP, nullptr, &old_hup_);
  if (old_hup_.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);
  action.sa_handler = on_question;
  sigaction(SIGUSR1, &action, &old_usr1_);
}

InterruptGuard::~InterruptGuard() {
  sigaction(SIGINT, &old_int_, nullptr);
  sigaction(SIGTERM, &old_term_, nullptr);
  sigaction(SIGHUP, &old_hup_, nullptr);
  sigaction(SIGUSR1, &old_usr1_, nullptr);
}

bool InterruptGuard::interrupted() { return signals > 0; }

bool InterruptGuard::state_wanted() {
  const bool wanted = asked != 0;
  asked = 0;
  return wanted;
}

}  // namespace raylab
