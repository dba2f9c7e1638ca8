#pragma once
// One ray against any primitive of a Geometry, with the chosen triangle test, inline.
#include "scalar_tests.hpp"

namespace raylab {
namespace {

inline std::optional<TriangleHit> moeller_trumbore(Intersector kind, const Ray& ray, const Triangle& tri, float t_min,
                                                   float t_max) {
  const MoellerTrumboreHit<float> hit =
      moeller_trumbore<float>(ray.origin, ray.direction, tri.p0, tri.p1, tri.p2, smallest_determinant(kind));
  if (!(hit.inside && hit.t > t_min && hit.t < t_max)) return std::nullopt;
  return TriangleHit{hit.t, hit.u, hit.v};
}

/// A ray made ready for one kind of intersector: what the test needs of the ray alone is computed once.
template <Intersector kind>
class PrimitiveTest {
 public:
  explicit PrimitiveTest(const Ray& ray) : ray_(ray), prepared_(ray.origin, ray.direction) {}

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
      return watertight(prepared_, tri.p0, tri.p1, tri.p2, t_min, t_max);
    } else {
      return moeller_trumbore(kind, ray_, tri, t_min, t_max);
    }
  }

  std::optional<float> sphere(const Sphere& s, float t_min, float t_max) const {
    float t;
    if (!sphere_hit<kind>(ray_.origin, ray_.direction, s.center, s.radius, t_min, t_max, t) || !(t < t_max))
      return std::nullopt;
    return t;
  }

 private:
  struct Nothing {
    Nothing(const Vec3<float>&, const Vec3<float>&) {}
  };

  Ray ray_;
  [[no_unique_address]] std::conditional_t<kind == Intersector::watertight, PreparedRay, Nothing> prepared_;
};

/// Calls f(PrimitiveTest<kind>(ray)), for an intersector known only at run time.
template <class F>
auto with_primitive_test(Intersector kind, const Ray& ray, const F& f) {
  switch (kind) {
    case Intersector::book:
      return f(PrimitiveTest<Intersector::book>(ray));
    case Intersector::fast:
      return f(PrimitiveTest<Intersector::fast>(ray));
    case Intersector::watertight:
      break;
  }
  return f(PrimitiveTest<Intersector::watertight>(ray));
}

}  // namespace
}  // namespace raylab
