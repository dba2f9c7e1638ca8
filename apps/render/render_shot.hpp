#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "options.hpp"
#include "shots.hpp"

namespace raylab {

/// What all pictures of one command share.
struct Job {
  const RenderCommand& command;
  const LoadedScene& loaded;
  const Accelerator& accelerator;
  double load_seconds;

  void warn(const std::string& warning) const;  ///< unless it is quiet
  void warn_always(const std::string& warning) const;
};

using Files = std::vector<std::filesystem::path>;

/// Renders one picture and writes it. False when it was interrupted, and the picture is partial.
bool render_shot(const Job& job, const Shot& shot, const Files& outputs);

}  // namespace raylab
