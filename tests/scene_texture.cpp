#include <cmath>

#include "catch.hpp"
#include "raylab/accel/accelerator.hpp"
#include "raylab/scene/surface_point.hpp"
#include "raylab/scene/texture.hpp"
#include "test_scenes.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

/// Two columns and two rows: 1 2 above 3 4.
TextureImage four_texels() {
  TextureImage image;
  image.width = image.height = 2;
  image.texels = {Rgb(1.0f), Rgb(2.0f), Rgb(3.0f), Rgb(4.0f)};
  return image;
}

float value(const TextureImage& image, float u, float v) { return sample_image(image, {u, v}).g; }

}  // namespace

TEST_CASE("a picture is right at its texels' centres, its first row at the top", "[unit][texture]") {
  const TextureImage image = four_texels();
  CHECK(value(image, 0.25f, 0.75f) == 1.0f);
  CHECK(value(image, 0.75f, 0.75f) == 2.0f);
  CHECK(value(image, 0.25f, 0.25f) == 3.0f);
  CHECK(value(image, 0.75f, 0.25f) == 4.0f);
}

TEST_CASE("between texels a picture is bilinear", "[unit][texture]") {
  const TextureImage image = four_texels();
  CHECK(value(image, 0.5f, 0.75f) == Approx(1.5f));
  CHECK(value(image, 0.25f, 0.5f) == Approx(2.0f));
  CHECK(value(image, 0.5f, 0.5f) == Approx(2.5f));
  CHECK(value(image, 0.375f, 0.75f) == Approx(1.25f));
  CHECK(value(image, 0.375f, 0.625f) == Approx(0.75 * 1.25 + 0.25 * 3.25));
}

TEST_CASE("a picture repeats, its edges blended with those opposite, to both sides", "[unit][texture]") {
  const TextureImage image = four_texels();
  // Across the edge between the last and the first column.
  CHECK(value(image, 0.0f, 0.75f) == Approx(1.5f));
  CHECK(value(image, 1.0f, 0.75f) == Approx(1.5f));
  CHECK(value(image, 0.25f, 0.0f) == Approx(2.0f));
  for (const float u : {0.1f, 0.25f, 0.6f, 0.9f}) {
    for (const float v : {0.05f, 0.5f, 0.75f}) {
      for (const int turns : {-1000, -3, -1, 1, 2, 500}) {
        const auto t = static_cast<float>(turns);
        CHECK(value(image, u + t, v) == Approx(value(image, u, v)).epsilon(1e-3));
        CHECK(value(image, u, v + t) == Approx(value(image, u, v)).epsilon(1e-3));
      }
    }
  }
  CHECK(value(image, -0.25f, 0.75f) == 2.0f);
  CHECK(value(image, 0.25f, -0.25f) == 1.0f);
}

TEST_CASE("any texture coordinates, even infinite ones, read some texel", "[unit][texture]") {
  const TextureImage image = four_texels();
  TextureImage one;
  one.width = one.height = 1;
  one.texels = {Rgb(7.0f)};
  for (const float x : {0.0f, -0.0f, 1e-30f, -1e-30f, 0.99999994f, 1.0f, -1.0f, 1e9f, -1e30f, 3e38f, kInfinity,
                        -kInfinity, std::nanf("")}) {
    for (const float y : {0.0f, -1e-30f, 0.5f, 1.0f, kInfinity, std::nanf("")}) {
      for (const float sample : {value(image, x, y), value(image, y, x)}) CHECK((sample >= 1.0f && sample <= 4.0f));
      CHECK(value(one, x, y) == 7.0f);
    }
  }
}

TEST_CASE("a checker changes colour at each multiple of its size, below zero too", "[unit][texture]") {
  const Texture t = checker(0.5f, Rgb(1.0f), Rgb(0.0f));
  const auto at = [&](float x, float y, float z) { return texture_color(t, {}, {x, y, z}, vec2(0.0f)).g; };
  CHECK(at(0.1f, 0.1f, 0.1f) == 1.0f);
  CHECK(at(0.6f, 0.1f, 0.1f) == 0.0f);
  CHECK(at(0.6f, 0.6f, 0.1f) == 1.0f);
  CHECK(at(0.6f, 0.6f, 0.6f) == 0.0f);
  CHECK(at(-0.1f, 0.1f, 0.1f) == 0.0f);
  CHECK(at(-0.1f, -0.1f, 0.1f) == 1.0f);
  CHECK(at(-0.6f, 0.1f, 0.1f) == 1.0f);
  CHECK(at(-0.6f, -0.6f, -0.6f) == 1.0f);
  CHECK(at(-0.1f, -0.1f, -0.1f) == 0.0f);
  // No cell is wider than another at zero, where cutting towards zero would join two.
  int changes = 0;
  for (int i = -40; i < 40; ++i) {
    changes += at(static_cast<float>(i) * 0.05f + 0.025f, 0.1f, 0.1f) !=
               at(static_cast<float>(i + 1) * 0.05f + 0.025f, 0.1f, 0.1f);
  }
  CHECK(changes == 8);
  CHECK(at(1e30f, -3e20f, 0.1f) >= 0.0f);
}

TEST_CASE("the mean luminance of a texture is that of its colours", "[unit][texture]") {
  Scene scene;
  const Texture image = picture(scene, 2, 1, [](int x, int) { return x == 0 ? Rgb(1, 0, 0) : Rgb(0, 3, 0); });
  CHECK(mean_luminance(color(1, 0, 0), {}) == Approx(0.2126));
  CHECK(mean_luminance(checker(1.0f, Rgb(1.0f), Rgb(0.0f)), {}) == Approx(0.5));
  CHECK(mean_luminance(image, scene.textures) == Approx(0.5 * (0.2126 + 3.0 * 0.7152)));
}

TEST_CASE("at its poles a sphere shows the rows that lie there, not those of the other pole", "[stability][texture]") {
  Scene scene;
  const Texture halves = picture(scene, 8, 4, [](int, int y) { return Rgb(y < 2 ? 1.0f : 0.0f); });
  add_sphere(scene, vec3(0.0f), 1.0f, lambertian(halves));
  set_sky(scene, Rgb(1.0f));
  const auto accelerator = make_accelerator("list", scene.geometry);
  for (const float pole : {1.0f, -1.0f}) {
    for (int k = 0; k < 64; ++k) {
      const float x = 1e-4f * static_cast<float>(k % 8 - 4), z = 1e-4f * static_cast<float>(k / 8 - 4);
      const Ray ray{{x, 3.0f * pole, z}, {0, -pole, 0}};
      const auto hit = accelerator->intersect(ray);
      REQUIRE(hit);
      const SurfacePoint point = surface_point(scene.geometry, ray, *hit);
      const Rgb color = texture_color(halves, scene.textures, point.position, point.uv, address_mode_of_v(true));
      CHECK(color.r == (pole > 0.0f ? 1.0f : 0.0f));
    }
  }
}

TEST_CASE("a plane on the boundary of checker cells has one colour a cell", "[stability][texture]") {
  // Its points lie exactly on the boundary, as its corners do; beside it they would be speckled.
  for (const float height : {0.0f, 0.3f, 1.0f, 7.1f, 1000.0f}) {
    Scene scene;
    add_quad(scene, {-1, height, -1}, {0, 0, 2}, {2, 0, 0}, lambertian(grey(0.5f)));
    const Texture cubes = checker(0.1f, Rgb(1.0f), Rgb(0.0f));
    const auto accelerator = make_accelerator("bvh", scene.geometry);
    int different = 0;
    for (int k = 0; k < 1000; ++k) {
      const float x = 0.013f + 0.1f * static_cast<float>(k % 3) * 2.0f, z = 0.011f + 0.00007f * static_cast<float>(k);
      const Ray ray{{x + 0.5f, height + 2.0f, z - 0.3f}, vec3(x, height, z) - vec3(x + 0.5f, height + 2.0f, z - 0.3f)};
      const auto hit = accelerator->intersect(ray);
      REQUIRE(hit);
      const vec3 p = surface_point(scene.geometry, ray, *hit).position;
      different +=
          texture_color(cubes, {}, p, vec2(0.0f)) != texture_color(cubes, {}, vec3(p.x, height, p.z), vec2(0.0f));
    }
    INFO("height " << height);
    CHECK(different == 0);
  }
}
