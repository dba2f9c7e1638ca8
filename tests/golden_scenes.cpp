// Every shipped scene, small, against a picture kept with the tests.
#include "catch.hpp"
#include "raylab/accel/accelerator.hpp"
#include "raylab/image/image_file.hpp"
#include "raylab/image/metrics.hpp"
#include "raylab/io/scene_file.hpp"
#include "raylab/render/render_session.hpp"
#include "shipped_scenes.hpp"

using namespace raylab;
using namespace raylab::test;
namespace fs = std::filesystem;

namespace {

Image render_small(const LoadedScene& loaded, int width, int height, std::uint32_t samples) {
  const Scene& scene = loaded.scene;
  const auto accelerator = make_accelerator("bvh", scene.geometry);
  RenderOptions options;
  options.camera = loaded.camera;
  options.width = width;
  options.height = height;
  options.samples_per_pixel = samples;
  options.integrator.max_depth = scene.render.max_depth;
  RenderSession session(scene, *accelerator, options);
  session.run();
  CHECK(session.stats().dropped == 0);
  return session.snapshot().image();
}

/// Fraction of the pixels of which a channel differs by more than 2% and 0.002.
double changed_fraction(const Image& a, const Image& b) {
  REQUIRE(a.pixels.size() == b.pixels.size());
  std::size_t changed = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    bool differs = false;
    for (int c = 0; c < 3; ++c) {
      const float x = a.pixels[i][c];
      const float y = b.pixels[i][c];
      differs |= !(std::abs(x - y) <= 0.02f * std::max(x, y) + 0.002f);
    }
    changed += differs ? 1 : 0;
  }
  return static_cast<double>(changed) / static_cast<double>(a.pixels.size());
}

}  // namespace

// The same seed gives the same paths, so all pixels agree but those where a last-bit difference between compilers or
// libraries turned a path elsewhere.
TEST_CASE("every shipped scene looks as it did", "[golden]") {
  for (const char* name : {"cornell", "one-weekend", "mirror-room", "dragon", "bunny", "globe", "forest", "lamps",
                           "caustics", "kaleidoscope"}) {
    const auto file = shipped_scene(name);
    if (!file) continue;
    INFO(name << "; made by: raylab-render " << file->string() << " --width 64 --spp 16 -o " << name << ".exr");
    const Image golden = read_exr(fs::path(RAYLAB_SOURCE_DIR) / "tests" / "golden" / (std::string(name) + ".exr"));
    const LoadedScene loaded = load_scene(*file);
    CHECK(loaded.warnings.empty());
    const Image now = render_small(loaded, golden.width, golden.height, 16);
    CHECK(changed_fraction(now, golden) < 0.03);
    CHECK(image_error(now, golden).mean_ratio == Approx(1.0).margin(0.02));
  }
}
