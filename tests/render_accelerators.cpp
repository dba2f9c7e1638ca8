// The picture is a matter of the scene: accelerators only find the same hits, up to rounding.
#include <cmath>
#include <string>
#include <vector>

#include "catch.hpp"
#include "raylab/accel/accelerator.hpp"
#include "test_scenes.hpp"

using namespace raylab;
using namespace raylab::test;

TEST_CASE("pictures of all accelerators agree with the list's at equal seed", "[agreement][accelerators]") {
  // Where they differ: another rounding of t, u or v moves the next ray by its last bits, and a choice further on,
  // such as whether glass reflects, may fall the other way.
  const SeenScene scene = lit_room();
  RenderOptions options = render_options(32, 32, 16);
  options.camera = scene.camera;
  const auto picture_of = [&](const std::string& name, std::optional<Intersector> intersector) {
    AcceleratorOptions choice;
    choice.intersector = intersector;
    const auto accelerator = make_accelerator(name, scene.geometry, choice);
    RenderSession session(scene, *accelerator, options);
    session.run();
    CHECK(session.stats().dropped == 0);
    return session.snapshot();
  };
  const Film reference = picture_of("list", Intersector::watertight);
  const Estimate expected = mean_luminance(reference);

  struct Choice {
    std::string name;
    std::optional<Intersector> intersector;
  };
  std::vector<Choice> choices = {{"list", Intersector::fast}, {"list", Intersector::book}};
  for (const AcceleratorEntry& entry : accelerators()) choices.push_back({entry.name, {}});
  for (const Choice& choice : choices) {
    const Film film = picture_of(choice.name, choice.intersector);
    const Estimate found = mean_luminance(film);
    int visible = 0;
    for (int y = 0; y < 32; ++y) {
      for (int x = 0; x < 32; ++x) {
        const Rgb a = film.mean(x, y);
        const Rgb b = reference.mean(x, y);
        visible += max_component(glm::abs(a - b)) > 0.01f * (max_component(b) + 0.01f);
      }
    }
    const std::string label =
        choice.name + (choice.intersector ? ", " + std::string(intersector_name(*choice.intersector)) : "");
    WARN(label << ": of 1024 pixels " << different_pixels(film, reference) << " differ from the list's in some bit, "
               << visible << " by more than 1%; mean ratio " << found.mean / expected.mean);
    CHECK(std::abs(found.mean - expected.mean) < 4.0 * expected.error);
    CHECK(visible < 1024 / 10);
    if (choice.name == "list" && !choice.intersector) CHECK(different_pixels(film, reference) == 0);
  }
}
