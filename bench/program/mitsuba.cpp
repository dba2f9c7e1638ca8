#include "mitsuba.hpp"

#include <fstream>
#include <nlohmann/json.hpp>

#include "raylab/core/error.hpp"
#include "raylab/core/scratch_folder.hpp"
#include "raylab/image/image_file.hpp"
#include "raylab/render/integrator.hpp"
#include "subprocess.hpp"

namespace raylab::bench {

namespace fs = std::filesystem;

namespace {

constexpr const char* kVariant = "llvm_ad_rgb";

std::string adapter() { return bench_script("peers/mitsuba_render.py").string(); }

}  // namespace

std::string why_no_mitsuba(const std::string& python) {
  if (python.empty()) return "no --peer-python was given";
  if (!fs::exists(adapter())) return adapter() + " is not there";
  if (run_program({python, adapter(), "--variant", kVariant, "--probe"}, true) != 0) {
    return python + " cannot run it (see above)";
  }
  return "";
}

PeerRuns render_with_mitsuba(const std::string& python, const std::string& scene_file, const RenderOptions& options,
                             int threads, int runs) {
  const ScratchFolder scratch("raylab-bench");
  const auto picture = [&](int run) { return scratch / (std::to_string(options.seed + run) + ".exr"); };
  const fs::path json = scratch / "result.json";
  const int exit_code = run_program({python,
                                     adapter(),
                                     scene_file,
                                     "--variant",
                                     kVariant,
                                     "--width",
                                     std::to_string(options.width),
                                     "--height",
                                     std::to_string(options.height),
                                     "--spp",
                                     std::to_string(options.samples_per_pixel),
                                     "--max-depth",
                                     std::to_string(options.integrator.max_depth),
                                     "--rr-depth",
                                     std::to_string(Integrator::kFirstRouletteSegment),
                                     "--repeats",
                                     std::to_string(runs),
                                     "--threads",
                                     std::to_string(threads),
                                     "--seed",
                                     std::to_string(options.seed),
                                     "--output",
                                     (scratch / "{seed}.exr").string(),
                                     "--json",
                                     json.string()},
                                    true);
  if (exit_code != 0) throw Error(ErrorKind::failure, "Mitsuba 3", "failed on " + scene_file);
  std::ifstream stream(json);
  const auto row = nlohmann::json::parse(stream);
  PeerRuns result{"mitsuba " + row["version"].get<std::string>() + " " + kVariant, {}};
  for (int run = 0; run < runs; ++run) {
    result.runs.push_back({read_exr(picture(run)), row["all_seconds"][static_cast<std::size_t>(run)].get<double>()});
  }
  return result;
}

}  // namespace raylab::bench
