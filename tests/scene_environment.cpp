#include <cmath>
#include <vector>

#include "catch.hpp"
#include "core_statistics.hpp"
#include "glm_formulas.hpp"
#include "raylab/scene/environment.hpp"
#include "test_scenes.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

vec2 random_point(std::uint64_t i) {
  const std::uint64_t bits = mix_bits(i * 0x9e3779b97f4a7c15ull + 77);
  return {bits_to_unit(static_cast<std::uint32_t>(bits)), bits_to_unit(static_cast<std::uint32_t>(bits >> 32))};
}

/// Direction of polar angle and azimuth in double, the polar axis +y.
dvec3 direction(double theta, double phi) {
  return {std::sin(theta) * std::sin(phi), std::cos(theta), -std::sin(theta) * std::cos(phi)};
}

struct Sky {
  const char* name;
  Environment environment;
};

/// Skies whose sampling differs: uniform, smooth, a small sun, black parts, a sun at the pole, and one black row.
std::vector<Sky> skies() {
  std::vector<Sky> all;
  const auto add = [&](const char* name, const auto&... arguments) {
    Scene scene;
    set_sky(scene, arguments...);
    all.push_back({name, scene.environment});
  };
  add("constant", Rgb(0.3f));
  add("gradient", Rgb(1.0f, 0.5f, 0.0f), Rgb(0.1f, 0.2f, 2.0f));
  add("smooth", 16, 8, [](int x, int y) { return Rgb(1.0f + 0.5f * std::sin(0.4f * x), 0.1f * y, 0.5f); });
  add("sun", 32, 16, [](int x, int y) { return x == 20 && y == 4 ? Rgb(500.0f) : Rgb(0.2f, 0.3f, 0.5f); });
  add("half black", 12, 6, [](int x, int y) { return x < 6 || y == 2 ? Rgb(0.0f) : Rgb(1.0f + x, 1.0f, 1.0f); });
  add("sun at the pole", 24, 12, [](int, int y) { return y == 0 ? Rgb(300.0f) : Rgb(0.1f); });
  add("one texel", 1, 1, [](int, int) { return Rgb(2.0f); });
  return all;
}

}  // namespace

TEST_CASE("directions and picture positions are each other's inverse", "[unit][environment]") {
  double worst = 0.0;
  for (std::uint64_t i = 0; i < 20000; ++i) {
    const vec3 d = uniform_sphere(random_point(i));
    const vec2 uv = direction_to_latlong(d);
    REQUIRE((uv.x >= 0.0f && uv.x <= 1.0f && uv.y >= 0.0f && uv.y <= 1.0f));
    worst = std::max(worst, static_cast<double>(glm::length(latlong_to_direction(uv) - d)));
  }
  CHECK(worst < 2e-6);
  // Close to the poles as well, where the angle from the axis is the square root of what the cosine can show.
  for (const double theta : {1e-2, 1e-3, 1e-4, 1e-5}) {
    for (const double from_pole : {theta, static_cast<double>(kPi) - theta}) {
      const vec2 uv = direction_to_latlong(vec3(direction(from_pole, 0.7)));
      INFO(from_pole);
      CHECK(std::min(uv.y, 1.0f - uv.y) * static_cast<double>(kPi) == Approx(theta).epsilon(0.01).margin(2e-7));
    }
  }
}

TEST_CASE("the picture's middle looks along -z, its right half towards +x, its top up", "[unit][environment]") {
  CHECK(glm::length(latlong_to_direction({0.5f, 0.5f}) - vec3(0, 0, -1)) < 1e-6f);
  CHECK(glm::length(latlong_to_direction({0.75f, 0.5f}) - vec3(1, 0, 0)) < 1e-6f);
  CHECK(glm::length(latlong_to_direction({0.25f, 0.5f}) - vec3(-1, 0, 0)) < 1e-6f);
  CHECK(glm::length(latlong_to_direction({0.5f, 0.0f}) - vec3(0, 1, 0)) < 1e-6f);
  Scene scene;
  set_sky(scene, 4, 2, [](int x, int y) { return Rgb(static_cast<float>(x), static_cast<float>(y), 0.0f); });
  CHECK(scene.environment.radiance(glm::normalize(vec3(0.1f, 0.5f, -1.0f))) == Rgb(2, 0, 0));
  CHECK(scene.environment.radiance(glm::normalize(vec3(-0.1f, -0.5f, -1.0f))) == Rgb(1, 1, 0));
  CHECK(scene.environment.radiance(glm::normalize(vec3(0.1f, 0.5f, 1.0f))) == Rgb(3, 0, 0));
  CHECK(scene.environment.radiance(glm::normalize(vec3(-0.1f, -0.5f, 1.0f))) == Rgb(0, 1, 0));
}

TEST_CASE("a constant sky is one colour and a gradient follows the height", "[unit][environment]") {
  Scene scene;
  set_sky(scene, Rgb(0.1f, 0.2f, 0.3f));
  CHECK(scene.environment.radiance({0, 1, 0}) == Rgb(0.1f, 0.2f, 0.3f));
  CHECK(scene.environment.radiance({0, 0, -1}) == Rgb(0.1f, 0.2f, 0.3f));
  set_sky(scene, Rgb(1.0f), Rgb(0.5f, 0.7f, 1.0f));
  CHECK(scene.environment.radiance({0, -1, 0}) == Rgb(1.0f));
  CHECK(scene.environment.radiance({0, 1, 0}) == Rgb(0.5f, 0.7f, 1.0f));
  CHECK(scene.environment.radiance({1, 0, 0}).r == Approx(0.75f));
  for (const Sky& sky : skies()) CHECK_FALSE(sky.environment.is_black());
  CHECK(Environment().is_black());
  set_sky(scene, 2, 1, [](int, int) { return Rgb(0.0f); });
  CHECK(scene.environment.is_black());
}

TEST_CASE("the mean luminance of a sky is its integral over the sphere", "[unit][environment]") {
  for (const Sky& sky : skies()) {
    // Texel borders fall between the points, so this is the integral but for the variation inside a step.
    const int rows = 480, columns = 960;
    double sum = 0.0, weights = 0.0;
    for (int i = 0; i < rows; ++i) {
      const double theta = (i + 0.5) * static_cast<double>(kPi) / rows;
      for (int k = 0; k < columns; ++k) {
        const double phi = (k + 0.5) * 2.0 * static_cast<double>(kPi) / columns - static_cast<double>(kPi);
        sum += std::sin(theta) * luminance(sky.environment.radiance(vec3(direction(theta, phi))));
        weights += std::sin(theta);
      }
    }
    INFO(sky.name);
    // The sampler's rows count with the sine of their middle, which for few rows is a little off: it is a weight
    // for choosing among lights, not a part of the picture.
    CHECK(sky.environment.mean_luminance() ==
          Approx(sum / weights).epsilon(sky.environment.picture.height > 1 ? 0.04 : 1e-3));
  }
}

TEST_CASE("the density of sky directions integrates to one and is that of the samples", "[statistical][environment]") {
  constexpr int kRows = 24, kColumns = 48, kFine = 12, kCount = 150000;
  for (const Sky& sky : skies()) {
    const EnvironmentSampler sampler(sky.environment);
    std::vector<double> expected(kRows * kColumns, 0.0), counted(kRows * kColumns, 0.0);
    double integral = 0.0;
    for (int i = 0; i < kRows * kFine; ++i) {
      const double step = static_cast<double>(kPi) / (kRows * kFine);
      const double theta = (i + 0.5) * step;
      for (int k = 0; k < kColumns * kFine; ++k) {
        const double phi = (k + 0.5) * step - static_cast<double>(kPi);
        const double p = sampler.pdf(vec3(direction(theta, phi))) * std::sin(theta) * step * step;
        expected[(i / kFine) * kColumns + k / kFine] += p * kCount;
        integral += p;
      }
    }
    int bad = 0, moved = 0;
    for (std::uint64_t i = 0; i < kCount; ++i) {
      const auto s = sampler.sample(random_point(i));
      bad += s.pdf != sampler.pdf(s.direction) || std::abs(glm::length(s.direction) - 1.0f) > 1e-5f;
      moved += !(s.pdf > 0.0f) || is_black(sky.environment.radiance(s.direction));
      const double theta = std::atan2(std::hypot(s.direction.x, s.direction.z), s.direction.y);
      const double turn = std::atan2(s.direction.x, -s.direction.z) / (2.0 * static_cast<double>(kPi)) + 0.5;
      const int row = std::min(kRows - 1, static_cast<int>(theta / static_cast<double>(kPi) * kRows));
      ++counted[row * kColumns + std::min(kColumns - 1, static_cast<int>(turn * kColumns))];
    }
    INFO(sky.name);
    CHECK(integral == Approx(1.0).epsilon(1e-3));
    CHECK(bad == 0);
    CHECK(moved <= kCount / 10000);  // by rounding, out of the texel that was chosen
    CHECK(chi_square_z(counted, expected) < kLimitZ);
  }
}

TEST_CASE("sampling a sky by its brightness gives its irradiance with little noise", "[statistical][environment]") {
  for (const Sky& sky : skies()) {
    if (sky.environment.kind != Environment::Kind::image) continue;
    const EnvironmentSampler sampler(sky.environment);
    const int count = 20000;
    double sum = 0.0, squares = 0.0;
    for (int i = 0; i < count; ++i) {
      const auto s = sampler.sample(random_point(static_cast<std::uint64_t>(i) + 1000000));
      if (!(s.pdf > 0.0f)) continue;
      const double x = luminance(sky.environment.radiance(s.direction)) / s.pdf;
      sum += x;
      squares += x * x;
    }
    const double mean = sum / count;
    INFO(sky.name);
    const double spread = std::sqrt(std::max(0.0, squares / count - mean * mean));
    CHECK(spread < 0.6 * mean);
    // The mean luminance weighs rows by their middle; see above.
    CHECK(mean / (4.0 * static_cast<double>(kPi)) ==
          Approx(sky.environment.mean_luminance()).epsilon(sky.environment.picture.height > 1 ? 0.04 : 0.03));
  }
}
