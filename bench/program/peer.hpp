#pragma once
// Other renderers on our scenes, through bench/peers/*_render.py.
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "line_process.hpp"
#include "raylab/core/scratch_folder.hpp"
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

/// Why the peer cannot be run with this Python; empty when it can.
std::string why_not(const Peer& peer, const std::string& python);

/// How a peer renders a scene.
struct PeerSettings {
  std::string version;
  std::string variant;
  std::vector<std::string> settings;     ///< as NAME = VALUE
  std::vector<std::string> differences;  ///< what of the scene is not the same as in Raylab
};

struct PeerRun {
  Image image;
  double seconds = 0.0;                 ///< wall clock, rendering alone
  double cpu_seconds = 0.0;             ///< of all threads
  std::uint32_t samples_per_pixel = 0;  ///< as taken: not all samplers take any number
  double start_up_seconds = 0.0;        ///< before rendering: imports, building, compilation
  double waited_seconds = 0.0;          ///< since the run before
  double waited_cpu_seconds = 0.0;      ///< which should be none
};

/// A peer in a process of its own that has the scene built, and renders when it is asked to. It and its files go when
/// its owner does.
class PeerProcess {
 public:
  /// Starts it. Calls `check`, which may throw, some twenty times a second, here and while it renders. Throws Error
  /// (failure), as does run(), when it has ended, or has not answered for `minutes`.
  PeerProcess(const Peer& peer, const std::string& python, const std::string& scene_file, const RenderOptions& options,
              int threads, double minutes, std::function<void()> check);

  const PeerSettings& settings() const { return settings_; }

  /// Renders with the settings given when it was started, but for these two.
  PeerRun run(std::uint32_t seed, std::uint32_t samples_per_pixel);

 private:
  /// Its next line.
  std::string answer();

  std::string name_;
  double minutes_;
  std::function<void()> check_;
  ScratchFolder scratch_{"raylab-bench"};
  LineProcess process_;
  PeerSettings settings_;
};

}  // namespace raylab::bench
