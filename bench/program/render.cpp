// raylab-bench render: whole pictures, error against time.
#include <algorithm>
#include <cmath>
#include <map>

#include "commands.hpp"
#include "peer.hpp"
#include "raylab/core/error.hpp"
#include "raylab/core/parallel.hpp"
#include "raylab/image/image_file.hpp"
#include "rendering.hpp"

namespace raylab::bench {

namespace {

/// What a scene is rendered with.
struct Configuration {
  Variant variant;
  std::string integrator = "path";
  std::string sampler = "sobol";
  std::string ray_offset = "bounds";
};

/// Returns all combinations of what was asked for; where nothing was, the default configuration and those that
/// differ from it in one thing.
std::vector<Configuration> configurations_of(const RenderSuiteOptions& options) {
  std::vector<Configuration> configurations;
  const bool nothing_named = options.accels.empty() && options.intersectors.empty() && options.integrators.empty() &&
                             options.samplers.empty() && options.ray_offsets.empty();
  if (nothing_named) {
    CommonOptions defaults = options;
    defaults.accels = {kDefaultAccelerator, "rtiow", "embree", "embree-robust"};
    for (const Variant& variant : variants(defaults, false)) configurations.push_back({variant});
    configurations.push_back({configurations[0].variant, "book", "sobol"});
    configurations.push_back({configurations[0].variant, "path", "independent"});
    configurations.push_back({configurations[0].variant, "path", "sobol", "book"});
    configurations.push_back(configurations[0]);
    configurations.back().variant.intersector = "book";
    return configurations;
  }
  const auto or_default = [](const std::vector<std::string>& given, const char* fallback) {
    return given.empty() ? std::vector<std::string>{fallback} : given;
  };
  for (const Variant& variant : variants_or_default(options)) {
    for (const std::string& integrator : or_default(options.integrators, "path")) {
      for (const std::string& sampler : or_default(options.samplers, "sobol")) {
        for (const std::string& ray_offset : or_default(options.ray_offsets, "bounds")) {
          configurations.push_back({variant, integrator, sampler, ray_offset});
        }
      }
    }
  }
  return configurations;
}

/// Holds what all measurements of one scene have in common.
struct SceneContext {
  const std::string& file;
  const LoadedScene& loaded;
  const Reference& reference;
  const RenderSuiteOptions& options;
  int threads;
};

RenderOptions options_for(const SceneContext& context, const Configuration& configuration, int spp, int run) {
  RenderOptions o = options_of(context.loaded, context.options.width);
  o.integrator.kind = parse_integrator(configuration.integrator);
  o.integrator.ray_offset = configuration.ray_offset == "book" ? RayOffset::book : RayOffset::bounds;
  o.sampler = parse_sampler(configuration.sampler);
  o.samples_per_pixel = static_cast<std::uint32_t>(spp);
  o.seed = context.options.seed + 1 + static_cast<std::uint32_t>(run);
  return o;
}

/// Collects what the runs of one configuration gave at one number of samples.
struct Runs {
  std::vector<double> seconds, cpu_seconds;
  std::vector<ImageError> errors;
  RayCounts rays;
};

Row scene_row(const SceneContext& context) {
  return {{"suite", "render"}, {"scene", context.loaded.scene.name}, {"threads", context.threads}};
}

std::string name_of(const Row& row) {
  std::string name = variant_name(row);
  if (row.contains("sampler")) {
    name += ", " + row["integrator"].get<std::string>() + ", " + row["sampler"].get<std::string>();
    if (row.contains("ray_offset")) name += ", offset of the book";
  }
  return name;
}

std::string line_of(const Row& row) {
  return format("%-12s %-32s %4d spp  %7.3f s  relMSE %-8.3g ± %-8.2g trimmed %-8.3g mean ratio %.5f ± %.5f",
                row["scene"].get<std::string>().c_str(), name_of(row).c_str(), row["spp"].get<int>(),
                row["seconds"].get<double>(), row["relmse"].get<double>(), row.value("relmse_error", 0.0),
                row["relmse_trimmed"].get<double>(), row["mean_ratio"].get<double>(),
                row["mean_ratio_error"].get<double>());
}

/// Adds the row that says when the configuration of `row` reaches the target.
void add_time_to_error(const SceneContext& context, Suite& suite, Row row, const std::vector<ErrorAtTime>& points) {
  const TimeToError time = time_to_error(points, context.options.target_error);
  for (const char* field :
       {"spp", "runs", "seconds_min", "seconds_max", "cpu_seconds", "mpaths_per_second", "mrays_per_second",
        "start_up_seconds", "relmse_noise", "relmse_error", "relmse_trimmed", "mean_ratio", "mean_ratio_error"}) {
    row.erase(field);
  }
  row["question"] = "time to error";
  row["target_relmse"] = context.options.target_error;
  row["relmse"] = context.options.target_error;
  row["seconds"] = time.seconds;
  row["extrapolated"] = time.extrapolated;
  suite.add({row},
            {format("%-12s %-32s relMSE %g after %.3f s%s", context.loaded.scene.name.c_str(), name_of(row).c_str(),
                    context.options.target_error, time.seconds, time.extrapolated ? " (extrapolated)" : "")});
}

/// Returns how often to render with so many samples per pixel: twice as often where a render takes so little time
/// that a stall of the machine shows.
int runs_of(const RenderSuiteOptions& options, int spp) {
  const int most = *std::max_element(options.spp.begin(), options.spp.end());
  return spp < most ? 2 * options.repeats : options.repeats;
}

/// The work of all configurations with so many samples per pixel, one more of each being the warm-up.
double spp_work(const RenderSuiteOptions& options, const RenderOptions& size, std::size_t configurations, int spp) {
  return static_cast<double>(configurations) * (1.0 + static_cast<double>(spp) * runs_of(options, spp)) * size.width *
         size.height;
}

/// The fields that say what a configuration's row with so many samples per pixel is of, the accelerator's own aside.
Row point_row(const SceneContext& context, const Configuration& configuration, int spp) {
  const RenderOptions o = options_for(context, configuration, spp, 0);
  Row row = scene_row(context);
  add_fields(row, configuration.variant);
  row["triangles"] = context.loaded.scene.geometry.triangle_count();
  row["spheres"] = context.loaded.scene.geometry.spheres.size();
  add_fields(row, o);
  if (o.integrator.ray_offset == RayOffset::book) row["ray_offset"] = "book";
  return row;
}

/// The row that was measured of it before the run was interrupted.
Row known_row(const Suite& suite, const Row& point) {
  const auto is_known = [&](const Row& row) {
    return has_values(row, point) && name_of(row) == name_of(point) && !row.contains("question");
  };
  const std::vector<Row>& rows = suite.folder().results().rows;
  const auto found = std::find_if(rows.begin(), rows.end(), is_known);
  if (found == rows.end())
    throw Error(ErrorKind::input, suite.folder().path().string(), "lacks rows that its run has measured");
  return *found;
}

/// Renders all configurations with one number of samples after the other, their runs interleaved.
void measure_configurations(Suite& suite, const SceneContext& context, const std::vector<Configuration>& configurations,
                            const std::vector<Built>& built) {
  const Scene& scene = context.loaded.scene;
  std::vector<std::vector<ErrorAtTime>> points(configurations.size());
  std::vector<Row> last(configurations.size());
  for (const int spp : context.options.spp) {
    const std::string part = context.file + format(" %d spp", spp);
    if (suite.measured(part, spp_work(context.options, options_of(context.loaded, context.options.width),
                                      configurations.size(), spp))) {
      for (std::size_t i = 0; i < configurations.size(); ++i) {
        last[i] = known_row(suite, point_row(context, configurations[i], spp));
        points[i].push_back({last[i]["seconds"], last[i]["relmse"]});
      }
      continue;
    }
    std::vector<Runs> runs(configurations.size());
    // The first run of each warms up and is measured again.
    for (int run = -1; run < runs_of(context.options, spp); ++run) {
      for (std::size_t i = 0; i < configurations.size(); ++i) {
        RenderOptions o = options_for(context, configurations[i], spp, std::max(run, 0));
        if (run < 0) o.samples_per_pixel = 1;
        const Rendered rendered = render_once(suite, scene, *built[i].accelerator, o);
        if (run < 0) continue;
        runs[i].seconds.push_back(rendered.seconds);
        runs[i].cpu_seconds.push_back(rendered.cpu_seconds);
        runs[i].errors.push_back(image_error(rendered.image, context.reference.image));
        runs[i].rays = rendered.rays;
      }
    }
    for (std::size_t i = 0; i < configurations.size(); ++i) {
      const RenderOptions o = options_for(context, configurations[i], spp, 0);
      Row row = point_row(context, configurations[i], spp);
      add_fields(row, configurations[i].variant, scene.geometry, built[i]);
      add_times(row, runs[i].seconds, work_of(o));
      row["cpu_seconds"] = spread_of(runs[i].cpu_seconds).median;
      const double rays = 1e-6 * static_cast<double>(runs[i].rays.total());
      row["mrays_per_second"] = {{"median", rays / row["seconds"].get<double>()},
                                 {"min", rays / row["seconds_max"].get<double>()},
                                 {"max", rays / row["seconds_min"].get<double>()}};
      add_fields(row, combine(runs[i].errors, context.reference), context.reference);
      points[i].push_back({row["seconds"], row["relmse"]});
      suite.add({row}, {line_of(row)});
      last[i] = row;
    }
    suite.end_part(part);
  }
  const std::string part = context.file + " time to error";
  if (suite.measured(part)) return;
  for (std::size_t i = 0; i < configurations.size(); ++i) add_time_to_error(context, suite, last[i], points[i]);
  suite.end_part(part);
}

/// Returns the relMSE that the peer's pictures have against their own mean. Where its model is not quite ours this is
/// noise alone, with no share of the difference.
double noise_of(const std::vector<PeerRun>& runs, const Image& reference) {
  const auto n = static_cast<float>(runs.size());
  Image mean = reference;
  for (std::size_t i = 0; i < mean.pixels.size(); ++i) {
    mean.pixels[i] = Rgb(0.0f);
    for (const PeerRun& run : runs) mean.pixels[i] += run.image.pixels[i] / n;
  }
  double sum = 0.0;
  for (const PeerRun& run : runs) {
    Image noise = reference;
    for (std::size_t i = 0; i < mean.pixels.size(); ++i) noise.pixels[i] += run.image.pixels[i] - mean.pixels[i];
    sum += image_error(noise, reference).relmse;
  }
  return sum / (n - 1.0);
}

/// A peer's picture is taken where rendering is measured, not its launch: at this width and so many seconds a point.
constexpr int kPeerWidth = 400;
constexpr double kPeerSeconds = 1.0;

void measure_peer(Suite& suite, const SceneContext& context, const Peer& peer) {
  std::vector<ErrorAtTime> points;
  Row row;
  // The longest point comes first: where it is too short, so are all others.
  for (auto spp = context.options.spp.rbegin(); spp != context.options.spp.rend(); ++spp) {
    const RenderOptions o = options_for(context, Configuration(), *spp, 0);
    const int runs = std::max(2, runs_of(context.options, *spp));
    PeerRuns measured;
    try {
      measured = render_with(peer, context.options.peer_python, context.file, o, context.threads, runs);
    } catch (const Error& e) {
      suite.check();
      suite.note(std::string("left out: ") + e.what());
      break;
    }
    suite.check();
    std::vector<double> seconds, cpu_seconds;
    std::vector<ImageError> errors;
    for (const PeerRun& run : measured.runs) {
      seconds.push_back(run.seconds);
      cpu_seconds.push_back(run.cpu_seconds);
      errors.push_back(image_error(run.image, context.reference.image));
    }
    if (spread_of(seconds).median < kPeerSeconds) {
      suite.note(format("%s: %s with %d samples a pixel takes %.2f s, less than %g: not taken",
                        context.loaded.scene.name.c_str(), peer.name.c_str(), *spp, spread_of(seconds).median,
                        kPeerSeconds));
      break;
    }
    row = scene_row(context);
    row["renderer"] = peer.name + " " + measured.version + " " + measured.variant;
    row["accel"] = peer.name;
    row["peer"] = peer.name;
    row["version"] = measured.version;
    row["settings"] = measured.settings;
    row["differences"] = measured.differences;
    row["width"] = o.width;
    row["height"] = o.height;
    row["spp"] = measured.samples_per_pixel;
    row["max_depth"] = o.integrator.max_depth;
    RenderOptions taken = o;
    taken.samples_per_pixel = measured.samples_per_pixel;
    add_times(row, seconds, work_of(taken));
    row["cpu_seconds"] = spread_of(cpu_seconds).median;
    row["start_up_seconds"] = measured.start_up_seconds;
    add_fields(row, combine(errors, context.reference), context.reference);
    row["relmse_noise"] = noise_of(measured.runs, context.reference.image);
    points.insert(points.begin(), {row["seconds"], row["relmse_noise"]});
    suite.add({row}, {line_of(row)});
  }
  if (!points.empty()) add_time_to_error(context, suite, row, points);
}

/// Renders with all accelerators from equal random numbers and records where the pictures differ, and by how much.
void compare_pictures(Suite& suite, const SceneContext& context, const std::vector<Configuration>& configurations,
                      const std::vector<Built>& built) {
  const Scene& scene = context.loaded.scene;
  const char* against = is_fit({"list", ""}, scene.geometry.primitive_count()) ? "list" : kDefaultAccelerator;
  const auto reference = make_accelerator(against, scene.geometry);
  const RenderOptions o = options_for(context, Configuration(), context.options.spp.front(), 0);
  const Image expected = render_once(suite, scene, *reference, o).image;
  for (std::size_t i = 0; i < configurations.size(); ++i) {
    const bool is_default = configurations[i].integrator == "path" && configurations[i].sampler == "sobol" &&
                            configurations[i].ray_offset == "bounds";
    if (!is_default || configurations[i].variant.name() == against) continue;
    const Image image = render_once(suite, scene, *built[i].accelerator, o).image;
    const ImageError error = image_error(image, expected);
    std::string picture = "difference-" + scene.name + "-" + configurations[i].variant.name() + ".png";
    std::replace(picture.begin(), picture.end(), ' ', '-');
    write_png(suite.folder().path() / picture, error_picture(image, expected, 0.1));
    Row row = scene_row(context);
    row["question"] = "difference";
    add_fields(row, configurations[i].variant);
    add_fields(row, o);
    row["against"] = against;
    row["different_pixels"] = different_pixels(image, expected);
    row["pixels"] = expected.pixels.size();
    row["relmse"] = error.relmse;
    row["mean_ratio"] = error.mean_ratio;
    row["picture"] = picture;
    suite.add({row}, {format("%-12s %-32s differs from %s in %zu of %zu pixels, relMSE %.2g", scene.name.c_str(),
                             configurations[i].variant.name().c_str(), against,
                             row["different_pixels"].get<std::size_t>(), expected.pixels.size(), error.relmse)});
  }
}

}  // namespace

int render(const RenderSuiteOptions& given) {
  RenderSuiteOptions options = given;
  std::sort(options.spp.begin(), options.spp.end());
  const std::vector<Configuration> configurations = configurations_of(options);
  for (const Configuration& configuration : configurations) {
    (void)parse_integrator(configuration.integrator);
    (void)parse_sampler(configuration.sampler);
  }
  Suite suite(options, "render");
  const InterruptGuard guard;
  const ThreadLimit limit(options.threads);
  const int threads = options.threads > 0 ? options.threads : hardware_threads();
  std::vector<Peer> peers;
  if (options.peer_python.empty()) suite.note("peers left out: no --peer-python was given");
  for (const std::string& name : options.peer_python.empty() ? std::vector<std::string>() : options.peers) {
    const Peer peer = parse_peer(name);
    const std::string reason = why_not(peer, options.peer_python);
    if (reason.empty()) peers.push_back(peer);
    if (!reason.empty()) suite.note(name + " left out: " + reason);
  }
  std::filesystem::path cache = options.cache;
  if (cache.empty()) cache = suite.folder().path() / "references";

  std::vector<LoadedScene> scenes;
  for (const std::string& file : options.scenes) {
    scenes.push_back(load(suite, file));
    const RenderOptions o = options_of(scenes.back(), options.width);
    double work = 2.0 * (options.reference_spp / 2) * o.width * o.height;
    for (const int spp : options.spp) work += spp_work(options, o, configurations.size(), spp);
    suite.expect(work);
    (void)suite.measured(file, work);
  }
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const LoadedScene& loaded = scenes[i];
    if (suite.measured(options.scenes[i])) continue;
    std::vector<Built> built;
    for (const Configuration& configuration : configurations)
      built.push_back(build(configuration.variant, loaded.scene.geometry, threads));
    const auto accelerator = make_accelerator(kDefaultAccelerator, loaded.scene.geometry);
    const Reference reference =
        reference_of(suite, loaded, *accelerator, options_of(loaded, options.width), options.reference_spp, cache);
    suite.note(format("%s: the reference's own relMSE is %.2g, its mean is good to %.2g", loaded.scene.name.c_str(),
                      reference.relmse, reference.mean_ratio_error));
    const SceneContext context{options.scenes[i], loaded, reference, options, threads};
    measure_configurations(suite, context, configurations, built);
    if (const std::string part = context.file + " differences"; !suite.measured(part)) {
      compare_pictures(suite, context, configurations, built);
      suite.end_part(part);
    }
    if (options_for(context, Configuration(), 1, 0).width < kPeerWidth && !peers.empty()) {
      suite.note(format("%s: no peers below a width of %d pixels", loaded.scene.name.c_str(), kPeerWidth));
      suite.end_part(context.file);
      continue;
    }
    for (const Peer& peer : peers) {
      const std::string part = context.file + " " + peer.name + ":" + peer.variant;
      if (suite.measured(part)) continue;
      measure_peer(suite, context, peer);
      suite.end_part(part);
    }
    suite.end_part(context.file);
  }
  suite.finish();
  return 0;
}

}  // namespace raylab::bench
