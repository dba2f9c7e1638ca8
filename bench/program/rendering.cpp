#include "rendering.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>

#include "raylab/core/error.hpp"
#include "raylab/core/random.hpp"
#include "raylab/core/timing.hpp"
#include "raylab/image/image_file.hpp"

namespace raylab::bench {

namespace fs = std::filesystem;

namespace {

constexpr std::uint32_t kReferenceSeed = 4711;

/// A picture from the cache, or made now.
Image cached_picture(Suite& suite, const Scene& scene, const Accelerator& accelerator, const RenderOptions& options,
                     const fs::path& file) {
  if (fs::exists(file)) {
    Image image = read_exr(file);
    if (image.width != options.width || image.height != options.height) {
      throw Error(ErrorKind::input, file.string(),
                  format("the reference has %d x %d pixels, expected %d x %d; remove it to have it made again",
                         image.width, image.height, options.width, options.height));
    }
    suite.advance(work_of(options));
    return image;
  }
  check_writable_image(file);
  Image image = render_once(suite, scene, accelerator, options).image;
  write_exr(file, image);
  return image;
}

/// Of the picture's first samples, bit by bit: another for all that changes pictures, the program's code too.
std::uint64_t hash_of_start(const Scene& scene, const Accelerator& accelerator, RenderOptions options) {
  options.samples_per_pixel = 1;
  RenderSession session(scene, accelerator, options);
  session.run();
  std::uint64_t hash = 0;
  for (const Rgb& pixel : session.film().image().pixels) {
    for (int c = 0; c < 3; ++c)
      hash = mix_bits((hash + 0x9e3779b97f4a7c15ull) ^ std::bit_cast<std::uint32_t>(pixel[c]));
  }
  return hash;
}

}  // namespace

double work_of(const RenderOptions& options) {
  return static_cast<double>(options.width) * options.height * options.samples_per_pixel;
}

Rendered render_once(Suite& suite, const Scene& scene, const Accelerator& accelerator, const RenderOptions& options) {
  RenderSession session(scene, accelerator, options);
  const CpuStopwatch cpu(CpuClock::process);
  session.start();
  while (!session.wait_for(0.05)) suite.check(session.progress() * work_of(options));
  const double cpu_seconds = cpu.seconds();
  suite.advance(work_of(options));
  const RenderStats stats = session.stats();
  return {session.film().image(), stats.seconds, cpu_seconds, stats.rays, session.estimated_error()};
}

RenderOptions options_of(const LoadedScene& loaded, int width) {
  const Scene& scene = loaded.scene;
  RenderOptions options;
  options.camera = loaded.camera;
  options.width = width > 0 ? width : scene.render.width;
  const double aspect = static_cast<double>(scene.render.width) / scene.render.height;
  options.height = std::max(1, static_cast<int>(std::lround(options.width / aspect)));
  options.integrator.max_depth = scene.render.max_depth;
  return options;
}

Reference reference_of(Suite& suite, const LoadedScene& loaded, const Accelerator& accelerator,
                       const RenderOptions& options, int spp, const fs::path& cache) {
  std::error_code error;
  fs::create_directories(cache, error);
  if (error) throw Error(ErrorKind::output, cache.string(), "cannot be made: " + error.message());
  std::vector<Image> halves;
  for (std::uint32_t half = 0; half < 2; ++half) {
    RenderOptions o = options;
    o.seed = kReferenceSeed + half;
    o.samples_per_pixel = static_cast<std::uint32_t>(std::max(1, spp / 2));
    const std::string name =
        format("%s-%016llx-%dx%d-%dsegments-%s-%s-%uspp-seed%u-%s-%016llx.exr", loaded.scene.name.c_str(),
               static_cast<unsigned long long>(loaded.hash), o.width, o.height, o.integrator.max_depth,
               std::string(integrator_name(o.integrator.kind)).c_str(), std::string(sampler_name(o.sampler)).c_str(),
               o.samples_per_pixel, o.seed, RAYLAB_VERSION,
               static_cast<unsigned long long>(hash_of_start(loaded.scene, accelerator, o)));
    halves.push_back(cached_picture(suite, loaded.scene, accelerator, o, cache / name));
  }
  return make_reference(halves[0], halves[1]);
}

std::size_t different_pixels(const Image& image, const Image& expected) {
  constexpr float kSame = 1e-3f;
  std::size_t count = 0;
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const Rgb difference = glm::abs(image.pixels[i] - expected.pixels[i]);
    count += glm::any(glm::greaterThan(difference, kSame * glm::abs(expected.pixels[i]))) ? 1 : 0;
  }
  return count;
}

void add_fields(Row& row, const RenderOptions& options) {
  row["integrator"] = integrator_name(options.integrator.kind);
  row["sampler"] = sampler_name(options.sampler);
  add_size(row, options);
}

void add_size(Row& row, const RenderOptions& options) {
  row["width"] = options.width;
  row["height"] = options.height;
  row["spp"] = options.samples_per_pixel;
  row["max_depth"] = options.integrator.max_depth;
}

void add_fields(Row& row, const RunErrors& errors, const Reference& reference) {
  row["relmse"] = errors.relmse;
  row["relmse_error"] = errors.relmse_error;
  row["relmse_trimmed"] = errors.relmse_trimmed;
  row["mean_ratio"] = errors.mean_ratio;
  row["mean_ratio_error"] = errors.mean_ratio_error;
  row["reference_relmse"] = reference.relmse;
}

void add_times(Row& row, const std::vector<double>& seconds, double paths) {
  const Spread spread = spread_of(seconds);
  row["runs"] = seconds.size();
  row["seconds"] = spread.median;
  row["seconds_min"] = spread.min;
  row["seconds_max"] = spread.max;
  row["mpaths_per_second"] = 1e-6 * paths / spread.median;
}

}  // namespace raylab::bench
