#pragma once
// Other renderers on our scenes, through bench/peers/*_render.py.
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "raylab/image/image.hpp"
#include "raylab/render/render_session.hpp"

namespace raylab::bench {

/// Names a peer's command; without a variant it is rendered in the way that is best for the scene.
struct Peer {
  std::string name, variant;
};

/// All peers there are, each in its best way.
std::vector<std::string> peer_names();

/// From NAME or NAME:VARIANT. Throws Error (usage) for a name that is not among peer_names().
Peer parse_peer(const std::string& text);

struct PeerRun {
  Image image;
  double seconds = 0.0;      ///< wall clock, rendering alone
  double cpu_seconds = 0.0;  ///< of all threads
};

struct PeerRuns {
  std::string version;
  std::string variant;
  std::vector<std::string> settings;     ///< as NAME = VALUE
  std::vector<std::string> differences;  ///< what of the scene is not the same as in Raylab
  std::uint32_t samples_per_pixel = 0;   ///< as taken: not all samplers take any number
  double start_up_seconds = 0.0;         ///< before rendering: imports, building, compilation
  std::vector<PeerRun> runs;
};

/// Why the peer cannot be run with this Python; empty when it can.
std::string why_not(const Peer& peer, const std::string& python);

/// `runs` pictures with the settings given, seeds from options.seed on. Throws Error (failure) when it cannot.
PeerRuns render_with(const Peer& peer, const std::string& python, const std::string& scene_file,
                     const RenderOptions& options, int threads, int runs);

}  // namespace raylab::bench
