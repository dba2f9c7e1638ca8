#include "subprocess.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>

namespace raylab::bench {

int run_program(const std::vector<std::string>& command, bool quiet, double* cpu_seconds) {
  constexpr int kNotStarted = 127;
  std::vector<char*> argv;
  for (const std::string& argument : command) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  if (quiet) posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t process = 0;
  const int error = posix_spawnp(&process, argv[0], &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) return kNotStarted;
  int status = 0;
  rusage usage;
  while (wait4(process, &status, 0, &usage) < 0) {
    if (errno != EINTR) return kNotStarted;
  }
  if (cpu_seconds != nullptr) {
    const auto seconds = [](const timeval& t) {
      return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    *cpu_seconds = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

std::filesystem::path bench_script(const std::filesystem::path& name) {
  namespace fs = std::filesystem;
  std::error_code unknown;
  const fs::path program = fs::read_symlink("/proc/self/exe", unknown);
  const fs::path installed = program.parent_path() / RAYLAB_SCRIPTS_FROM_PROGRAM / name;
  return fs::exists(installed, unknown) ? installed.lexically_normal() : RAYLAB_SOURCE_DIR "/bench" / name;
}

}  // namespace raylab::bench
