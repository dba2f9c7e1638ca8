#pragma once
#include <signal.h>

namespace raylab {

/// Exit code of a program that was interrupted and wrote what it had.
inline constexpr int kInterrupted = 130;

/// While it lives, Ctrl-C, SIGTERM and SIGHUP, where it was not ignored, ask the program to stop instead of ending it.
/// The third one ends it at once: `timeout` and job schedulers signal both the process and its group, so two signals
/// are one wish.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

  static bool interrupted();

 private:
  struct sigaction old_int_, old_term_, old_hup_;
};

/// While it lives, SIGUSR1, which would end the program, asks it to say how far it is.
class QuestionGuard {
 public:
  QuestionGuard();
  ~QuestionGuard();
  QuestionGuard(const QuestionGuard&) = delete;
  QuestionGuard& operator=(const QuestionGuard&) = delete;

  /// Whether it has come since this was asked last.
  static bool asked();

 private:
  struct sigaction old_;
};

}  // namespace raylab
