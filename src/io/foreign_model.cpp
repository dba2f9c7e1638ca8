#include "foreign_model.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <string>

#include "file_bytes.hpp"
#include "gltf_file.hpp"
#include "raylab/core/error.hpp"
#include "raylab/core/scratch_folder.hpp"

namespace raylab {
namespace {

namespace fs = std::filesystem;

/// Empty where there is none.
fs::path import_program() {
  if (const char* named = std::getenv("RAYLAB_IMPORT")) return named;
  std::error_code error;
  const fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (const char* place : {"raylab-import", RAYLAB_IMPORT_FROM_PROGRAM "/raylab-import"}) {
    if (is_file(folder / place)) return folder / place;
  }
  return {};
}

/// Why it failed; empty where it did not. What the program says goes to the file `said`.
std::string run(const fs::path& program, const fs::path& model, const fs::path& output, const fs::path& said) {
  // Before the process is made: where it is made by forking, as in emulators, it is told of no failure to run.
  if (access(program.c_str(), X_OK) != 0) return "does not run: " + std::string(std::strerror(errno));
  // A name that begins with a dash is no option of a program that has none.
  std::array<std::string, 3> words{program.string(), model.string(), output.string()};
  std::array<char*, 4> arguments{words[0].data(), words[1].data(), words[2].data(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, said.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  pid_t process = 0;
  const int failed = posix_spawn(&process, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) return "does not run: " + std::string(std::strerror(failed));
  int status = 0;
  while (waitpid(process, &status, 0) < 0) {
    if (errno != EINTR) return "is lost: " + std::string(std::strerror(errno));
  }
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    return signal == SIGXCPU || signal == SIGALRM ? "took too long, and was ended"
                                                  : "died: " + std::string(strsignal(signal));
  }
  if (WEXITSTATUS(status) == 0) return {};
  const std::string text = read_file(said);
  const std::string line = text.substr(0, text.find('\n'));
  return "failed" + (line.empty() ? ", and says no reason" : ": " + line);
}

void replace_all(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
    text.replace(at, from.size(), to);
  }
}

}  // namespace

MeshWithMaterials read_foreign_into(MaterialLibrary& library, const fs::path& file, const ObjOptions& options) {
  const fs::path program = import_program();
  if (program.empty()) {
    throw Error(ErrorKind::input, file.string(),
                "only raylab-import reads models of this format, and it is not there: it is built where Assimp is "
                "(Debian: libassimp-dev)");
  }
  const ScratchFolder scratch("raylab-import-");
  const fs::path model = scratch / "model.glb";
  if (const std::string why = run(program, file, model, scratch / "said"); !why.empty()) {
    throw Error(ErrorKind::input, file.string(), "not readable: raylab-import " + why);
  }
  const std::size_t warnings = library.warnings.size(), notes = library.notes.size(), files = library.files.size();
  MeshWithMaterials mesh;
  try {
    mesh = read_gltf_into(library, model, options);
  } catch (const Error& error) {
    std::string what = error.what();
    replace_all(what, model.string(), "the glTF that raylab-import made of it");
    throw Error(ErrorKind::input, file.string(), what);
  }
  // Extensions are of the glTF in between, not of the model.
  const auto first = library.warnings.begin() + static_cast<std::ptrdiff_t>(warnings);
  const auto is_of_extension = [](const std::string& text) {
    return text.find(": its extension ") != std::string::npos;
  };
  library.warnings.erase(std::remove_if(first, library.warnings.end(), is_of_extension), library.warnings.end());
  for (auto* texts : {&library.warnings, &library.notes}) {
    for (std::size_t i = texts == &library.warnings ? warnings : notes; i < texts->size(); ++i) {
      replace_all((*texts)[i], model.string(), file.string());
    }
  }
  for (std::size_t i = files; i < library.files.size(); ++i) {
    if (library.files[i] == model) library.files[i] = file;
  }
  return mesh;
}

}  // namespace raylab
