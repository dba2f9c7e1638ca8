#include "line_process.hpp"

#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <string_view>
#include <system_error>

#include "raylab/core/error.hpp"

namespace raylab::bench {

namespace {

std::vector<char*> pointers_to(const std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (const std::string& text : texts) pointers.push_back(const_cast<char*>(text.c_str()));
  pointers.push_back(nullptr);
  return pointers;
}

/// Ends the process, where it has not ended, with all of its group, and returns how it ended.
int end(pid_t process) {
  kill(-process, SIGKILL);
  int status = 0;
  while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

}  // namespace

LineProcess::LineProcess(const std::string& name, const std::vector<std::string>& command,
                         const std::filesystem::path& temporary)
    : name_(name) {
  const auto fail = [&](int error) {
    throw Error(ErrorKind::failure, name_,
                command.at(0) + " cannot be started: " + std::generic_category().message(error));
  };
  std::vector<std::string> environment{"TMPDIR=" + temporary.string()};
  for (char** entry = environ; *entry != nullptr; ++entry) {
    if (std::string_view(*entry).substr(0, 7) != "TMPDIR=") environment.push_back(*entry);
  }
  // A socket rather than two pipes: one whose other end is gone raises no signal. Closed on exec, so that no program
  // started later keeps it open.
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) fail(errno);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  const int error = posix_spawnp(&process_, command.at(0).c_str(), &actions, &attributes, pointers_to(command).data(),
                                 pointers_to(environment).data());
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  socket_ = ends[0];
  if (error != 0) {
    close(socket_);
    fail(error);
  }
}

LineProcess::~LineProcess() {
  close(socket_);
  if (process_ != 0) end(process_);
}

void LineProcess::write(const std::string& line) {
  const std::string text = line + '\n';
  for (std::size_t sent = 0; sent < text.size();) {
    const ssize_t n = send(socket_, text.data() + sent, text.size() - sent, MSG_NOSIGNAL);
    if (n < 0 && errno != EINTR) return;
    if (n > 0) sent += static_cast<std::size_t>(n);
  }
}

std::string LineProcess::read(const std::function<void()>& check) {
  constexpr int kMilliseconds = 50;
  for (;;) {
    if (const std::size_t end = unread_.find('\n'); end != std::string::npos) {
      std::string line = unread_.substr(0, end);
      unread_.erase(0, end + 1);
      return line;
    }
    check();
    pollfd readable{socket_, POLLIN, 0};
    if (poll(&readable, 1, kMilliseconds) <= 0) continue;
    char block[4096];
    const ssize_t n = recv(socket_, block, sizeof block, 0);
    if (n > 0) {
      unread_.append(block, static_cast<std::size_t>(n));
    } else if (n == 0 || errno != EINTR) {
      // All its ends of the socket are closed, as they are once it has ended.
      const int status = end(process_);
      process_ = 0;
      throw Error(ErrorKind::failure, name_,
                  WIFEXITED(status) ? "ended with exit code " + std::to_string(WEXITSTATUS(status)) + " (see above)"
                                    : "was ended by signal " + std::to_string(WTERMSIG(status)));
    }
  }
}

}  // namespace raylab::bench
