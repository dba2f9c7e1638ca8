#pragma once
#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace raylab::bench {

/// A program that is told lines on standard input and answers them with lines on standard output. It is in a process
/// group of its own, so that Ctrl-C reaches this program alone, and sees the end of its input when this one is gone.
class LineProcess {
 public:
  /// Starts a program found by PATH; its temporary files go to the folder named. Throws Error (failure), with `name`
  /// for its place as all here, when it cannot be started.
  LineProcess(const std::string& name, const std::vector<std::string>& command, const std::filesystem::path& temporary);
  /// Ends it at once, whatever it does.
  ~LineProcess();
  LineProcess(const LineProcess&) = delete;
  LineProcess& operator=(const LineProcess&) = delete;

  /// One that has ended is told of by read().
  void write(const std::string& line);

  /// Waits for a line and returns it without its end. Calls `check`, which may throw, some twenty times a second.
  /// Throws Error (failure) when the program has ended.
  std::string read(const std::function<void()>& check);

 private:
  std::string name_;
  pid_t process_ = 0;
  int socket_ = -1;  ///< both its standard input and its standard output
  std::string unread_;
};

}  // namespace raylab::bench
