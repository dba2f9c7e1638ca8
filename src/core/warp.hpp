#pragma once
// Maps from the unit square to disks and spheres that keep area. Over the number type F.
#include "core/simd/lanes.hpp"
#include "raylab/core/numeric.hpp"

namespace raylab {
namespace {

/// Sine and cosine of an angle in [-pi/4, pi/4], to about one unit in the last place (polynomials of the Cephes
/// library, Moshier 1992). The libraries' own differ from one machine to the next; pictures must not.
template <class F>
void sine_cosine_small(const F& angle, F& sine, F& cosine) {
  const F z = angle * angle;
  sine = angle + angle * (z * (F(-1.6666654611e-1f) + z * (F(8.3321608736e-3f) + z * F(-1.9515295891e-4f))));
  cosine = F(1.0f) - F(0.5f) * z +
           z * z * (F(4.166664568298827e-2f) + z * (F(-1.388731625493765e-3f) + z * F(2.443315711809948e-5f)));
}

/// Sine and cosine of `turn` full turns, turn in [0, 1].
template <class F>
void sine_cosine_of_turn(const F& turn, F& sine, F& cosine) {
  const F quarters = F(4.0f) * turn;
  const F quadrant = floor(quarters + F(0.5f));  // 0 to 4
  F s, c;
  sine_cosine_small<F>((quarters - quadrant) * F(0.5f * kPi), s, c);
  const auto one = quadrant == F(1.0f);
  const auto two = quadrant == F(2.0f);
  const auto three = quadrant == F(3.0f);
  sine = select(one | three, c, s);
  cosine = select(one | three, s, c);
  sine = select(two | three, -sine, sine);
  cosine = select(one | two, -cosine, cosine);
}

/// Angle of the point (x, y) in [-pi, pi], x and y at most 2^126, to two units in the last place (polynomial of
/// the Cephes library); the signs of zeros count as in std::atan2.
template <class F>
F arc_tangent(const F& y, const F& x) {
  const F across = abs(y), along = abs(x);
  const F least = min(across, along), most = max(across, along);
  const auto far = least > F(0.41421356f) * most;  // tan(pi/8): from there on by the angle to the diagonal
  const F t = select(most > F(0.0f), select(far, least - most, least) / select(far, least + most, most), F(0.0f));
  const F z = t * t;
  const F small = t + t * (z * (F(-3.33329491539e-1f) +
                                z * (F(1.99777106478e-1f) + z * (F(-1.38776856032e-1f) + z * F(8.05374449538e-2f)))));
  // What the floats of pi/4, pi/2 and pi lack is a third of a unit in the last place.
  constexpr float kPiRest = -8.74227766e-8f;
  F angle = select(far, F(0.25f * kPi) + (small + F(0.25f * kPiRest)), small);
  angle = select(across > along, F(0.5f * kPi) - (angle - F(0.5f * kPiRest)), angle);
  angle = select(copysign(F(1.0f), x) < F(0.0f), F(kPi) - (angle - F(kPiRest)), angle);
  return copysign(angle, y);
}

/// Uniform density on the unit disk, low in distortion (Shirley and Chiu 1997).
template <class F>
void concentric_disk(const F& u, const F& v, F& x, F& y) {
  const F a = F(2.0f) * u - F(1.0f);
  const F b = F(2.0f) * v - F(1.0f);
  const auto flat = abs(a) > abs(b);
  const F radius = select(flat, a, b);
  const F ratio = select(radius == F(0.0f), F(0.0f), select(flat, b, a) / radius);
  F sine, cosine;
  sine_cosine_small<F>(F(kPi / 4.0f) * ratio, sine, cosine);
  x = radius * select(flat, cosine, sine);
  y = radius * select(flat, sine, cosine);
}

inline vec2 concentric_disk(const vec2& u) {
  vec2 p;
  concentric_disk<float>(u.x, u.y, p.x, p.y);
  return p;
}

/// Cosine-weighted direction of the upper hemisphere (Malley's method).
template <class F>
Vec3<F> cosine_hemisphere(const F& u, const F& v) {
  F x, y;
  concentric_disk<F>(u, v, x, y);
  return {x, y, sqrt(max(F(0.0f), F(1.0f) - x * x - y * y))};
}

inline vec3 cosine_hemisphere(const vec2& u) { return cosine_hemisphere<float>(u.x, u.y); }

/// Uniform direction of the sphere.
template <class F>
Vec3<F> uniform_sphere(const F& u, const F& v) {
  const F z = F(1.0f) - F(2.0f) * u;
  const F r = sqrt(max(F(0.0f), F(1.0f) - z * z));
  F sine, cosine;
  sine_cosine_of_turn<F>(v, sine, cosine);
  return {r * cosine, r * sine, z};
}
inline vec3 uniform_sphere(const vec2& u) { return uniform_sphere<float>(u.x, u.y); }

}  // namespace
}  // namespace raylab
