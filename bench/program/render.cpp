// raylab-bench render: whole pictures, error against time.
#include <algorithm>
#include <cmath>
#include <map>

#include "commands.hpp"
#include "mitsuba.hpp"
#include "raylab/core/error.hpp"
#include "raylab/core/parallel.hpp"
#include "raylab/image/image_file.hpp"
#include "rendering.hpp"

namespace raylab::bench {

namespace {

/// One way to render a scene.
struct Way {
  Variant variant;
  std::string integrator = "path";
  std::string sampler = "sobol";
};

/// All combinations of what was asked for; by default the usual way, and those that differ from it in one thing.
std::vector<Way> ways_of(const RenderSuiteOptions& options) {
  std::vector<Way> ways;
  const bool nothing_named = options.accels.empty() && options.intersectors.empty() &&
                             options.integrators.empty() && options.samplers.empty();
  if (nothing_named) {
    CommonOptions usual = options;
    usual.accels = {kDefaultAccelerator, "rtiow", "embree", "embree-robust"};
    for (const Variant& variant : variants(usual, false)) ways.push_back({variant});
    ways.push_back({ways[0].variant, "book", "sobol"});
    ways.push_back({ways[0].variant, "path", "independent"});
    return ways;
  }
  const auto or_default = [](const std::vector<std::string>& given, const char* usual) {
    return given.empty() ? std::vector<std::string>{usual} : given;
  };
  for (const Variant& variant : variants_or_default(options)) {
    for (const std::string& integrator : or_default(options.integrators, "path")) {
      for (const std::string& sampler : or_default(options.samplers, "sobol")) {
        ways.push_back({variant, integrator, sampler});
      }
    }
  }
  return ways;
}

/// Everything about a scene that its rows need.
struct Stage {
  const std::string& file;
  const LoadedScene& loaded;
  const Reference& reference;
  const RenderSuiteOptions& options;
  int threads;
};

RenderOptions options_for(const Stage& stage, const Way& way, int spp, int run) {
  RenderOptions o = options_of(stage.loaded, stage.options.width);
  o.integrator.kind = parse_integrator(way.integrator);
  o.sampler = parse_sampler(way.sampler);
  o.samples_per_pixel = static_cast<std::uint32_t>(spp);
  o.seed = stage.options.seed + 1 + static_cast<std::uint32_t>(run);
  return o;
}

/// What one way gave with one number of samples, over all runs.
struct Measured {
  std::vector<double> seconds, cpu_seconds;
  std::vector<ImageError> errors;
  RayCounts rays;
};

Row start_of_row(const Stage& stage) {
  return {{"suite", "render"}, {"scene", stage.loaded.scene.name}, {"threads", stage.threads}};
}

std::string name_of(const Row& row) {
  std::string name = variant_name(row);
  if (row.contains("sampler")) {
    name += ", " + row["integrator"].get<std::string>() + ", " + row["sampler"].get<std::string>();
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

/// The row that says when the way of `row` reaches the target.
void add_time_to_error(const Stage& stage, Suite& suite, Row row, const std::vector<ErrorAtTime>& points) {
  const TimeToError time = time_to_error(points, stage.options.target_error);
  for (const char* field :
       {"spp", "runs", "seconds_min", "seconds_max", "cpu_seconds", "mpaths_per_second", "mrays_per_second",
        "relmse_error", "relmse_trimmed", "mean_ratio", "mean_ratio_error"}) {
    row.erase(field);
  }
  row["question"] = "time to error";
  row["target_relmse"] = stage.options.target_error;
  row["relmse"] = stage.options.target_error;
  row["seconds"] = time.seconds;
  row["extrapolated"] = time.extrapolated;
  suite.add({row},
            {format("%-12s %-32s relMSE %g after %.3f s%s", stage.loaded.scene.name.c_str(), name_of(row).c_str(),
                    stage.options.target_error, time.seconds, time.extrapolated ? " (extrapolated)" : "")});
}

/// Runs with so many samples per pixel: twice as many where one takes so little that a stall of the machine shows.
int runs_of(const RenderSuiteOptions& options, int spp) {
  const int most = *std::max_element(options.spp.begin(), options.spp.end());
  return spp < most ? 2 * options.repeats : options.repeats;
}

/// All ways, taking turns, with one number of samples after the other.
void measure_ways(Suite& suite, const Stage& stage, const std::vector<Way>& ways,
                  const std::vector<Built>& built) {
  const Scene& scene = stage.loaded.scene;
  std::vector<std::vector<ErrorAtTime>> points(ways.size());
  std::vector<Row> last(ways.size());
  for (const int spp : stage.options.spp) {
    std::vector<Measured> measured(ways.size());
    // The first run of each warms up: it is measured again.
    for (int run = -1; run < runs_of(stage.options, spp); ++run) {
      for (std::size_t i = 0; i < ways.size(); ++i) {
        RenderOptions o = options_for(stage, ways[i], spp, std::max(run, 0));
        if (run < 0) o.samples_per_pixel = 1;
        const Rendered rendered = render_once(suite, scene, *built[i].accelerator, o);
        if (run < 0) continue;
        measured[i].seconds.push_back(rendered.seconds);
        measured[i].cpu_seconds.push_back(rendered.cpu_seconds);
        measured[i].errors.push_back(image_error(rendered.image, stage.reference.image));
        measured[i].rays = rendered.rays;
      }
    }
    for (std::size_t i = 0; i < ways.size(); ++i) {
      const RenderOptions o = options_for(stage, ways[i], spp, 0);
      Row row = start_of_row(stage);
      add_fields(row, ways[i].variant, scene.geometry, built[i]);
      add_fields(row, o);
      add_times(row, measured[i].seconds, work_of(o));
      row["cpu_seconds"] = spread_of(measured[i].cpu_seconds).median;
      const double rays = 1e-6 * static_cast<double>(measured[i].rays.total());
      row["mrays_per_second"] = {{"median", rays / row["seconds"].get<double>()},
                                 {"min", rays / row["seconds_max"].get<double>()},
                                 {"max", rays / row["seconds_min"].get<double>()}};
      add_fields(row, combine(measured[i].errors, stage.reference), stage.reference);
      points[i].push_back({row["seconds"], row["relmse"]});
      suite.add({row}, {line_of(row)});
      last[i] = row;
    }
  }
  for (std::size_t i = 0; i < ways.size(); ++i) add_time_to_error(stage, suite, last[i], points[i]);
}

void measure_mitsuba(Suite& suite, const Stage& stage) {
  std::vector<ErrorAtTime> points;
  Row row;
  for (const int spp : stage.options.spp) {
    const RenderOptions o = options_for(stage, Way(), spp, 0);
    PeerRuns peer;
    try {
      peer = render_with_mitsuba(stage.options.peer_python, stage.file, o, stage.threads,
                                 runs_of(stage.options, spp));
    } catch (const Error& e) {
      suite.check();
      suite.note(std::string("left out: ") + e.what());
      return;
    }
    std::vector<double> seconds;
    std::vector<ImageError> errors;
    for (const PeerRun& run : peer.runs) {
      seconds.push_back(run.seconds);
      errors.push_back(image_error(run.image, stage.reference.image));
    }
    row = start_of_row(stage);
    row["renderer"] = peer.name;
    row["accel"] = "mitsuba";
    row["width"] = o.width;
    row["height"] = o.height;
    row["spp"] = spp;
    row["max_depth"] = o.integrator.max_depth;
    add_times(row, seconds, work_of(o));
    add_fields(row, combine(errors, stage.reference), stage.reference);
    points.push_back({row["seconds"], row["relmse"]});
    suite.add({row}, {line_of(row)});
    suite.check();
  }
  add_time_to_error(stage, suite, row, points);
}

/// Pictures of the accelerators at equal random numbers: where do they differ, and by how much?
void compare_pictures(Suite& suite, const Stage& stage, const std::vector<Way>& ways,
                      const std::vector<Built>& built) {
  const Scene& scene = stage.loaded.scene;
  const char* against = is_fit({"list", ""}, scene.geometry.primitive_count()) ? "list" : kDefaultAccelerator;
  const auto right = make_accelerator(against, scene.geometry);
  const RenderOptions o = options_for(stage, Way(), stage.options.spp.front(), 0);
  const Image expected = render_once(suite, scene, *right, o).image;
  for (std::size_t i = 0; i < ways.size(); ++i) {
    const bool is_usual = ways[i].integrator == "path" && ways[i].sampler == "sobol";
    if (!is_usual || ways[i].variant.name() == against) continue;
    const Image image = render_once(suite, scene, *built[i].accelerator, o).image;
    const ImageError error = image_error(image, expected);
    std::string picture = "difference-" + scene.name + "-" + ways[i].variant.name() + ".png";
    std::replace(picture.begin(), picture.end(), ' ', '-');
    write_png(suite.folder().path() / picture, error_picture(image, expected, 0.1));
    Row row = start_of_row(stage);
    row["question"] = "difference";
    add_fields(row, ways[i].variant);
    add_fields(row, o);
    row["against"] = against;
    row["different_pixels"] = different_pixels(image, expected);
    row["pixels"] = expected.pixels.size();
    row["relmse"] = error.relmse;
    row["mean_ratio"] = error.mean_ratio;
    row["picture"] = picture;
    suite.add({row}, {format("%-12s %-32s differs from %s in %zu of %zu pixels, relMSE %.2g", scene.name.c_str(),
                             ways[i].variant.name().c_str(), against, error.different_pixels,
                             expected.pixels.size(), error.relmse)});
  }
}

}  // namespace

int render(const RenderSuiteOptions& given) {
  RenderSuiteOptions options = given;
  std::sort(options.spp.begin(), options.spp.end());
  const std::vector<Way> ways = ways_of(options);
  for (const Way& way : ways) {
    (void)parse_integrator(way.integrator);
    (void)parse_sampler(way.sampler);
  }
  Suite suite(options.out, "render", options.command_line);
  const InterruptGuard guard;
  const ThreadLimit limit(options.threads);
  const int threads = options.threads > 0 ? options.threads : hardware_threads();
  const std::string no_mitsuba = why_no_mitsuba(options.peer_python);
  if (!no_mitsuba.empty()) suite.note("Mitsuba 3 left out: " + no_mitsuba);
  std::filesystem::path cache = options.cache;
  if (cache.empty()) cache = suite.folder().path() / "references";

  std::vector<LoadedScene> scenes;
  for (const std::string& file : options.scenes) {
    scenes.push_back(load(suite, file));
    const RenderOptions o = options_of(scenes.back(), options.width);
    double samples = 2.0 * (options.reference_spp / 2);
    for (const int spp : options.spp) {
      samples += static_cast<double>(ways.size()) * (1.0 + static_cast<double>(spp) * runs_of(options, spp));
    }
    suite.expect(samples * o.width * o.height);
  }
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const LoadedScene& loaded = scenes[i];
    std::vector<Built> built;
    for (const Way& way : ways) built.push_back(build(way.variant, loaded.scene.geometry, threads));
    const auto trusted = make_accelerator(kDefaultAccelerator, loaded.scene.geometry);
    const Reference reference =
        reference_of(suite, loaded, *trusted, options_of(loaded, options.width), options.reference_spp, cache);
    suite.note(format("%s: the reference's own relMSE is %.2g, its mean is good to %.2g",
                      loaded.scene.name.c_str(), reference.relmse, reference.mean_ratio_error));
    const Stage stage{options.scenes[i], loaded, reference, options, threads};
    measure_ways(suite, stage, ways, built);
    compare_pictures(suite, stage, ways, built);
    if (no_mitsuba.empty()) measure_mitsuba(suite, stage);
  }
  suite.finish();
  return 0;
}

}  // namespace raylab::bench
