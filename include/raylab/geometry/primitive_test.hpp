#pragma once
// One ray against any primitive of a Geometry, with the chosen triangle test.
#include <optional>
#include <type_traits>

#include "raylab/core/ray.hpp"
#include "raylab/geometry/geometry.hpp"
#include "raylab/geometry/intersect.hpp"

namespace raylab {

/// The determinant below which the book's triangle test gives up, whatever the scale.
inline constexpr float kBookDeterminant = 1e-8f;

/// A ray made ready for one kind of intersector: what the test needs of the ray alone is computed once.
/// Kind `book` also tests spheres as the book does; the others use intersect_sphere.
template <Intersector kind>
class PrimitiveTest {
 public:
  explicit PrimitiveTest(const Ray& ray) : ray_(ray), prepared_(ray) {}

  const Ray& ray() const { return ray_; }

  /// The hit on the primitive with t_min < t < t_max, or nothing; the interval of the ray itself is ignored.
  /// The primitive must be valid (see is_valid_triangle, is_valid_sphere).
  std::optional<Hit> operator()(const Geometry& geometry, const PrimitiveId& id, float t_min, float t_max) const {
    if (geometry.is_sphere(id.geometry)) {
      const auto t = sphere(geometry.spheres[id.primitive], t_min, t_max);
      if (!t) return std::nullopt;
      return Hit{*t, 0.0f, 0.0f, id.geometry, id.primitive};
    }
    const auto hit = triangle(triangle_corners(geometry.meshes[id.geometry], id.primitive), t_min, t_max);
    if (!hit) return std::nullopt;
    return Hit{hit->t, hit->u, hit->v, id.geometry, id.primitive};
  }

  std::optional<TriangleHit> triangle(const Triangle& tri, float t_min, float t_max) const {
    if constexpr (kind == Intersector::watertight) {
      return intersect_watertight(prepared_, tri, t_min, t_max);
    } else {
      constexpr float smallest_determinant = kind == Intersector::book ? kBookDeterminant : 0.0f;
      return intersect_moeller_trumbore(ray_, tri, t_min, t_max, smallest_determinant);
    }
  }

  std::optional<float> sphere(const Sphere& s, float t_min, float t_max) const {
    if constexpr (kind == Intersector::book) return intersect_sphere_book(ray_, s, t_min, t_max);
    return intersect_sphere(ray_, s, t_min, t_max);
  }

 private:
  struct Nothing {
    explicit Nothing(const Ray&) {}
  };

  Ray ray_;
  [[no_unique_address]] std::conditional_t<kind == Intersector::watertight, WatertightRay, Nothing> prepared_;
};

}  // namespace raylab
