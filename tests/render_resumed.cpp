// Sessions that go on from a film.
#include <chrono>
#include <optional>
#include <random>
#include <thread>
#include <utility>

#include "catch.hpp"
#include "raylab/accel/accelerator.hpp"
#include "raylab/core/parallel.hpp"
#include "session_scenes.hpp"

using namespace raylab;
using namespace raylab::test;

TEST_CASE("a session goes on from a film, however often it was stopped, to the same bits", "[unit][session]") {
  for (const SeenScene& scene : {varied_scene(), blinding_scene()}) {
    const auto accelerator = make_accelerator("list", scene.geometry);
    RenderOptions options = small_options(scene, "sobol");
    options.first_sample = 3;
    options.samples_per_pixel = 150;
    options.crop = PixelRect{2, 1, 15, 11};
    RenderSession whole(scene, *accelerator, options);
    whole.run();
    std::mt19937 random(4);
    for (int trial = 0; trial < 3; ++trial) {
      std::optional<Film> film;
      std::uint64_t camera_rays = 0;
      int stops = 0;
      for (bool finished = false; !finished;) {
        const ThreadLimit limit(1 + static_cast<int>(random() % 3));
        options.tile_size = 1 + static_cast<int>(random() % 20);
        options.pass_samples = 1 + random() % 40;
        options.integrator.isa = kCompiledIsas.front();
        RenderSession session(scene, *accelerator, options, std::move(film));
        const double before = session.progress();
        session.start();
        std::this_thread::sleep_for(std::chrono::milliseconds(random() % 8));
        session.stop();
        CHECK(session.progress() >= before);
        finished = session.finished();
        camera_rays += session.stats().rays.camera;
        film = session.film();
        ++stops;
      }
      INFO(stops << " sessions");
      CHECK(*film == whole.film());
      CHECK(camera_rays == whole.stats().rays.camera);
    }
  }
}

TEST_CASE("a film is brought to more samples as if all had been taken at once", "[unit][session]") {
  const SeenScene scene = varied_scene();
  const auto accelerator = make_accelerator("list", scene.geometry);
  RenderOptions options = small_options(scene, "independent");
  RenderSession few(scene, *accelerator, options);
  few.run();
  options.samples_per_pixel = 70;
  RenderSession more(scene, *accelerator, options, few.film());
  CHECK(more.progress() == Approx(12.0 / 70.0));
  more.run();
  CHECK(more.film() == render(scene, options));
  // Fewer than there are takes none.
  options.samples_per_pixel = 5;
  RenderSession fewer(scene, *accelerator, options, more.film());
  CHECK(fewer.progress() == 1.0);
  fewer.run();
  CHECK(fewer.film() == more.film());
}

TEST_CASE("a target of error ends the render at a pass, at the same one from wherever it goes on", "[unit][session]") {
  const SeenScene scene = varied_scene();
  const auto accelerator = make_accelerator("list", scene.geometry);
  RenderOptions options = small_options(scene, "sobol");
  options.samples_per_pixel = 100000;
  options.target_error = 0.02;
  options.most_pass_samples = options.pass_samples;
  RenderSession session(scene, *accelerator, options);
  session.run();
  CHECK(session.finished());
  const std::uint32_t taken = session.film().taken(0, 0);
  CHECK(taken < 100000);
  CHECK(session.estimated_error().relmse <= 0.02);
  const auto film_of = [&](std::uint32_t samples) {
    RenderOptions part = options;
    part.samples_per_pixel = samples;
    part.target_error.reset();
    RenderSession first(scene, *accelerator, part);
    first.run();
    return first.film();
  };
  for (const std::uint32_t before : {16u, taken - 16, taken}) {
    RenderSession second(scene, *accelerator, options, film_of(before));
    second.run();
    CHECK(second.film() == session.film());
  }
  // Pixels that have gone on say that the error was too large at the pass before, whatever it is now.
  RenderOptions part = options;
  part.samples_per_pixel = taken;
  part.target_error.reset();
  Film most = film_of(taken - 16);  // all but one pixel
  for (const PixelRect& crop : {PixelRect{0, 0, 19, 12}, PixelRect{0, 12, 18, 1}}) {
    part.crop = crop;
    RenderSession session_of_crop(scene, *accelerator, part, std::move(most));
    session_of_crop.run();
    most = session_of_crop.film();
  }
  CHECK(estimate_relmse(most, true).relmse <= 0.02);
  RenderSession last(scene, *accelerator, options, most);
  last.run();
  CHECK(last.film() == session.film());
}
