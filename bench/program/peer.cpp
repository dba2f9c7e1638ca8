#include "peer.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "raylab/core/error.hpp"
#include "raylab/core/text.hpp"
#include "raylab/core/timing.hpp"
#include "raylab/image/image_file.hpp"
#include "subprocess.hpp"

namespace raylab::bench {

namespace {

/// The command that runs the peer in its variant.
std::vector<std::string> command_of(const Peer& peer, const std::string& python,
                                    const std::vector<std::string>& arguments) {
  std::vector<std::string> command{python, bench_script("peers/" + peer.name + "_render.py").string()};
  if (!peer.variant.empty()) command.insert(command.end(), {"--variant", peer.variant});
  command.insert(command.end(), arguments.begin(), arguments.end());
  return command;
}

/// The value of what the peer answers, as `read` finds it there.
template <class Read>
auto answer_of(const std::string& name, const std::string& line, const Read& read) {
  try {
    return read(nlohmann::json::parse(line));
  } catch (const nlohmann::json::exception& e) {
    throw Error(ErrorKind::failure, name, "answered \"" + line + "\": " + e.what());
  }
}

PeerSettings settings_of(const nlohmann::json& json) {
  PeerSettings found{json.at("version"), json.at("variant"), {}, json.at("differences")};
  for (const auto& [name, value] : json.at("settings").items())
    found.settings.push_back(name + " = " + (value.is_string() ? value.get<std::string>() : value.dump()));
  return found;
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
  return run_program(command_of(peer, python, {"--probe"}), true) == 0 ? "" : python + " cannot run it (see above)";
}

PeerProcess::PeerProcess(const Peer& peer, const std::string& python, const std::string& scene_file,
                         const RenderOptions& options, int threads, double minutes, std::function<void()> check)
    : name_(peer.name),
      minutes_(minutes),
      check_(std::move(check)),
      process_(name_,
               command_of(peer, python,
                          {scene_file, "--serve", "--width", std::to_string(options.width), "--height",
                           std::to_string(options.height), "--max-depth", std::to_string(options.integrator.max_depth),
                           "--threads", std::to_string(threads)}),
               scratch_.path()),
      settings_(answer_of(name_, answer(), settings_of)) {}

PeerRun PeerProcess::run(std::uint32_t seed, std::uint32_t samples_per_pixel) {
  const std::filesystem::path picture = scratch_ / "picture.exr";
  process_.write(nlohmann::json{{"seed", seed}, {"spp", samples_per_pixel}, {"output", picture.string()}}.dump());
  PeerRun run = answer_of(name_, answer(), [](const nlohmann::json& json) {
    return PeerRun{{},
                   json.at("seconds"),
                   json.at("cpu_seconds"),
                   json.at("spp"),
                   json.at("start_up_seconds"),
                   json.at("waited_seconds"),
                   json.at("waited_cpu_seconds")};
  });
  run.image = read_exr(picture);
  return run;
}

std::string PeerProcess::answer() {
  const Stopwatch watch;
  return process_.read([&] {
    check_();
    if (watch.seconds() < 60.0 * minutes_) return;
    throw Error(ErrorKind::failure, name_, format("has not answered for %g minutes (--peer-minutes)", minutes_));
  });
}

}  // namespace raylab::bench
