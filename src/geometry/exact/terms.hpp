#pragma once
// What decides whether and where a ray meets a primitive, by formulas that hold for balls and for integers alike.
#include <algorithm>
#include <initializer_list>
#include <limits>

#include "ball.hpp"
#include "raylab/core/ray.hpp"
#include "raylab/geometry/geometry.hpp"
#include "surd.hpp"

namespace raylab::exact {

template <class Number>
struct Vec {
  Number x, y, z;

  Vec operator-(const Vec& b) const { return {x - b.x, y - b.y, z - b.z}; }
};

template <class Number>
Number dot(const Vec<Number>& a, const Vec<Number>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class Number>
Vec<Number> cross(const Vec<Number>& a, const Vec<Number>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <class Number>
struct TriangleTerms {
  Vec<Number> direction, a, b, c;  ///< corners relative to the origin
  Vec<Number> ab, ac;

  /// Six times the volumes that the direction spans with the sides opposite a, b and c: of one sign where the line
  /// meets the triangle. Their sum is facing().
  Number u() const { return dot(direction, cross(b, c)); }
  Number v() const { return dot(direction, cross(c, a)); }
  Number w() const { return dot(direction, cross(a, b)); }

  Number facing() const { return dot(direction, cross(ab, ac)); }
  Number height() const { return dot(a, cross(ab, ac)); }  ///< t = height / facing
};

/// t = (towards ± √discriminant) / length_squared.
template <class Number>
struct SphereTerms {
  Number length_squared, towards, discriminant;
  Number power;  ///< of the origin: what the two t multiply to, times length_squared

  SphereTerms(const Vec<Number>& direction, const Vec<Number>& to_center, const Number& radius)
      : length_squared(dot(direction, direction)), towards(dot(direction, to_center)) {
    // From the distance of the centre from the line, and not as b² - a c, which cancels in double.
    const Vec<Number> moment = cross(to_center, direction);
    const Number radius_squared = radius * radius;
    discriminant = radius_squared * length_squared - dot(moment, moment);
    power = dot(to_center, to_center) - radius_squared;
  }
};

inline Vec<Ball> balls(const vec3& v) {
  return {{static_cast<double>(v.x)}, {static_cast<double>(v.y)}, {static_cast<double>(v.z)}};
}

inline TriangleTerms<Ball> in_balls(const Ray& ray, const Triangle& t) {
  const Vec<Ball> o = balls(ray.origin), p0 = balls(t.p0), p1 = balls(t.p1), p2 = balls(t.p2);
  return {balls(ray.direction), p0 - o, p1 - o, p2 - o, p1 - p0, p2 - p0};
}

inline SphereTerms<Ball> in_balls(const Ray& ray, const Sphere& s) {
  return {balls(ray.direction), balls(s.center) - balls(ray.origin), {static_cast<double>(s.radius)}};
}

/// The unit in which all of the floats are integers, as a power of two.
inline int common_unit(std::initializer_list<vec3> vectors, float number = 0.0f) {
  int unit = std::numeric_limits<int>::max();
  const auto include = [&](float x) {
    if (x != 0.0f) unit = std::min(unit, last_place(x));
  };
  for (const vec3& v : vectors) {
    include(v.x);
    include(v.y);
    include(v.z);
  }
  include(number);
  return unit == std::numeric_limits<int>::max() ? 0 : unit;
}

inline Vec<Integer> integers(const vec3& v, int unit) {
  return {scaled(v.x, unit), scaled(v.y, unit), scaled(v.z, unit)};
}

/// Terms in integers. t of them times 2^exponent is the t of the ray.
template <class Terms>
struct InIntegers {
  Terms terms;
  int exponent;
};

inline InIntegers<TriangleTerms<Integer>> in_integers(const Ray& ray, const Triangle& t) {
  const int unit = common_unit({ray.origin, t.p0, t.p1, t.p2});
  const int unit_of_direction = common_unit({ray.direction});
  const Vec<Integer> o = integers(ray.origin, unit), p0 = integers(t.p0, unit), p1 = integers(t.p1, unit),
                     p2 = integers(t.p2, unit);
  return {{integers(ray.direction, unit_of_direction), p0 - o, p1 - o, p2 - o, p1 - p0, p2 - p0},
          unit - unit_of_direction};
}

inline InIntegers<SphereTerms<Integer>> in_integers(const Ray& ray, const Sphere& s) {
  const int unit = common_unit({ray.origin, s.center}, s.radius);
  const int unit_of_direction = common_unit({ray.direction});
  return {{integers(ray.direction, unit_of_direction), integers(s.center, unit) - integers(ray.origin, unit),
           scaled(s.radius, unit)},
          unit - unit_of_direction};
}

inline Ball root_of(const SphereTerms<Ball>& s, int root) {
  if (root == 0) return s.towards / s.length_squared;
  const Ball rest = sqrt(s.discriminant);
  if ((s.towards.mid >= 0.0) == (root > 0)) {
    return (root > 0 ? s.towards + rest : s.towards - rest) / s.length_squared;
  }
  return s.power / (root > 0 ? s.towards - rest : s.towards + rest);
}

}  // namespace raylab::exact
