#pragma once
// Mitsuba 3 on our scenes, through bench/peers/mitsuba_render.py.
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "raylab/image/image.hpp"
#include "raylab/render/render_session.hpp"

namespace raylab::bench {

struct PeerRun {
  Image image;
  double seconds = 0.0;
};

struct PeerRuns {
  std::string name;  ///< with version and variant
  std::vector<PeerRun> runs;
};

/// Why Mitsuba cannot be run with this Python; empty when it can.
std::string why_no_mitsuba(const std::string& python);

/// `runs` pictures with the settings given, seeds from options.seed on. Throws Error (failure) when it cannot.
PeerRuns render_with_mitsuba(const std::string& python, const std::string& scene_file, const RenderOptions& options,
                             int threads, int runs);

}  // namespace raylab::bench
