#include "resume.hpp"

#include <algorithm>
#include <cinttypes>

#include "raylab/core/error.hpp"
#include "raylab/core/text.hpp"
#include "report.hpp"

namespace raylab {

namespace fs = std::filesystem;

namespace {

/// With all digits that a float has.
std::string text_of(const vec3& v) {
  return format("%.9g %.9g %.9g", static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z));
}

std::string text_of(const CameraSettings& c) {
  return "look_from " + text_of(c.look_from) + ", look_at " + text_of(c.look_at) + ", up " + text_of(c.up) +
         format(", vfov %.9g, defocus_angle %.9g, focus_distance %.9g", static_cast<double>(c.vfov),
                static_cast<double>(c.defocus_angle), static_cast<double>(c.focus_distance));
}

/// What is traced with. Where batches are not answered as single rays are, as Embree's packets are not, neither need
/// the answers of two instruction sets be the same.
std::string tracer_text(const RenderCommand& command, const BuildReport& build) {
  const bool same_everywhere = find_accelerator(command.accel).capabilities.batch_equals_single;
  return accelerator_text(command) + (same_everywhere ? "" : ", " + build.isa);
}

/// Rounded up.
std::uint64_t mean_taken(const Film& film, std::uint64_t pixels) {
  std::uint64_t taken = 0;
  for (int y = 0; y < film.height(); ++y) {
    for (int x = 0; x < film.width(); ++x) taken += film.taken(x, y);
  }
  return (taken + pixels - 1) / pixels;
}

}  // namespace

FilmInfo film_info(const RenderCommand& command, const LoadedScene& loaded, const RenderOptions& options,
                   const BuildReport& build) {
  FilmInfo info;
  const PixelRect crop = options.crop.value_or(PixelRect{0, 0, options.width, options.height});
  info.settings = {{"version", RAYLAB_VERSION},
                   {"scene", format("%016" PRIx64, loaded.hash)},
                   {"camera", text_of(options.camera)},
                   {"size", format("%dx%d", options.width, options.height)},
                   {"crop", format("%d,%d,%d,%d", crop.x, crop.y, crop.width, crop.height)},
                   {"accel", tracer_text(command, build)},
                   {"integrator", std::string(integrator_name(options.integrator.kind))},
                   {"sampler", std::string(sampler_name(options.sampler))},
                   {"seed", std::to_string(options.seed)},
                   {"max-depth", std::to_string(options.integrator.max_depth)},
                   {"strategies", command.strategies},
                   {"ray-offset", command.ray_offset},
                   {"needs", command.needs}};
  const std::uint32_t end = options.first_sample + options.samples_per_pixel;
  info.ranges = {{options.first_sample, end}};
  info.wanted = std::max(end, static_cast<std::uint32_t>(command.spp.value_or(loaded.scene.render.samples_per_pixel)));
  if (options.adaptive) {
    info.settings["adaptive"] = format("by %u samples", SampleMap::kPilot);
    info.ranges = {{0, SampleMap::kMost * options.samples_per_pixel}};
    info.wanted = options.samples_per_pixel;
  }
  info.pixels = static_cast<std::uint64_t>(crop.width) * static_cast<std::uint64_t>(crop.height);
  return info;
}

fs::path checkpoint_of(const fs::path& output) {
  fs::path file = output;
  file += ".checkpoint.exr";
  return file;
}

std::optional<ResumedFilm> resumed_film(const std::vector<fs::path>& outputs, const FilmInfo& wanted) {
  fs::path from = checkpoint_of(outputs.front());
  if (!fs::exists(from)) {
    const auto output = std::find_if(outputs.begin(), outputs.end(), FilmFile::is_one);
    if (output == outputs.end()) return std::nullopt;
    from = *output;
  }
  FilmFile file(from);
  const auto refuse = [&](const std::string& why) {
    throw Error(ErrorKind::input, from.string(), "--resume cannot go on from it: " + why);
  };
  const std::string difference = settings_difference(file.info().settings, "there", wanted.settings, "here");
  if (!difference.empty()) refuse("it is of another picture: " + difference);
  if (format("%dx%d", file.width(), file.height()) != wanted.settings.at("size"))
    refuse("its size is not what it says");
  const SampleRange range = wanted.ranges.front();
  if (file.info().ranges.size() != 1) refuse("it was merged of parts of which some are missing or not whole");
  if (file.info().ranges.front().first != range.first) {
    refuse(format("its samples begin with %u, and %u is asked for", file.info().ranges.front().first, range.first));
  }
  Film film(file.width(), file.height());
  const SampleRange taken = file.add_to(film);
  const bool adaptive = wanted.settings.contains("adaptive");
  const auto most = adaptive ? static_cast<std::uint32_t>(mean_taken(film, wanted.pixels)) : taken.end;
  const std::uint32_t asked = adaptive ? wanted.wanted : range.end - range.first;
  if (most > asked) refuse(format("it has %u samples of a pixel, and %u are asked for", most, asked));
  return ResumedFilm{std::move(film), from, taken, file.info().seconds};
}

void RepeatedWriter::write_every(double seconds) {
  if (thread_.joinable()) {
    if (ended_) finish();
    return;
  }
  if (since_last_.seconds() < seconds) return;
  ended_ = false;
  thread_ = std::thread([this] {
    const Stopwatch watch;
    try {
      write_();
    } catch (const std::exception& e) {
      failure_ = e.what();
    }
    seconds_ = watch.seconds();
    ended_ = true;
  });
}

void RepeatedWriter::finish() {
  if (!thread_.joinable()) return;
  thread_.join();
  since_last_ = Stopwatch();
  if (!failure_.empty()) warn_(failure_);
  failure_.clear();
}

double checkpoint_interval(const RenderCommand& command, double expected_seconds, double write_seconds) {
  constexpr double kLongRender = 300.0, kLeast = 60.0;
  if (command.checkpoint_every) return *command.checkpoint_every;
  return expected_seconds < kLongRender ? kInfinity : std::max(kLeast, 100.0 * write_seconds);
}

}  // namespace raylab
