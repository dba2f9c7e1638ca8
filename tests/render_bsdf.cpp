#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "catch.hpp"
#include "core_statistics.hpp"
#include "glm_formulas.hpp"
#include "test_scenes.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

constexpr double kPiD = 3.14159265358979323846;

vec2 random_point(std::uint64_t i, std::uint64_t stream = 0) {
  const std::uint64_t bits = mix_bits(i * 0x9e3779b97f4a7c15ull + mix_bits(stream + 31));
  return {bits_to_unit(static_cast<std::uint32_t>(bits)), bits_to_unit(static_cast<std::uint32_t>(bits >> 32))};
}

vec3 from_angle(double degrees) {
  const double theta = degrees * kPiD / 180.0;
  return {static_cast<float>(std::sin(theta) * 0.8), static_cast<float>(std::sin(theta) * 0.6),
          static_cast<float>(std::cos(theta))};
}

/// A grid over directions in which a density is smooth: by an angle alpha in [0, pi/2] from an axis and by
/// azimuth. Directions lie at asin(spread sin(alpha)) from the axis, so that the ring where a fuzzy mirror's
/// density is infinite is at the end of the grid, where it is met with measure zero.
struct Grid {
  Grid(const vec3& axis, double spread_) : frame(axis), spread(spread_) {}

  static constexpr int kRings = 16, kSectors = 24, kFine = 32;
  static constexpr int kCells = kRings * kSectors;

  /// The cell of a direction; -1 where it lies farther from the axis than the grid.
  int cell(const vec3& w) const {
    const vec3 local = frame.to_local(w);
    const double sine = std::hypot(local.x, local.y) / spread;
    if (local.z < 0.0f || sine > 1.0 + 2e-5) return -1;
    const double alpha = std::asin(std::min(1.0, sine));
    const double turn = std::atan2(local.y, local.x) / (2.0 * kPiD) + 0.5;
    return std::min(kRings - 1, static_cast<int>(alpha / (kPiD / 2.0) * kRings)) * kSectors +
           std::min(kSectors - 1, static_cast<int>(turn * kSectors));
  }

  /// Integral of a density over each cell.
  std::vector<double> integrate(const std::function<double(const vec3&)>& density) const {
    std::vector<double> result(kCells, 0.0);
    const double step_alpha = kPiD / 2.0 / (kRings * kFine);
    const double step_phi = 2.0 * kPiD / (kSectors * kFine);
    for (int i = 0; i < kRings * kFine; ++i) {
      const double alpha = (i + 0.5) * step_alpha;
      const double sine = spread * std::sin(alpha);
      const double cosine = std::sqrt(1.0 - sine * sine);
      // d omega = sine d theta d phi, cosine d theta = spread cos(alpha) d alpha
      const double area = sine * spread * std::cos(alpha) / cosine * step_alpha * step_phi;
      for (int k = 0; k < kSectors * kFine; ++k) {
        const double phi = (k + 0.5) * step_phi - kPiD;
        const vec3 w = frame.to_world(vec3(dvec3(sine * std::cos(phi), sine * std::sin(phi), cosine)));
        result[(i / kFine) * kSectors + k / kFine] += density(w) * area;
      }
    }
    return result;
  }

  GlmFrame frame;
  double spread;
};

/// Fraction of the light that a fuzzy mirror absorbs, because the sphere of radius fuzz around the mirror
/// direction reaches below the surface: a cap of it, of height fuzz - cos.
double absorbed(double cosine, double fuzz) { return std::max(0.0, (fuzz - cosine) / (2.0 * fuzz)); }

/// Samples of the material against its density, cell by cell, and both against the fraction absorbed.
void compare_with_density(const Material& m, const vec3& wo, const Grid& grid, double expected_absorbed) {
  constexpr int kCount = 200000;
  const Rgb color(0.3f, 0.5f, 0.9f);
  std::vector<double> expected = grid.integrate([&](const vec3& w) { return test::eval_bsdf(m, color, wo, w).pdf; });
  double integral = 0.0;
  for (double& p : expected) {
    integral += p;
    p *= kCount;
  }
  CHECK(integral == Approx(1.0 - expected_absorbed).epsilon(2e-3));
  expected.push_back(expected_absorbed * kCount);
  std::vector<double> counted(expected.size(), 0.0);
  int bad = 0, off_grid = 0, rim = 0;
  for (std::uint64_t i = 0; i < kCount; ++i) {
    const GlmBsdfSample s = test::sample_bsdf(m, color, wo, false, random_point(i), 0.0f);
    if (is_black(s.weight)) {
      ++counted.back();
      continue;
    }
    const GlmBsdfValue f = test::eval_bsdf(m, color, wo, s.wi);
    bad += s.delta || s.weight != color || !(s.wi.z > 0.0f) || std::abs(glm::length(s.wi) - 1.0f) > 1e-5f ||
           s.eta_squared != 1.0f;
    // Where the density goes to infinity a sample must not be lost, but what it evaluates to there may be.
    if (s.pdf == f.pdf) {
      bad += glm::length(f.value / f.pdf - s.weight) > 1e-5f;
    } else {
      ++rim;
      bad += m.kind != Material::Kind::metal || !(s.pdf > 2.0f * kInvPi);
    }
    const int cell = grid.cell(s.wi);
    if (cell < 0) {
      ++off_grid;
    } else {
      ++counted[cell];
    }
  }
  CHECK(bad == 0);
  CHECK(off_grid == 0);
  CHECK(rim < kCount / 1000);
  CHECK(std::abs(counted.back() - expected_absorbed * kCount) <
        kLimitZ * std::sqrt(expected_absorbed * (1.0 - expected_absorbed) * kCount) + 5.0);
  CHECK(chi_square_z(counted, expected) < kLimitZ);
}

/// Reflected fraction by Fresnel's equations in their form with angles, which the renderer does not use.
double fresnel_by_angles(double degrees, double eta) {
  const double i = degrees * kPiD / 180.0;
  const double sine = std::sin(i) / eta;
  if (sine >= 1.0) return 1.0;
  const double t = std::asin(sine);
  if (i == 0.0) return std::pow((eta - 1.0) / (eta + 1.0), 2.0);
  const double s = std::sin(i - t) / std::sin(i + t);
  const double p = std::tan(i - t) / std::tan(i + t);
  return 0.5 * (s * s + p * p);
}

}  // namespace

TEST_CASE("a lambertian surface's samples follow its density", "[statistical][bsdf]") {
  for (const double angle : {0.0, 60.0, 89.0}) {
    INFO(angle << " degrees");
    compare_with_density(lambertian(grey(1.0f)), from_angle(angle), Grid(vec3(0, 0, 1), 1.0), 0.0);
  }
}

TEST_CASE("a fuzzy metal's samples follow its density, whatever the fuzz and the incidence", "[statistical][bsdf]") {
  for (const float fuzz : {0.05f, 0.3f, 0.75f, 1.0f}) {
    for (const double angle : {0.0, 30.0, 60.0, 85.0}) {
      INFO("fuzz " << fuzz << ", " << angle << " degrees");
      const vec3 wo = from_angle(angle);
      compare_with_density(metal(grey(1.0f), fuzz), wo, Grid(mirror(wo), fuzz), absorbed(wo.z, fuzz));
    }
  }
}

TEST_CASE("a fuzzy metal loses nothing at the rim of its reflection, however small the fuzz", "[unit][bsdf]") {
  for (const float fuzz : {1e-8f, 1e-6f, 1e-4f, 1e-3f, 0.01f, 0.3f}) {
    INFO("fuzz " << fuzz);
    int lost = 0, bad = 0;
    for (std::uint64_t i = 0; i < 20000; ++i) {
      const GlmBsdfSample s =
          test::sample_bsdf(metal(grey(1.0f), fuzz), Rgb(0.5f), from_angle(60.0), false, random_point(i), 0.0f);
      lost += is_black(s.weight);
      bad += s.delta != (fuzz < 1.5e-5f);
      bad += !s.delta && !(s.pdf > 0.0f && s.pdf < kInfinity);
    }
    CHECK(lost == 0);
    CHECK(bad == 0);
  }
}

TEST_CASE("the density of another fuzz does not pass for that of the samples", "[statistical][bsdf]") {
  // What the comparison above is able to see.
  const vec3 wo = from_angle(30.0);
  const Grid grid(mirror(wo), 0.31);
  const Material m = metal(grey(1.0f), 0.31f);
  std::vector<double> expected =
      grid.integrate([&](const vec3& w) { return test::eval_bsdf(m, Rgb(1.0f), wo, w).pdf; });
  for (double& p : expected) p *= 200000.0;
  std::vector<double> counted(expected.size(), 0.0);
  for (std::uint64_t i = 0; i < 200000; ++i) {
    ++counted[grid.cell(test::sample_bsdf(metal(grey(1.0f), 0.3f), Rgb(1.0f), wo, false, random_point(i), 0.0f).wi)];
  }
  CHECK(chi_square_z(counted, expected) > 10.0 * kLimitZ);
}

TEST_CASE("a lambertian surface reflects the same in both directions", "[unit][bsdf]") {
  const Material m = lambertian(grey(1.0f));
  const Rgb color(0.2f, 0.4f, 0.8f);
  for (std::uint64_t i = 0; i < 200; ++i) {
    const vec3 a = cosine_hemisphere(random_point(i, 1));
    const vec3 b = cosine_hemisphere(random_point(i, 2));
    const Rgb f = test::eval_bsdf(m, color, a, b).value / b.z;
    const Rgb g = test::eval_bsdf(m, color, b, a).value / a.z;
    CHECK(glm::length(f - g) < 1e-6f);
    CHECK(glm::length(f - color * kInvPi) < 1e-6f);
  }
}

TEST_CASE("no surface reflects more light than it gets", "[statistical][bsdf]") {
  for (const Material& m : {lambertian(grey(1.0f)), metal(grey(1.0f), 0.0f), metal(grey(1.0f), 0.2f),
                            metal(grey(1.0f), 1.0f), glass(1.5f), glass(1.0f / 1.5f), glass(2.4f)}) {
    for (const double angle : {0.0, 20.0, 50.0, 80.0, 89.9}) {
      for (const bool inside : {false, true}) {
        double power = 0.0;
        const int count = 4000;
        for (std::uint64_t i = 0; i < count; ++i) {
          const GlmBsdfSample s =
              test::sample_bsdf(m, Rgb(1.0f), from_angle(angle), inside, random_point(i, 3), random_point(i, 4).x);
          // What refraction takes from radiance it gives back in solid angle.
          power += s.weight.g * s.eta_squared;
        }
        CHECK(power / count <= 1.0 + 1e-6);
        if (m.kind != Material::Kind::metal) CHECK(power / count == Approx(1.0).epsilon(1e-6));
      }
    }
  }
}

TEST_CASE("nothing is reflected below the surface, nor by materials without a density", "[unit][bsdf]") {
  const vec3 wo = from_angle(40.0);
  for (const Material& m : {lambertian(grey(1.0f)), metal(grey(1.0f), 0.7f)}) {
    CHECK(has_density(m));
    for (const vec3& wi : {vec3(0, 0, -1), vec3(1, 0, 0), glm::normalize(vec3(0.5f, 0.2f, -0.1f))}) {
      CHECK(is_black(test::eval_bsdf(m, Rgb(1.0f), wo, wi).value));
      CHECK(test::eval_bsdf(m, Rgb(1.0f), wo, wi).pdf == 0.0f);
    }
  }
  for (const Material& m : {metal(grey(1.0f), 0.0f), glass(), light(grey(1.0f))}) {
    CHECK_FALSE(has_density(m));
    CHECK(test::eval_bsdf(m, Rgb(1.0f), wo, mirror(wo)).pdf == 0.0f);
  }
  CHECK(is_black(test::sample_bsdf(light(grey(1.0f)), Rgb(1.0f), wo, false, vec2(0.5f), 0.5f).weight));
  const GlmBsdfSample mirrored = test::sample_bsdf(metal(grey(1.0f), 0.0f), Rgb(0.5f), wo, false, vec2(0.5f), 0.5f);
  CHECK(mirrored.delta);
  CHECK(mirrored.wi == mirror(wo));
  CHECK(mirrored.weight == Rgb(0.5f));
}

TEST_CASE("the ends of the random numbers give finite directions for every material", "[unit][bsdf]") {
  // The largest number is just below one; a 1.0 would give directions of length zero, or none.
  constexpr float kEnds[] = {0.0f, 0x1p-24f, 0.5f, kOneMinusEpsilon};
  int bad = 0;
  for (const Material& m : {lambertian(grey(1.0f)), metal(grey(1.0f), 0.0f), metal(grey(1.0f), 1e-4f),
                            metal(grey(1.0f), 0.5f), metal(grey(1.0f), 1.0f), glass(), glass(1.0f)}) {
    for (const double angle : {0.0, 45.0, 90.0 - 1e-4}) {
      for (const float u : kEnds) {
        for (const float v : kEnds) {
          for (const float lobe : kEnds) {
            for (const bool inside : {false, true}) {
              const GlmBsdfSample s = test::sample_bsdf(m, Rgb(1.0f), from_angle(angle), inside, {u, v}, lobe);
              bad += !is_finite(s.wi) || !is_finite(s.weight) || !(s.pdf >= 0.0f) || !std::isfinite(s.pdf);
              if (!is_black(s.weight)) bad += std::abs(glm::length(s.wi) - 1.0f) > 1e-5f;
            }
          }
        }
      }
    }
  }
  CHECK(bad == 0);
}

TEST_CASE("glass reflects the fraction of Fresnel's equations from both sides", "[unit][bsdf]") {
  struct Known {
    double degrees, reflected;
  };
  // Computed apart from this program, with sines and tangents of angles; Schlick's approximation with the inside
  // cosine gives 0.041 in place of 0.245 at 40 degrees from inside.
  const Known from_inside[] = {{35.0, 0.0861379914688122},  {38.0, 0.14218118093166612}, {40.0, 0.24529120428690981},
                               {41.0, 0.37975126596244024}, {41.5, 0.5416199915153559},  {41.8, 0.8907719214997081}};
  const Known from_outside[] = {{0.0, 0.04},
                                {30.0, 0.04152262597582155},
                                {45.0, 0.050239911012235954},
                                {60.0, 0.08918671280221276},
                                {80.0, 0.3877043546914725},
                                {89.0, 0.9041849497801888}};
  float cos_t;
  for (const Known& k : from_inside) {
    INFO(k.degrees << " degrees from inside");
    CHECK(fresnel_by_angles(k.degrees, 1.0 / 1.5) == Approx(k.reflected).epsilon(1e-9));
    const auto cosine = static_cast<float>(std::cos(k.degrees * kPiD / 180.0));
    CHECK(fresnel_dielectric(cosine, 1.0f / 1.5f, cos_t) ==
          Approx(k.reflected).epsilon(k.degrees > 41.7 ? 5e-4 : 5e-5));
  }
  for (const Known& k : from_outside) {
    INFO(k.degrees << " degrees from outside");
    CHECK(fresnel_by_angles(k.degrees, 1.5) == Approx(k.reflected).epsilon(1e-9));
    CHECK(fresnel_dielectric(static_cast<float>(std::cos(k.degrees * kPiD / 180.0)), 1.5f, cos_t) ==
          Approx(k.reflected).epsilon(2e-6));
  }
  // The same boundary crossed at the same place reflects the same fraction from either side.
  for (double degrees = 1.0; degrees < 90.0; degrees += 1.0) {
    const auto cosine = static_cast<float>(std::cos(degrees * kPiD / 180.0));
    const float there = fresnel_dielectric(cosine, 1.5f, cos_t);
    float cos_back;
    CHECK(fresnel_dielectric(cos_t, 1.0f / 1.5f, cos_back) == Approx(there).epsilon(1e-3));
    CHECK(cos_back == Approx(cosine).margin(1e-5));
  }
}

TEST_CASE("beyond the critical angle, and only there, all light is reflected", "[unit][bsdf]") {
  const double critical = std::asin(1.0 / 1.5) * 180.0 / kPiD;
  float cos_t;
  for (const double degrees : {critical + 0.01, 45.0, 60.0, 89.9}) {
    const auto cosine = static_cast<float>(std::cos(degrees * kPiD / 180.0));
    CHECK(fresnel_dielectric(cosine, 1.0f / 1.5f, cos_t) == 1.0f);
    CHECK(cos_t == 0.0f);
    CHECK(fresnel_dielectric(cosine, 1.5f, cos_t) < 1.0f);
    const GlmBsdfSample s =
        test::sample_bsdf(glass(), Rgb(1.0f), from_angle(degrees), true, vec2(0.5f), kOneMinusEpsilon);
    CHECK(s.wi == mirror(from_angle(degrees)));
    CHECK(s.weight == Rgb(1.0f));
    CHECK(s.eta_squared == 1.0f);
  }
  CHECK(fresnel_dielectric(static_cast<float>(std::cos((critical - 0.01) * kPiD / 180.0)), 1.0f / 1.5f, cos_t) < 1.0f);
  // Without a step in the index there is no boundary.
  CHECK(fresnel_dielectric(0.3f, 1.0f, cos_t) == Approx(0.0f).margin(1e-7));
  CHECK(cos_t == Approx(0.3f));
}

TEST_CASE("light that goes into glass and out again is neither bent nor dimmed", "[unit][bsdf]") {
  for (const float index : {1.33f, 1.5f, 2.4f, 0.8f}) {
    for (const double degrees : {0.0, 10.0, 30.0, 50.0}) {
      const vec3 wo = from_angle(degrees);
      const GlmBsdfSample in = test::sample_bsdf(glass(index), Rgb(1.0f), wo, false, vec2(0.5f), kOneMinusEpsilon);
      REQUIRE(in.wi.z < 0.0f);
      CHECK(std::hypot(in.wi.x, in.wi.y) * index == Approx(std::hypot(wo.x, wo.y)).margin(1e-6));
      // On the far, parallel side: the frame's z axis points against the direction of travel again.
      const GlmBsdfSample out = test::sample_bsdf(glass(index), Rgb(1.0f), -in.wi, true, vec2(0.5f), kOneMinusEpsilon);
      REQUIRE(out.wi.z < 0.0f);
      CHECK(in.eta_squared * out.eta_squared == Approx(1.0f).epsilon(1e-6));
      CHECK((in.weight * out.weight).g == Approx(1.0f).epsilon(1e-6));
      CHECK(in.weight.g * in.eta_squared == Approx(1.0f).epsilon(1e-6));
      CHECK(in.eta_squared == Approx(index * index).epsilon(1e-6));
      CHECK(glm::length(out.wi - (-wo)) < 1e-5f);
    }
  }
}
