#include "peer.hpp"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "raylab/core/error.hpp"
#include "raylab/core/scratch_folder.hpp"
#include "raylab/image/image_file.hpp"
#include "subprocess.hpp"

namespace raylab::bench {

namespace fs = std::filesystem;

namespace {

/// Runs the peer's command.
int run_peer(const Peer& peer, const std::string& python, const std::vector<std::string>& arguments) {
  std::vector<std::string> command{python, bench_script("peers/" + peer.name + "_render.py").string()};
  if (!peer.variant.empty()) command.insert(command.end(), {"--variant", peer.variant});
  command.insert(command.end(), arguments.begin(), arguments.end());
  return run_program(command, true);
}

}  // namespace

std::vector<std::string> peer_names() { return {"mitsuba", "cycles", "luxcore"}; }

Peer parse_peer(const std::string& text) {
  const std::size_t colon = std::min(text.find(':'), text.size());
  const Peer peer{text.substr(0, colon), text.substr(std::min(colon + 1, text.size()))};
  const std::vector<std::string> names = peer_names();
  if (std::find(names.begin(), names.end(), peer.name) == names.end()) {
    throw Error(ErrorKind::usage, "--peers", "found " + text + ", expected mitsuba, cycles or luxcore");
  }
  return peer;
}

std::string why_not(const Peer& peer, const std::string& python) {
  return run_peer(peer, python, {"--probe"}) == 0 ? "" : python + " cannot run it (see above)";
}

PeerRuns render_with(const Peer& peer, const std::string& python, const std::string& scene_file,
                     const RenderOptions& options, int threads, int runs) {
  const ScratchFolder scratch("raylab-bench");
  const fs::path file = scratch / "result.json";
  const int exit_code = run_peer(
      peer, python,
      {scene_file, "--width", std::to_string(options.width), "--height", std::to_string(options.height), "--spp",
       std::to_string(options.samples_per_pixel), "--max-depth", std::to_string(options.integrator.max_depth),
       "--repeats", std::to_string(runs), "--threads", std::to_string(threads), "--seed", std::to_string(options.seed),
       "--output", (scratch / "{seed}.exr").string(), "--json", file.string()});
  if (exit_code != 0) throw Error(ErrorKind::failure, peer.name, "failed on " + scene_file);
  std::ifstream stream(file);
  const auto json = nlohmann::json::parse(stream);
  PeerRuns result;
  result.version = json["version"];
  result.variant = json["variant"];
  for (const auto& [name, value] : json["settings"].items()) {
    result.settings.push_back(name + " = " + (value.is_string() ? value.get<std::string>() : value.dump()));
  }
  result.differences = json["differences"].get<std::vector<std::string>>();
  result.samples_per_pixel = json["spp"];
  for (const auto& [name, seconds] : json["start_up_seconds"].items()) result.start_up_seconds += seconds.get<double>();
  for (int run = 0; run < runs; ++run) {
    const auto i = static_cast<std::size_t>(run);
    result.runs.push_back({read_exr(scratch / (std::to_string(options.seed + run) + ".exr")),
                           json["all_seconds"][i].get<double>(), json["all_cpu_seconds"][i].get<double>()});
  }
  return result;
}

}  // namespace raylab::bench
