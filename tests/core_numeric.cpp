#include <cmath>
#include <limits>

#include "catch.hpp"
#include "core/angle.hpp"
#include "glm_formulas.hpp"
#include "raylab/core/numeric.hpp"

using namespace raylab;

TEST_CASE("next_float_up and next_float_down are the neighbours in the order of floats", "[unit][core]") {
  constexpr float kMax = std::numeric_limits<float>::max();
  constexpr float kTiny = std::numeric_limits<float>::denorm_min();
  for (const float x :
       {0.0f, -0.0f, kTiny, -kTiny, 1.0f, -1.0f, 0x1p-126f, -0x1p-126f, 3.5e20f, -3.5e20f, kMax, -kMax}) {
    INFO(x);
    CHECK(next_float_up(x) == std::nextafter(x, kInfinity));
    CHECK(next_float_down(x) == std::nextafter(x, -kInfinity));
  }
  CHECK(next_float_up(kInfinity) == kInfinity);
  CHECK(next_float_up(-kInfinity) == -kMax);
  CHECK(next_float_down(-kInfinity) == -kInfinity);
  CHECK(next_float_down(kInfinity) == kMax);
  CHECK(std::isnan(next_float_up(std::nanf(""))));
  CHECK(std::isnan(next_float_down(std::nanf(""))));
}

TEST_CASE("gamma_bound covers the error of a long float sum", "[unit][core]") {
  // Terms of one sign: the relative error of n - 1 additions is at most gamma(n - 1).
  std::uint64_t state = 5;
  for (const int n : {2, 3, 10, 100, 1000}) {
    float sum = 0.0f;
    double exact = 0.0;
    for (int i = 0; i < n; ++i) {
      const float term = 1.0f + bits_to_unit(static_cast<std::uint32_t>(mix_bits(++state)));
      sum += term;
      exact += term;
    }
    INFO(n << " terms");
    CHECK(std::abs(sum - exact) <= gamma_bound(n - 1) * exact);
    CHECK(gamma_bound(n) >= n * static_cast<double>(kUnitRoundoff));
  }
}

TEST_CASE("a frame is orthonormal and right-handed around any unit vector", "[unit][core]") {
  double worst = 0.0;
  const auto try_normal = [&](const vec3& n) {
    const test::GlmFrame f(n);
    const double errors[] = {glm::dot(f.x, f.y),        glm::dot(f.y, f.z),
                             glm::dot(f.z, f.x),        glm::dot(f.x, f.x) - 1.0f,
                             glm::dot(f.y, f.y) - 1.0f, glm::length(glm::cross(f.x, f.y) - f.z)};
    for (const double e : errors) worst = std::max(worst, std::isfinite(e) ? std::abs(e) : 1e9);
    CHECK(f.z == n);
    const vec3 v(0.3f, -0.7f, 0.2f);
    worst = std::max(worst, static_cast<double>(glm::length(f.to_world(f.to_local(v)) - v)));
  };
  for (int axis = 0; axis < 3; ++axis) {
    for (const float sign : {1.0f, -1.0f}) {
      vec3 n(0.0f);
      n[axis] = sign;
      try_normal(n);
    }
  }
  // z = -1 and close to it, where formulas divide by 1 + z; both signs of a zero z.
  try_normal({0.0f, 0.0f, -1.0f});
  try_normal({1.0f, 0.0f, -0.0f});
  for (int k = 1; k <= 20; ++k) {
    const float tilt = std::ldexp(1.0f, -k);
    for (int i = 0; i < 8; ++i) {
      const float phi = static_cast<float>(i) * kPi / 4.0f + 0.1f;
      try_normal(glm::normalize(vec3(tilt * std::cos(phi), tilt * std::sin(phi), -1.0f)));
      try_normal(glm::normalize(vec3(std::cos(phi), std::sin(phi), tilt)));
      try_normal(glm::normalize(vec3(std::cos(phi), std::sin(phi), -tilt)));
    }
  }
  CHECK(worst < 2e-6);
}

namespace {

/// Distance of a number from the exact one, in units in the last place of the exact one's float.
double error_ulp(float found, long double exact) {
  const auto rounded = std::abs(static_cast<float>(exact));
  return static_cast<double>(std::abs(found - exact) / (static_cast<long double>(next_float_up(rounded)) - rounded));
}

}  // namespace

TEST_CASE("the arc tangent of two numbers is that of the library to the last bits", "[unit][core]") {
  double worst = 0.0;
  const auto check = [&](float y, float x) {
    const float found = arc_tangent<float>(y, x);
    worst = std::max(worst, error_ulp(found, std::atan2(static_cast<long double>(y), static_cast<long double>(x))));
    if (std::signbit(found) != std::signbit(y)) worst = 1e9;
  };
  for (std::uint64_t i = 0; i < 1000000; ++i) {
    const std::uint64_t bits = mix_bits(i + 1);
    const float a = bits_to_unit(static_cast<std::uint32_t>(bits)) - 0.5f;
    const float b = bits_to_unit(static_cast<std::uint32_t>(bits >> 32)) - 0.5f;
    check(a, b);
    check(a, b * std::ldexp(1.0f, static_cast<int>(i % 40)));
    check(a, std::copysign(a * (1.0f + 1e-6f * b), b));  // by the diagonal
  }
  const float all[] = {0.0f, 1e-30f, 1e-7f, 0.41421354f, 0.4142136f, 1.0f, 3e7f, std::numeric_limits<float>::max()};
  for (const float y : all) {
    for (const float x : all) {
      if (y != 0.0f && y / x < std::numeric_limits<float>::min()) continue;  // a denormal or 0
      for (const float signed_y : {y, -y}) {
        for (const float signed_x : {x, -x}) check(signed_y, signed_x);
      }
    }
  }
  CHECK(worst < 2.0);
}

TEST_CASE("sine and cosine of degrees are the library's to the last place, and exact at quarter turns",
          "[unit][core]") {
  const auto check = [](double degrees) {
    const SineCosine own = sine_cosine_of_degrees(degrees);
    const long double radians = std::remainder(static_cast<long double>(degrees), 360.0L) * (std::acos(-1.0L) / 180.0L);
    INFO(degrees);
    CHECK(std::abs(static_cast<double>(own.sine - std::sin(radians))) < 3e-16);
    CHECK(std::abs(static_cast<double>(own.cosine - std::cos(radians))) < 3e-16);
  };
  for (double degrees = -1000.0; degrees <= 1000.0; degrees += 0.37) check(degrees);
  for (const double degrees : {45.0, -45.0, 135.0, 1e-30, 44.999999999999993, 1e9 + 0.5}) check(degrees);
  constexpr double kSines[] = {0.0, 1.0, 0.0, -1.0};
  for (int quarter = -8; quarter <= 8; ++quarter) {
    const SineCosine own = sine_cosine_of_degrees(90.0 * quarter);
    INFO(90 * quarter);
    CHECK(own.sine == kSines[(quarter + 8) % 4]);
    CHECK(own.cosine == kSines[(quarter + 9) % 4]);
  }
}
