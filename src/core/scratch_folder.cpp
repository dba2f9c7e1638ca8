#include "raylab/core/scratch_folder.hpp"

#include <sys/stat.h>

#include <cerrno>
#include <random>
#include <system_error>

#include "raylab/core/error.hpp"

namespace raylab {

namespace fs = std::filesystem;

ScratchFolder::ScratchFolder(const std::string& name) {
  std::error_code error;
  const fs::path folder = fs::temp_directory_path(error);
  if (error) throw Error(ErrorKind::output, "the folder of temporary files (TMPDIR)", error.message());
  std::random_device random;
  for (;;) {
    path_ = folder / (name + "-" + std::to_string(random()));
    // mkdir rather than create_directory: private from its first moment, and an existing one is refused.
    if (mkdir(path_.c_str(), 0700) == 0) return;
    if (errno != EEXIST) {
      throw Error(ErrorKind::output, folder.string(),
                  "no folder can be made in it: " + std::generic_category().message(errno));
    }
  }
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

}  // namespace raylab
