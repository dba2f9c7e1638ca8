#include <algorithm>
#include <cmath>
#include <string>
#include <thread>
#include <vector>

#include "catch.hpp"
#include "expect_error.hpp"
#include "raylab/accel/accelerator.hpp"
#include "raylab/core/parallel.hpp"
#include "session_scenes.hpp"

using namespace raylab;
using namespace raylab::test;

TEST_CASE("threads, tiles and passes do not change a bit of the picture", "[unit][session]") {
  const SeenScene scene = varied_scene();
  for (const char* sampler : {"independent", "sobol"}) {
    const RenderOptions reference_options = small_options(scene, sampler);
    const Film reference = render(scene, reference_options);
    for (const int threads : {1, 2, 8}) {
      const ThreadLimit limit(threads);
      for (const int tile : {1, 7, 16, 64}) {
        for (const std::uint32_t pass : {1u, 5u, 12u, 100u}) {
          RenderOptions options = reference_options;
          options.tile_size = tile;
          options.pass_samples = pass;
          INFO(sampler << ", " << threads << " threads, tiles of " << tile << ", passes of " << pass);
          CHECK(different_pixels(render(scene, options), reference) == 0);
        }
      }
    }
    RenderOptions other = reference_options;
    other.seed = 6;
    CHECK(different_pixels(render(scene, other), reference) > 19 * 13 * 9 / 10);
  }
}

TEST_CASE("every instruction set gives the same picture to the bit", "[unit][session]") {
  const SeenScene scene = varied_scene();
  for (const IntegratorKind kind : {IntegratorKind::path, IntegratorKind::book}) {
    for (const char* sampler : {"independent", "sobol"}) {
      RenderOptions options = small_options(scene, sampler);
      options.integrator.kind = kind;
      options.integrator.isa = kCompiledIsas.front();
      const Film reference = render(scene, options);
      for (const Isa isa : kCompiledIsas) {
        if (!isa_supported(isa)) continue;
        options.integrator.isa = isa;
        CHECK(different_pixels(render(scene, options), reference) == 0);
      }
    }
  }
}

TEST_CASE("an instruction set that the processor lacks is refused", "[unit][session]") {
  const SeenScene scene = varied_scene();
  const auto accelerator = make_accelerator("list", scene.geometry);
  RenderOptions options = small_options(scene, "sobol");
  options.integrator.isa = static_cast<Isa>(200);  // of the real ones this processor may have all
  expect_error(ErrorKind::usage, "--isa", {"this processor has no"},
               [&] { RenderSession(scene, *accelerator, options); });
}

TEST_CASE("ranges of samples rendered apart add up to the whole to the bit", "[unit][session]") {
  const SeenScene scene = varied_scene();
  for (const char* sampler : {"independent", "sobol"}) {
    const auto range = [&](std::uint32_t first, std::uint32_t count) {
      RenderOptions options = small_options(scene, sampler);
      options.first_sample = first;
      options.samples_per_pixel = count;
      return render(scene, options);
    };
    const Film whole = range(0, 16);
    Film merged = range(5, 11);
    merged.add(range(0, 5));
    CHECK(merged == whole);
    CHECK(different_pixels(range(1, 16), whole) > 19 * 13 * 9 / 10);
  }
}

TEST_CASE("a crop holds the same pixels as the whole picture", "[unit][session]") {
  const SeenScene scene = varied_scene();
  RenderOptions options = small_options(scene, "sobol");
  const Film whole = render(scene, options);
  for (const PixelRect& crop : {PixelRect{4, 3, 9, 5}, PixelRect{0, 0, 19, 13}, PixelRect{18, 12, 1, 1}}) {
    options.crop = crop;
    const Film film = render(scene, options);
    REQUIRE(film.width() == 19);
    REQUIRE(film.height() == 13);
    int wrong = 0;
    for (int y = 0; y < 13; ++y) {
      for (int x = 0; x < 19; ++x) {
        const bool inside = x >= crop.x && x < crop.x + crop.width && y >= crop.y && y < crop.y + crop.height;
        wrong += film.samples(x, y) != (inside ? 12u : 0u);
        wrong += film.mean(x, y) != (inside ? whole.mean(x, y) : Rgb(0.0f));
      }
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("samples that are not finite are dropped, counted, and the first can be made again", "[unit][session]") {
  const SeenScene scene = blinding_scene();
  const auto accelerator = make_accelerator("list", scene.geometry);
  RenderOptions options = render_options(8, 6, 64);
  options.camera = scene.camera;
  for (const int tile : {1, 3, 16}) {
    options.tile_size = tile;
    options.pass_samples = static_cast<std::uint32_t>(tile);
    RenderSession session(scene, *accelerator, options);
    session.run();
    const Film film = session.snapshot();
    const RenderStats stats = session.stats();

    // One sample after the other, as the report's reader would do it.
    const FlushDenormals flush;
    std::uint64_t dropped = 0;
    std::optional<DroppedSample> first;
    int wrong_counts = 0, bad_pixels = 0;
    for (int y = 0; y < options.height; ++y) {
      for (int x = 0; x < options.width; ++x) {
        std::uint32_t kept = 0;
        for (std::uint32_t s = 0; s < options.samples_per_pixel; ++s) {
          PathBatch path;
          path.sampler = options.sampler;
          path.add(x, y, PixelSeed(options.seed, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)), s);
          BatchRadiance radiance;
          RayCounts counts;
          session.integrator().trace(path, radiance, counts);
          if (is_finite({radiance[0][0], radiance[1][0], radiance[2][0]})) {
            ++kept;
          } else {
            ++dropped;
            if (!first) first = DroppedSample{x, y, s};
          }
        }
        wrong_counts += film.samples(x, y) != kept;
        bad_pixels += !is_finite(film.mean(x, y));
      }
    }
    REQUIRE(dropped > 0);
    REQUIRE(dropped < 8 * 6 * 64);
    CHECK(wrong_counts == 0);
    CHECK(bad_pixels == 0);
    CHECK(stats.dropped == dropped);
    CHECK(stats.rays.camera == 8 * 6 * 64);
    REQUIRE(stats.first_dropped);
    CHECK(stats.first_dropped->x == first->x);
    CHECK(stats.first_dropped->y == first->y);
    CHECK(stats.first_dropped->sample == first->sample);
  }
}

TEST_CASE("samples too bright or too dark for the film are counted", "[unit][session]") {
  struct Case {
    float radiance;
    std::uint64_t too_bright, too_dark;
  };
  for (const Case& c : {Case{1e13f, 64, 0}, Case{1e12f, 0, 0}, Case{1.0f, 0, 0}, Case{1e-12f, 0, 0},
                        Case{1e-13f, 0, 64}, Case{1e-30f, 0, 64}, Case{0.0f, 0, 0}}) {
    Scene scene;
    set_sky(scene, Rgb(c.radiance, 0.0f, 0.0f));
    const auto accelerator = make_accelerator("list", scene.geometry);
    RenderSession session(scene, *accelerator, render_options(4, 4, 4));
    session.run();
    INFO("radiance " << c.radiance);
    CHECK(session.stats().too_bright == c.too_bright);
    CHECK(session.stats().too_dark == c.too_dark);
    CHECK(session.stats().dropped == 0);
  }
}

TEST_CASE("a session that has run is finished and does not run again", "[unit][session]") {
  const SeenScene scene = varied_scene();
  const auto accelerator = make_accelerator("list", scene.geometry);
  RenderSession session(scene, *accelerator, small_options(scene, "sobol"));
  CHECK_FALSE(session.finished());
  CHECK(session.progress() == 0.0);
  CHECK(session.snapshot().samples(3, 3) == 0);
  session.run();
  CHECK(session.finished());
  CHECK(session.progress() == 1.0);
  const Film film = session.snapshot();
  CHECK(film.samples(3, 3) == 12);
  CHECK(session.stats().rays.camera == 19 * 13 * 12);
  CHECK(session.stats().dropped == 0);
  CHECK(session.stats().seconds > 0.0);
  session.run();
  CHECK(different_pixels(session.snapshot(), film) == 0);
  CHECK(session.stats().rays.camera == 19 * 13 * 12);
}

TEST_CASE("a started session ends by itself and gives the same picture", "[unit][session]") {
  const SeenScene scene = varied_scene();
  const auto accelerator = make_accelerator("list", scene.geometry);
  RenderSession session(scene, *accelerator, small_options(scene, "sobol"));
  session.start();
  while (!session.wait_for(5.0)) {
  }
  CHECK(session.finished());
  CHECK(session.wait_for(0.0));
  session.stop();
  CHECK(session.finished());
  CHECK(different_pixels(session.snapshot(), render(scene, small_options(scene, "sobol"))) == 0);
}

TEST_CASE("a stopped session leaves whole samples of some pixels and says it is not finished", "[unit][session]") {
  const SeenScene scene = varied_scene();
  const auto accelerator = make_accelerator("list", scene.geometry);
  RenderOptions options = small_options(scene, "sobol");
  options.samples_per_pixel = 1u << 30;  // days
  options.pass_samples = 2;
  options.tile_size = 4;
  RenderSession session(scene, *accelerator, options);
  session.start();
  while (session.snapshot().samples(9, 6) < 4) std::this_thread::yield();
  CHECK_FALSE(session.wait_for(0.0));
  CHECK(session.progress() > 0.0);
  CHECK(session.progress() < 1.0);
  session.stop();
  CHECK(session.wait_for(0.0));
  CHECK_FALSE(session.finished());

  const Film film = session.snapshot();
  std::uint32_t fewest = ~0u, most = 0;
  std::uint64_t total = 0;
  for (int y = 0; y < film.height(); ++y) {
    for (int x = 0; x < film.width(); ++x) {
      fewest = std::min(fewest, film.samples(x, y));
      most = std::max(most, film.samples(x, y));
      total += film.samples(x, y);
    }
  }
  CHECK(fewest >= 2);
  CHECK(most <= 2 * fewest);  // one pass at most, as long as all before
  CHECK(most % 2 == 0);
  CHECK(session.stats().rays.camera == total);
  // What is there is what a shorter render would have.
  options.samples_per_pixel = fewest;
  const Film few = render(scene, options);
  options.samples_per_pixel = most;
  const Film many = render(scene, options);
  int wrong = 0;
  for (int y = 0; y < film.height(); ++y) {
    for (int x = 0; x < film.width(); ++x) {
      wrong += film.mean(x, y) != (film.samples(x, y) == fewest ? few : many).mean(x, y);
    }
  }
  CHECK(wrong == 0);
  session.run();  // stopped is stopped
  CHECK(different_pixels(session.snapshot(), film) == 0);
}

TEST_CASE("a session can be stopped before it starts and destroyed while it runs", "[unit][session]") {
  const SeenScene scene = varied_scene();
  const auto accelerator = make_accelerator("list", scene.geometry);
  RenderOptions options = small_options(scene, "sobol");
  options.samples_per_pixel = 1u << 30;
  {
    RenderSession session(scene, *accelerator, options);
    session.request_stop();
    session.run();
    CHECK(session.snapshot().samples(0, 0) == 0);
    CHECK_FALSE(session.finished());
  }
  {
    RenderSession session(scene, *accelerator, options);
    session.start();
  }
  {
    RenderSession session(scene, *accelerator, options);
    session.stop();
    CHECK_FALSE(session.wait_for(0.0));  // nothing was started, so nothing has ended
  }
}

TEST_CASE("snapshots taken while rendering only ever grow", "[unit][session]") {
  const SeenScene scene = varied_scene();
  const auto accelerator = make_accelerator("list", scene.geometry);
  RenderOptions options = small_options(scene, "sobol");
  options.pass_samples = 1;
  options.samples_per_pixel = 200;
  RenderSession session(scene, *accelerator, options);
  session.start();
  double progress = 0.0;
  std::uint64_t before = 0;
  int shrunk = 0;
  for (bool ended = false; !ended;) {
    ended = session.wait_for(0.002);
    const Film film = session.snapshot();
    std::uint64_t samples = 0;
    for (int y = 0; y < film.height(); ++y) {
      for (int x = 0; x < film.width(); ++x) samples += film.samples(x, y);
    }
    const double now = session.progress();
    shrunk += samples < before || now < progress || now > 1.0;
    before = samples;
    progress = now;
  }
  CHECK(shrunk == 0);
  CHECK(before == 19 * 13 * 200);
}

TEST_CASE("options that make no picture are refused with what was found", "[unit][session]") {
  const SeenScene scene = varied_scene();
  const auto accelerator = make_accelerator("list", scene.geometry);
  const auto refused = [&](ErrorKind kind, const char* place, std::initializer_list<const char*> parts,
                           const auto& change) {
    RenderOptions options = small_options(scene, "sobol");
    change(options);
    expect_error(kind, place, parts, [&] { RenderSession session(scene, *accelerator, options); });
  };
  refused(ErrorKind::input, "render", {"0x13"}, [](RenderOptions& o) { o.width = 0; });
  refused(ErrorKind::input, "render", {"19x-2"}, [](RenderOptions& o) { o.height = -2; });
  refused(ErrorKind::input, "render.max_depth", {"0", "at least 1"},
          [](RenderOptions& o) { o.integrator.max_depth = 0; });
  refused(ErrorKind::usage, "render", {"at least 1"}, [](RenderOptions& o) { o.samples_per_pixel = 0; });
  refused(ErrorKind::usage, "render", {"at least 1"}, [](RenderOptions& o) { o.tile_size = 0; });
  refused(ErrorKind::usage, "render", {"at least 1"}, [](RenderOptions& o) { o.pass_samples = 0; });
  refused(ErrorKind::usage, "--samples", {"4294967295"}, [](RenderOptions& o) { o.first_sample = 0xfffffff8u; });
  for (const PixelRect& crop : {PixelRect{0, 0, 20, 1}, PixelRect{-1, 0, 2, 2}, PixelRect{0, 12, 1, 2},
                                PixelRect{3, 3, 0, 1}, PixelRect{2147483647, 0, 2147483647, 1}}) {
    refused(ErrorKind::usage, "--crop", {"19x13", "X,Y,WIDTH,HEIGHT"}, [&](RenderOptions& o) { o.crop = crop; });
  }
}

TEST_CASE("the tiles cover each pixel of a region once, its middle first", "[unit][session]") {
  for (const PixelRect& region : {PixelRect{0, 0, 100, 60}, PixelRect{13, 7, 33, 65}, PixelRect{5, 5, 1, 1}}) {
    for (const int size : {1, 7, 16, 200}) {
      std::vector<int> covered(static_cast<std::size_t>(region.width) * region.height, 0);
      const auto tiles = centre_out_tiles(region, size);
      for (const PixelRect& t : tiles) {
        for (int y = t.y; y < t.y + t.height; ++y) {
          for (int x = t.x; x < t.x + t.width; ++x) {
            ++covered.at(static_cast<std::size_t>(y - region.y) * region.width + (x - region.x));
          }
        }
      }
      CHECK(std::all_of(covered.begin(), covered.end(), [](int n) { return n == 1; }));
      const auto distance = [&](const PixelRect& t) {
        return std::max(std::abs(t.x + 0.5 * size - region.x - 0.5 * region.width),
                        std::abs(t.y + 0.5 * size - region.y - 0.5 * region.height));
      };
      int backwards = 0;
      for (std::size_t i = 1; i < tiles.size(); ++i) backwards += distance(tiles[i]) < distance(tiles[i - 1]) - size;
      CHECK(backwards == 0);
    }
  }
}
