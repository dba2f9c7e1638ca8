// raylab-bench render: whole pictures, error against time.
#include <algorithm>

#include "raylab/core/parallel.hpp"
#include "raylab/image/image_file.hpp"
#include "whole_pictures.hpp"

namespace raylab::bench {

namespace {

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
    double samples = 2.0 * (options.reference_spp / 2);
    for (const int spp : options.spp) {
      samples += static_cast<double>(configurations.size()) * (1.0 + static_cast<double>(spp) * runs_of(options, spp));
    }
    suite.expect(samples * o.width * o.height);
    (void)suite.measured(file, samples * o.width * o.height);
  }
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const LoadedScene& loaded = scenes[i];
    // A scene is gone on with from its beginning: those that take turns are compared run by run.
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
    const bool too_narrow = options_for(context, Configuration(), 1, 0).width < kPeerWidth && !peers.empty();
    if (too_narrow)
      suite.note(format("%s: no peers below a width of %d pixels", loaded.scene.name.c_str(), kPeerWidth));
    measure_in_turns(suite, context, configurations, built, too_narrow ? std::vector<Peer>() : peers);
    compare_pictures(suite, context, configurations, built);
    suite.end_part(options.scenes[i]);
  }
  suite.finish();
  return 0;
}

}  // namespace raylab::bench
