#include "raylab/core/interrupt.hpp"

#include <unistd.h>

#include <csignal>

namespace raylab {

namespace {

constexpr int kImpatient = 3;
volatile std::sig_atomic_t signals = 0;
volatile std::sig_atomic_t questions = 0;

void on_interrupt(int) {
  signals = signals + 1;
  if (signals >= kImpatient) _exit(kInterrupted);
}

void on_question(int) { questions = 1; }

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
}

InterruptGuard::~InterruptGuard() {
  sigaction(SIGINT, &old_int_, nullptr);
  sigaction(SIGTERM, &old_term_, nullptr);
  sigaction(SIGHUP, &old_hup_, nullptr);
}

bool InterruptGuard::interrupted() { return signals > 0; }

QuestionGuard::QuestionGuard() {
  questions = 0;
  struct sigaction action {};
  action.sa_handler = on_question;
  action.sa_flags = SA_RESTART;
  sigaction(SIGUSR1, &action, &old_);
}

QuestionGuard::~QuestionGuard() { sigaction(SIGUSR1, &old_, nullptr); }

bool QuestionGuard::asked() {
  const bool wanted = questions != 0;
  questions = 0;
  return wanted;
}

}  // namespace raylab
