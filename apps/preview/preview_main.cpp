#include "preview_main.hpp"

#include <utility>

#include "preview.hpp"
#include "raylab/apps/program.hpp"
#include "raylab/core/parallel.hpp"
#include "raylab/image/image_file.hpp"

namespace raylab {

namespace {

int preview(const PreviewCommand& command) {
  (void)parse_integrator(command.integrator);
  (void)parse_sampler(command.sampler);
  check_options(find_accelerator(command.accel), accelerator_options(command));
  if (!command.screenshot.empty()) check_writable_image(command.screenshot);
  const WindowSystem windows;  // first: where there is no display, the scene need not be loaded
  const ThreadLimit limit(command.threads);
  LoadedScene loaded = load_scene(command.scene, command.load_options());
  tell_warnings(loaded);
  Preview(command, std::move(loaded)).run();
  return 0;
}

}  // namespace

int preview_main(int argc, char** argv) {
  return run_and_tell("raylab-preview", [&] {
    int exit_code = 0;
    const auto command = parse_preview_command(argc, argv, exit_code);
    return command ? preview(*command) : exit_code;
  });
}

}  // namespace raylab
