#pragma once
// Ray against one primitive. All tests accept the open interval t_min < t < t_max only; that of the ray itself does not
// count.
#include <optional>
#include <utility>

#include "raylab/core/ray.hpp"
#include "raylab/geometry/geometry.hpp"

namespace raylab {

/// Distance in units of the ray's direction, and the weights of p1 and p2.
struct TriangleHit {
  float t, u, v;
};

/// The triangle tests a hand-written accelerator can use (`--intersector`).
enum class Intersector {
  book,        ///< Möller–Trumbore with the absolute |det| < 1e-8 rejected: the baseline, faults kept
  fast,        ///< Möller–Trumbore, only det = 0 rejected
  watertight,  ///< Woop, Benthin, Wald 2013: no ray passes between two triangles that share an edge
};

std::optional<TriangleHit> intersect_triangle(Intersector intersector, const Ray& ray, const Triangle& triangle,
                                              float t_min, float t_max);

/// The nearer and the farther distance at which the line of the ray meets the sphere, in units of its direction;
/// nothing where it passes by. Where they are equal but for rounding either may be the smaller. In double, stable for
/// distant, tiny and large spheres (Haines, Günther and Akenine-Möller 2019, Ray Tracing Gems, ch. 7).
std::optional<std::pair<float, float>> sphere_roots(const Ray& ray, const Sphere& sphere);

/// Closest distance to the sphere, from outside or inside. Intersector::book tests spheres as the book does, by the
/// quadratic formula in floats; the others are stable.
std::optional<float> intersect_sphere(Intersector intersector, const Ray& ray, const Sphere& sphere, float t_min,
                                      float t_max);

/// The hit on a primitive, which must be valid (see is_valid_triangle, is_valid_sphere).
std::optional<Hit> intersect_primitive(Intersector intersector, const Ray& ray, const Geometry& geometry,
                                       const PrimitiveId& id, float t_min, float t_max);

}  // namespace raylab
