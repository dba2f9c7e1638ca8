// Light over plane mirrors.
#include <cmath>

#include "catch.hpp"
#include "expect_error.hpp"
#include "render/mirror_images.hpp"
#include "strategies.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

/// A corridor between two mirrors, its lamp behind a wall but for what the mirrors show of it.
SeenScene corridor() {
  SeenScene s;
  add_quad(s, {-3, 0, -6}, {0, 0, 12}, {6, 0, 0}, lambertian(grey(0.7f)));
  add_quad(s, {-1.5f, 0, -6}, {0, 0, 12}, {0, 3, 0}, metal(grey(0.9f), 0.0f));
  add_quad(s, {1.5f, 0, -6}, {0, 0, 12}, {0, 3, 0}, metal(grey(0.5f), 0.0f));
  add_quad(s, {-0.7f, 0, -2}, {1.4f, 0, 0}, {0, 3, 0}, lambertian(grey(0.7f)));
  add_quad(s, {-0.1f, 1.0f, -3}, {0.2f, 0, 0}, {0, 0.2f, 0}, light(grey(100.0f)));
  look(s, {0, 1.5f, 4.0f}, {0, 0.6f, 0}, 50.0f);
  return s;
}

MirrorImages mirrors_of(const Scene& scene, const Lights& lights, int max_depth = 8) {
  return {scene, lights, max_depth};
}

}  // namespace

TEST_CASE("a lamp that only mirrors show is found by sampling over them", "[statistical][mirrors]") {
  check_strategy(corridor(), &Strategies::mirror, 8, 0.0625);
}

TEST_CASE("many lamps, which a tree chooses, are found over mirrors without a bias", "[statistical][mirrors]") {
  SeenScene scene = corridor();
  for (int i = 0; i < 20; ++i) {
    const auto at = static_cast<float>(i);
    add_sphere(scene, {-1.2f + 0.12f * at, 0.5f + 0.1f * at, -4.0f + 0.35f * at}, 0.05f, light(grey(1.0f + at)));
  }
  CHECK_FALSE(Lights(scene, scene_needs(scene)).tree().empty());
  RenderOptions options = render_options(16, 16, 2048, 8);
  options.sampler = SamplerKind::independent;
  const Estimate with = mean_luminance(render(scene, options));
  options.integrator.kind = IntegratorKind::book;
  options.samples_per_pixel = 4096;
  const Estimate book = mean_luminance(render(scene, options));
  INFO(with.mean << " ± " << with.error << ", book " << book.mean << " ± " << book.error);
  CHECK(std::abs(difference_z(with, book)) < 4.0);
  CHECK(std::hypot(with.error, book.error) < 0.015 * book.mean);
}

TEST_CASE("a picture of a sky is left to scattering where mirrors show it", "[statistical][mirrors]") {
  SeenScene scene = corridor();
  set_sky(scene, 8, 4, [](int x, int y) { return y < 2 ? Rgb(20.0f + 10.0f * x) : Rgb(0.5f); });
  check_strategy(scene, &Strategies::mirror, 8, 1.2);
}

TEST_CASE("mirrors are told by their planes, and chains of them are chosen with their shares", "[unit][mirrors]") {
  const SeenScene scene = corridor();
  const Lights lights(scene, scene_needs(scene));
  const MirrorImages mirrors = mirrors_of(scene, lights);
  REQUIRE_FALSE(mirrors.empty());
  // With two mirrors there are two chains of each length; the longest, and those of the dark mirror, give too little.
  CHECK((mirrors.count() >= 4 && mirrors.count() <= 12));
  double sum = 0.0;
  for (std::uint32_t chain = 1; chain <= mirrors.count(); ++chain) sum += mirrors.share(chain);
  CHECK(sum == Approx(1.0).epsilon(1e-6));
  CHECK(mirrors.share(0) == 1.0f);
  CHECK(mirrors.share(MirrorImages::kLost) == 0.0f);
  vec3 p(0, 1, 0);
  std::uint32_t chain = 0;
  CHECK_FALSE(mirrors.follow(0, 0, chain, p));  // the floor
  CHECK(mirrors.follow(1, 1, chain, p));
  CHECK(p.x == Approx(-3.0f));
  CHECK(mirrors.share(chain) > 0.0f);
  std::uint32_t twice = chain;
  CHECK(mirrors.follow(1, 0, twice, p));  // a plane mirror does not show itself
  CHECK(twice == MirrorImages::kLost);
  p = vec3(-3, 1, 0);
  CHECK(mirrors.follow(2, 0, chain, p));
  CHECK(p.x == Approx(6.0f));
  CHECK((chain != 0 && chain != MirrorImages::kLost));
  // The density of a sample is that of the light from the point's image, times the share.
  const MirroredLight light = mirrors.sample({0, 1, 0}, 0.0f, std::uint64_t{1} << 63, 0.5f, 1);
  REQUIRE(light.pdf > 0.0f);
  CHECK(glm::length(light.wi - glm::normalize(light.image - vec3(0, 1, 0))) < 1e-6f);
  CHECK(light.image.y == Approx(light.light.y));
  CHECK(std::abs(light.image.x) == Approx(3.0f - std::abs(light.light.x)).margin(0.2));
  CHECK_FALSE(mirrors.sample({0, 1, 0}, 0.0f, std::uint64_t{1} << 63, 0.5f, 0).pdf > 0.0f);
}

TEST_CASE("where there is no plane mirror, no lamp or no room for a chain nothing is sampled", "[unit][mirrors]") {
  SeenScene scene = corridor();
  const Lights lights(scene, scene_needs(scene));
  CHECK(mirrors_of(scene, lights, 2).empty());
  CHECK(mirrors_of(scene, lights, 3).count() == 2);
  for (Material& m : scene.materials) m.fuzz = m.kind == Material::Kind::metal ? 0.1f : m.fuzz;
  CHECK(mirrors_of(scene, lights).empty());
  Scene bent;
  add_smooth_sphere(bent, vec3(0), 1.0f, 10, metal(grey(0.9f), 0.0f));
  bent.geometry.meshes[0].normals.clear();
  bent.geometry.meshes[0].normal_indices.clear();
  add_quad(bent, {-1, 3, -1}, {2, 0, 0}, {0, 0, 2}, light(grey(1.0f)));
  const Lights bent_lights(bent, scene_needs(bent));
  CHECK(mirrors_of(bent, bent_lights).empty());
  bent.materials[1] = lambertian(grey(0.5f));
  CHECK(mirrors_of(bent, Lights(bent, scene_needs(bent))).empty());
}

TEST_CASE("strategies are chosen by name, each with those that it needs", "[unit][mirrors]") {
  CHECK(parse_strategies("auto").mirror);
  CHECK(parse_strategies("auto").sphere);
  CHECK(parse_strategies("bsdf,light,sphere").sphere);
  CHECK(parse_strategies("bsdf,light").light);
  CHECK_FALSE(parse_strategies("bsdf,light").mirror);
  CHECK_FALSE(parse_strategies("bsdf").light);
  expect_error(ErrorKind::usage, "--strategies", {"lights", "bsdf"}, [] { parse_strategies("bsdf,lights"); });
  expect_error(ErrorKind::usage, "--strategies", {"bsdf"}, [] { parse_strategies("bsdf,mirror"); });
  expect_error(ErrorKind::usage, "--strategies", {"bsdf"}, [] { parse_strategies("bsdf,sphere"); });
  expect_error(ErrorKind::usage, "--strategies", {"bsdf"}, [] { parse_strategies("light"); });
}
