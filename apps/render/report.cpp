#include "report.hpp"

#include <cinttypes>
#include <nlohmann/json.hpp>

#include "raylab/core/parallel.hpp"
#include "raylab/core/text.hpp"

namespace raylab {

namespace {

double mebibytes(std::size_t bytes) { return static_cast<double>(bytes) / (1024.0 * 1024.0); }

double millions_per_second(std::uint64_t count, double seconds) {
  return seconds > 0.0 ? 1e-6 * static_cast<double>(count) / seconds : 0.0;
}

int threads_of(const RenderCommand& command) { return command.threads > 0 ? command.threads : hardware_threads(); }

std::string scene_text(const LoadedScene& loaded, double load_seconds) {
  const Scene& scene = loaded.scene;
  return format("scene      %zu triangles, %zu spheres, %zu materials, %zu textures; %.1f MiB; loaded in %.3f s\n",
                scene.geometry.triangle_count(), scene.geometry.spheres.size(), scene.materials.size(),
                scene.textures.size(), mebibytes(scene.bytes()), load_seconds);
}

}  // namespace

std::string check_text(const RenderCommand& command, const LoadedScene& loaded, const RenderOptions& options,
                       double load_seconds) {
  std::string text = scene_text(loaded, load_seconds);
  const bool has_map = options.adaptive && options.samples_per_pixel > SampleMap::kPilot;
  const std::size_t film = (Film::kBytes + (has_map ? SampleMap::kBytes : 0)) *
                           static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height);
  text += format("film       %d x %d pixels, %.1f MiB; %u samples a pixel\n", options.width, options.height,
                 mebibytes(film), options.samples_per_pixel);
  const double each = find_accelerator(command.accel).capabilities.bytes_per_primitive;
  const auto accelerator =
      static_cast<std::size_t>(each * static_cast<double>(loaded.scene.geometry.primitive_count()));
  text += format("accel      %s: ", command.accel.c_str());
  text += each > 0.0 ? format("about %.1f MiB, at %.0f bytes a primitive\n", mebibytes(accelerator), each)
                     : std::string("takes memory that is not known before it is built\n");
  text += format("memory     %.1f MiB%s: scene, film and accelerator, which is what a render takes\n",
                 mebibytes(loaded.scene.bytes() + film + accelerator),
                 each > 0.0 ? ", an estimate" : " and that of the accelerator");
  text += "materials\n";
  for (const std::string& note : loaded.notes) text += "  " + note + "\n";
  text += "needs\n";
  const SceneNeeds needs = scene_needs(loaded.scene);
  for (const std::string& line : describe(needs)) text += line + "\n";
  const LightStatistics lights = light_statistics(loaded.scene, needs);
  text += format(
      "bytes\n  %zu of geometry, material ids and pictures\n  %zu for the sampling of %zu lights\n"
      "  %zu of mesh attributes that no material reads were left out\n",
      loaded.scene.bytes(), lights.bytes, lights.count, loaded.dropped_bytes);
  return text;
}

std::string accelerator_text(const RenderCommand& command) {
  std::string text = command.accel;
  if (!command.intersector.empty()) text += ", " + command.intersector;
  if (!command.quality.empty()) text += ", " + command.quality + " quality";
  if (command.compact) text += ", compact";
  return text;
}

std::string report_text(const RenderReport& r) {
  const RenderStats& s = r.stats;
  std::string text = scene_text(r.loaded, r.load_seconds);
  text += format("accel      %s: built in %.3f s, %.1f MiB, %zu primitives", accelerator_text(r.command).c_str(),
                 r.build.seconds, mebibytes(r.build.bytes), r.build.primitives);
  if (r.build.invalid_primitives > 0) text += format(" (%zu invalid left out)", r.build.invalid_primitives);
  if (!r.build.isa.empty()) text += ", " + r.build.isa;
  text += "\n";
  text += format("rays       %" PRIu64 " camera + %" PRIu64 " scattered + %" PRIu64 " shadow = %.2f Mrays/s\n",
                 s.rays.camera, s.rays.scattered, s.rays.shadow, millions_per_second(s.rays.total(), s.seconds));
  text += format("render     %.3f s on %d threads, %.3f Mpaths/s\n", s.seconds, threads_of(r.command),
                 millions_per_second(s.rays.camera, s.seconds));
  if (r.mirror_chains > 0) {
    text +=
        format("mirrors    lights are sampled over %zu chains of plane mirrors too (--strategies)\n", r.mirror_chains);
  }
  if (r.sphere_chains > 0) {
    text += format("spheres    lights are sampled over %zu ways off and through spheres too (--strategies)\n",
                   r.sphere_chains);
  }
  if (r.options.adaptive) {
    text += format("adaptive   %u to %u samples a pixel, where the error is\n", r.taken.first, r.taken.end);
  }
  if (r.stopped_by != "samples") {
    text += format("stopped    by %s with %u to %u of %u samples a pixel\n", r.stopped_by.c_str(), r.taken.first,
                   r.taken.end, r.options.samples_per_pixel);
  }
  text += "error      " +
          (r.error.relmse < kInfinity ? "estimated relMSE " + r.error.text()
                                      : std::string("not estimated: that takes two samples per pixel")) +
          "\n";
  if (s.dropped > 0) {
    text += format("dropped    %" PRIu64 " samples that were not finite; the first again: ", s.dropped) +
            replay_command(r) + "\n";
  } else {
    text += "dropped    0 samples\n";
  }
  if (s.too_bright > 0) {
    text += format("clamped    %" PRIu64 " samples brighter than %.2g count as that much: weaken the lights\n",
                   s.too_bright, ExactSum::kLargest);
  }
  if (s.too_dark > 0) {
    text +=
        format("faded      %" PRIu64 " samples darker than %.2g have lost precision, or all: strengthen the lights\n",
               s.too_dark, ExactSum::kLeast);
  }
  return text;
}

std::string replay_command(const RenderReport& r) {
  const DroppedSample d = r.stats.first_dropped.value_or(DroppedSample{});
  std::string command = r.command.command_line;
  if (r.options.adaptive) command += " --no-adaptive";  // the sample is the same
  return command + format(" --width %d --height %d --crop %d,%d,1,1 --samples %u:%u", r.options.width, r.options.height,
                          d.x, d.y, d.sample, d.sample + 1);
}

std::string report_json(const RenderReport& r) {
  const RenderStats& s = r.stats;
  nlohmann::ordered_json json;
  json["command"] = r.command.command_line;
  json["version"] = RAYLAB_VERSION;
  json["scene"] = r.loaded.scene.name;
  json["scene_hash"] = format("%016" PRIx64, r.loaded.hash);
  json["triangles"] = r.loaded.scene.geometry.triangle_count();
  json["spheres"] = r.loaded.scene.geometry.spheres.size();
  json["lights"] = r.light_count;
  json["scene_bytes"] = r.loaded.scene.bytes();
  json["light_bytes"] = r.light_bytes;
  json["mirror_chains"] = r.mirror_chains;
  json["sphere_chains"] = r.sphere_chains;
  json["dropped_bytes"] = r.loaded.dropped_bytes;
  json["load_seconds"] = r.load_seconds;
  json["accel"] = r.command.accel;
  if (!r.command.intersector.empty()) json["intersector"] = r.command.intersector;
  if (!r.command.quality.empty()) json["quality"] = r.command.quality;
  if (r.command.compact) json["compact"] = true;
  json["isa"] = r.build.isa;
  json["build_seconds"] = r.build.seconds;
  json["bytes"] = r.build.bytes;
  json["sah_cost"] = r.build.sah_cost;
  json["invalid_primitives"] = r.build.invalid_primitives;
  json["integrator"] = integrator_name(r.options.integrator.kind);
  json["sampler"] = sampler_name(r.options.sampler);
  json["width"] = r.options.width;
  json["height"] = r.options.height;
  json["spp"] = r.options.samples_per_pixel;
  json["adaptive"] = r.options.adaptive;
  json["max_depth"] = r.options.integrator.max_depth;
  json["seed"] = r.options.seed;
  json["threads"] = threads_of(r.command);
  json["seconds"] = s.seconds;
  json["rays"] = {{"camera", s.rays.camera}, {"scattered", s.rays.scattered}, {"shadow", s.rays.shadow}};
  json["mrays_per_second"] = millions_per_second(s.rays.total(), s.seconds);
  json["mpaths_per_second"] = millions_per_second(s.rays.camera, s.seconds);
  // JSON has no infinity: an error that is not known is absent.
  if (r.error.relmse < kInfinity) {
    json["estimated_relmse"] = r.error.relmse;
    json["estimated_relmse_95"] = {{"low", r.error.low}, {"high", r.error.high}};
    json["estimated_relmse_reliable"] = r.error.reliable;
  }
  json["dropped_samples"] = s.dropped;
  if (s.dropped > 0) json["replay"] = replay_command(r);
  json["clamped_samples"] = s.too_bright;
  json["faded_samples"] = s.too_dark;
  json["partial"] = r.partial;
  json["stopped_by"] = r.stopped_by;
  json["samples_taken"] = {{"fewest", r.taken.first}, {"most", r.taken.end}};
  if (r.seconds_before > 0.0) json["seconds_before"] = r.seconds_before;
  // Names of files need not be UTF-8, which JSON is.
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace raylab
