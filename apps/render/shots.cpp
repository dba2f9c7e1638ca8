#include "shots.hpp"

#include <spawn.h>
#include <sys/wait.h>

#include <array>

#include "raylab/core/error.hpp"
#include "raylab/core/text.hpp"
#include "raylab/scene/camera_path.hpp"

extern char** environ;  // NOLINT: POSIX has it in no header

namespace raylab {

std::vector<Shot> shots_of(const RenderCommand& command, const LoadedScene& loaded) {
  if (!command.views && !command.fly) return {{"", loaded.camera}};
  const std::size_t least = command.fly ? 2 : 1;
  if (loaded.views.size() < least) {
    throw Error(ErrorKind::input, command.scene,
                format("has %zu [[view]] tables, and %s needs %s", loaded.views.size(),
                       command.fly ? "--fly" : "--views", command.fly ? "two or more" : "one or more"));
  }
  std::vector<Shot> shots;
  if (command.views) {
    for (const NamedView& view : loaded.views) shots.push_back({"-" + view.name, view.camera});
    return shots;
  }
  std::vector<CameraSettings> cameras;
  for (const NamedView& view : loaded.views) cameras.push_back(view.camera);
  const double last = static_cast<double>(cameras.size() - 1);
  for (int frame = 0; frame < *command.fly; ++frame) {
    const double place = *command.fly > 1 ? last * frame / (*command.fly - 1) : 0.0;
    shots.push_back({format("-%04d", frame + 1), camera_on_path(cameras, place)});
  }
  return shots;
}

std::filesystem::path with_suffix(const std::filesystem::path& file, const std::string& suffix) {
  std::filesystem::path name = file.stem();
  name += suffix;
  name += file.extension();
  return file.parent_path() / name;
}

std::string make_film(const std::filesystem::path& output) {
  const std::string frames = with_suffix(output, "-%04d").string();
  const std::string film = std::filesystem::path(output).replace_extension(".mp4").string();
  // The sides of a film of this format are even.
  const std::string even = "pad=ceil(iw/2)*2:ceil(ih/2)*2";
  std::array<const char*, 14> words = {"ffmpeg",   "-y",      "-loglevel",    "error", "-framerate",
                                       "30",       "-i",      frames.c_str(), "-vf",   even.c_str(),
                                       "-pix_fmt", "yuv420p", film.c_str(),   nullptr};
  pid_t process = 0;
  int status = 0;
  const bool made =
      posix_spawnp(&process, words[0], nullptr, nullptr, const_cast<char**>(words.data()), environ) == 0 &&
      waitpid(process, &status, 0) == process && WIFEXITED(status) && WEXITSTATUS(status) == 0;
  return made ? film : "no film: that takes ffmpeg -framerate 30 -i " + frames + " -pix_fmt yuv420p " + film;
}

}  // namespace raylab
