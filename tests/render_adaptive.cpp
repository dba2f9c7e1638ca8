// Renders that take their samples where the error is.
#include <algorithm>
#include <bit>
#include <cmath>
#include <random>
#include <vector>

#include "catch.hpp"
#include "expect_error.hpp"
#include "raylab/accel/accelerator.hpp"
#include "raylab/core/parallel.hpp"
#include "session_scenes.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

constexpr PixelRect kAll{0, 0, 24, 20};

bool on_the_right(int x, int) { return x >= kAll.width / 2; }
bool above(int, int y) { return y < kAll.height / 2; }

/// kPilot samples of each pixel, with much noise in one half and little in the other.
Film noisy_pilot(unsigned seed, bool (*is_noisy)(int, int) = on_the_right) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform;
  Film film(kAll.width, kAll.height);
  for (int y = 0; y < kAll.height; ++y) {
    for (int x = 0; x < kAll.width; ++x) {
      const float noise = is_noisy(x, y) ? 1.0f : 0.05f;
      for (std::uint32_t i = 0; i < SampleMap::kPilot; ++i) film.add(x, y, Rgb(1.0f + noise * uniform(random)));
    }
  }
  return film;
}

RenderOptions adaptive_options(const SeenScene& scene) {
  RenderOptions options = small_options(scene, "sobol");
  options.samples_per_pixel = 70;
  options.adaptive = true;
  return options;
}

/// A small lamp, which scattering alone meets rarely, on the floor and through a ball of glass.
SeenScene glass_under_lamp() {
  SeenScene scene;
  add_quad(scene, {-2, 0, -2}, {0, 0, 4}, {4, 0, 0}, lambertian(grey(0.7f)));
  add_sphere(scene, {0, 0.6f, 0}, 0.5f, glass());
  add_quad(scene, {0.4f, 2.5f, -0.2f}, {0.3f, 0, 0}, {0, 0, 0.3f}, light(grey(40.0f)));
  look(scene, {0, 2, 3}, {0, 0.2f, 0}, 50.0f);
  return scene;
}

struct Moments {
  double sum = 0.0, squares = 0.0;
  int count = 0;
  void add(double x) {
    sum += x;
    squares += x * x;
    ++count;
  }
  Estimate estimate() const {
    const double mean = sum / count;
    return {mean, std::sqrt((squares / count - mean * mean) / (count - 1))};
  }
};

double sum_of(const Film& film) { return mean_luminance(film).mean; }

}  // namespace

TEST_CASE("samples go where the noise is, as many as are asked for, and more wherever more are", "[unit][adaptive]") {
  for (const auto is_noisy : {on_the_right, above}) {
    const SampleMap map(noisy_pilot(1, is_noisy), kAll);
    std::vector<std::uint32_t> before(kAll.width * kAll.height, 0);
    for (const std::uint32_t mean : {16u, 17u, 20u, 40u, 64u, 100u, 1000u, 100000u, 400000000u}) {
      INFO(mean);
      const SampleMap::Counts counts = map.counts(mean);
      std::uint64_t total = 0, of_noisy = 0;
      int wrong = 0, uneven = 0;
      for (int y = 0; y < kAll.height; ++y) {
        for (int x = 0; x < kAll.width; ++x) {
          const std::uint32_t samples = map.samples(counts, x, y);
          std::uint32_t& less = before[static_cast<std::size_t>(y * kAll.width + x)];
          wrong += samples < less || samples < 16 || samples > std::uint64_t{SampleMap::kMost} * mean;
          wrong += 5 * std::uint64_t{samples} < mean;  // a quarter, rounded
          uneven += samples % (std::bit_floor(samples) / 2) != 0;
          less = samples;
          total += samples;
          if (is_noisy(x, y)) of_noisy += samples;
        }
      }
      CHECK(wrong == 0);
      CHECK(uneven == 0);
      CHECK(total == counts.total);
      const std::uint64_t asked = std::uint64_t{mean} * kAll.width * kAll.height;
      CHECK(total <= asked);
      CHECK(static_cast<double>(total) > 0.85 * static_cast<double>(asked));
      if (mean >= 64) CHECK(of_noisy > 3 * (total - of_noisy));
    }
  }
}

TEST_CASE("a picture without noise has the same number of samples everywhere", "[unit][adaptive]") {
  Film film(kAll.width, kAll.height);
  for (int y = 0; y < kAll.height; ++y) {
    for (int x = 0; x < kAll.width; ++x) {
      for (std::uint32_t i = 0; i < SampleMap::kPilot; ++i) film.add(x, y, Rgb(0.5f));
    }
  }
  const SampleMap map(film, kAll);
  const SampleMap::Counts counts = map.counts(64);
  CHECK(counts.total == 64u * kAll.width * kAll.height);
  CHECK(map.samples(counts, 3, 4) == 64);
}

TEST_CASE("a pixel's number of samples depends on none of its own, nor of its colour's", "[unit][adaptive]") {
  const Film one = noisy_pilot(1);
  for (const int color : {0, 1}) {
    // Pixels of the colour from another film, with bright ones among them.
    Film mixed(kAll.width, kAll.height);
    for (int y = 0; y < kAll.height; ++y) {
      for (int x = 0; x < kAll.width; ++x) {
        const bool changed = ((x + y) & 1) == color;
        for (std::uint32_t i = 0; i < SampleMap::kPilot; ++i) {
          mixed.add(x, y, changed ? Rgb(i == 3 ? static_cast<float>(x * y) : 1.0f) : one.mean(x, y));
        }
      }
    }
    Film same(kAll.width, kAll.height);
    for (int y = 0; y < kAll.height; ++y) {
      for (int x = 0; x < kAll.width; ++x) {
        for (std::uint32_t i = 0; i < SampleMap::kPilot; ++i) same.add(x, y, one.mean(x, y));
      }
    }
    const SampleMap a(mixed, kAll), b(same, kAll);
    const SampleMap::Counts counts_a = a.counts(100), counts_b = b.counts(100);
    int own_differ = 0, others_differ = 0;
    for (int y = 0; y < kAll.height; ++y) {
      for (int x = 0; x < kAll.width; ++x) {
        const bool differ = a.samples(counts_a, x, y) != b.samples(counts_b, x, y);
        (((x + y) & 1) == color ? own_differ : others_differ) += differ;
      }
    }
    CHECK(own_differ == 0);
    CHECK(others_differ > 0);
  }
}

TEST_CASE("threads, tiles, passes and instruction sets do not change a bit of an adaptive picture",
          "[unit][session][adaptive]") {
  const SeenScene scene = varied_scene();
  for (const bool crops : {false, true}) {
    RenderOptions options = adaptive_options(scene);
    if (crops) options.crop = PixelRect{2, 1, 15, 11};
    const Film reference = render(scene, options);
    std::uint32_t fewest = ~0u, most = 0;
    for (int y = 1; y < 12; ++y) {
      for (int x = 2; x < 17; ++x) {
        fewest = std::min(fewest, reference.taken(x, y));
        most = std::max(most, reference.taken(x, y));
      }
    }
    CHECK(fewest >= 16);
    CHECK(most > 2 * fewest);
    struct Way {
      int threads, tile;
      std::uint32_t pass;
    };
    for (const Way& way : {Way{1, 7, 1}, Way{3, 7, 1}, Way{3, 1, 5}, Way{1, 64, 16}, Way{3, 7, 16}, Way{3, 64, 100}}) {
      const ThreadLimit limit(way.threads);
      options.tile_size = way.tile;
      options.pass_samples = way.pass;
      CHECK(different_pixels(render(scene, options), reference) == 0);
    }
    for (const Isa isa : kCompiledIsas) {
      if (!isa_supported(isa)) continue;
      options.integrator.isa = isa;
      CHECK(different_pixels(render(scene, options), reference) == 0);
    }
  }
}

TEST_CASE("an adaptive render goes on from a film to the same bits, with more samples too",
          "[unit][session][adaptive]") {
  for (const SeenScene& scene : {varied_scene(), blinding_scene()}) {
    const auto accelerator = make_accelerator("list", scene.geometry);
    RenderOptions options = adaptive_options(scene);
    RenderSession whole(scene, *accelerator, options);
    whole.run();
    CHECK(whole.progress() == 1.0);
    CHECK(whole.time_share() == Approx(1.0));
    std::mt19937 random(4);
    std::optional<Film> film;
    for (const std::uint32_t samples : {7u, 16u, 17u, 33u, 64u, 70u}) {
      options.samples_per_pixel = samples;
      options.pass_samples = 1 + random() % 40;
      RenderSession session(scene, *accelerator, options, std::move(film));
      session.run();
      CHECK(session.finished());
      CHECK(session.progress() == 1.0);
      film = session.film();
      session.run();  // takes none
      CHECK(session.film() == *film);
    }
    CHECK(*film == whole.film());
    // Some pixels alone have gone on: as where it was stopped in a pass.
    options.samples_per_pixel = 16;
    RenderSession few(scene, *accelerator, options);
    few.run();
    Film torn = few.film();
    torn.add(whole.film().rows(0, 1));
    for (int x = 0; x < torn.width(); ++x) CHECK(torn.taken(x, 0) > 16);
    Film mixed(torn.width(), torn.height());
    mixed.add(whole.film().rows(0, 7));
    options.samples_per_pixel = 70;
    RenderSession rest(scene, *accelerator, options, mixed);
    rest.run();
    CHECK(rest.film() == whole.film());
    CHECK(rest.time_share() == Approx(1.0));
  }
}

TEST_CASE("an adaptive render ends at a target of error, at the same pass from wherever it goes on",
          "[unit][session][adaptive]") {
  const SeenScene scene = varied_scene();
  const auto accelerator = make_accelerator("list", scene.geometry);
  RenderOptions options = adaptive_options(scene);
  options.samples_per_pixel = 100000;
  options.target_error = 0.015;
  options.most_pass_samples = options.pass_samples;
  RenderSession session(scene, *accelerator, options);
  session.run();
  CHECK(session.finished());
  CHECK(session.progress() < 1.0);
  CHECK(session.estimated_error().relmse <= 0.015);
  RenderSession again(scene, *accelerator, options, session.film());
  again.run();
  CHECK(again.film() == session.film());
  RenderOptions part = options;
  part.samples_per_pixel = 24;
  part.target_error.reset();
  RenderSession second(scene, *accelerator, options, render(scene, part));
  second.run();
  CHECK(second.film() == session.film());
}

TEST_CASE("adaptive sampling has the mean of uniform sampling, and stopping by a pixel's own samples has not",
          "[statistical][adaptive]") {
  const SeenScene scene = glass_under_lamp();
  const auto accelerator = make_accelerator("list", scene.geometry);
  RenderOptions options = render_options(14, 12, 64);
  options.camera = scene.camera;
  options.sampler = SamplerKind::independent;
  options.integrator.strategies = {false, false, false};
  Moments uniform, adaptive, naive;
  for (options.seed = 1; options.seed <= 400; ++options.seed) {
    const auto film_of = [&](std::uint32_t samples) {
      options.samples_per_pixel = samples;
      RenderSession session(scene, *accelerator, options);
      session.run();
      return session.film();
    };
    options.adaptive = false;
    const Film few = film_of(16), many = film_of(64);
    // From seeds of its own, as the test takes both to be independent.
    options.adaptive = true;
    options.seed += 1000;
    const Film placed = film_of(48);
    options.seed -= 1000;
    uniform.add(sum_of(many));
    adaptive.add(sum_of(placed));
    // What looks calm after 16 samples is left at them.
    Film stopped(few.width(), few.height());
    for (int y = 0; y < few.height(); ++y) {
      for (int x = 0; x < few.width(); ++x) {
        const double mean = luminance(few.mean(x, y));
        const bool is_calm = std::sqrt(few.variance_of_mean(x, y).g) <= 0.1 * mean;
        stopped.add(x, y, (is_calm ? few : many).mean(x, y));
      }
    }
    naive.add(sum_of(stopped));
  }
  const Estimate expected = uniform.estimate();
  INFO(expected.mean << " ± " << expected.error << ", adaptive " << adaptive.estimate().mean << " ± "
                     << adaptive.estimate().error << ", naive " << naive.estimate().mean << " ± "
                     << naive.estimate().error);
  CHECK(std::abs(difference_z(adaptive.estimate(), expected)) < 3.9);  // one in 10,000 by chance
  CHECK(difference_z(naive.estimate(), expected) < -6.0);
}

TEST_CASE("adaptive sampling has less error at as many samples", "[statistical][adaptive]") {
  // A caustic on a floor that is lit evenly.
  const SeenScene scene = glass_under_lamp();
  const auto accelerator = make_accelerator("list", scene.geometry);
  RenderOptions options = render_options(32, 24, 64);
  options.camera = scene.camera;
  options.sampler = SamplerKind::independent;
  Estimate error[2];
  for (const bool adaptive : {false, true}) {
    options.adaptive = adaptive;
    for (options.seed = 1; options.seed <= 10; ++options.seed) {
      RenderSession session(scene, *accelerator, options);
      session.run();
      error[adaptive].mean += session.estimated_error().relmse;
    }
  }
  CHECK(error[1].mean < 0.8 * error[0].mean);
}

TEST_CASE("parts of the samples and more than indices reach are refused of an adaptive render", "[unit][adaptive]") {
  const SeenScene scene = varied_scene();
  const auto accelerator = make_accelerator("list", scene.geometry);
  RenderOptions options = adaptive_options(scene);
  options.first_sample = 3;
  expect_error(ErrorKind::usage, "--adaptive", {"--samples"}, [&] { RenderSession(scene, *accelerator, options); });
  options.first_sample = 0;
  options.samples_per_pixel = 429496730;
  expect_error(ErrorKind::usage, "--adaptive", {"429496729"}, [&] { RenderSession(scene, *accelerator, options); });
}
