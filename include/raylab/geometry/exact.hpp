#pragma once
// Ray against one primitive without rounding: decisions are those of real arithmetic on the floats given.
#include <optional>

#include "raylab/core/ray.hpp"
#include "raylab/geometry/geometry.hpp"

namespace raylab {

/// Where a ray meets a primitive. The exact t is defined by the ray, `id` and `root`; here it is enclosed.
struct Crossing {
  PrimitiveId id;
  int root;      ///< of a sphere: -1 the nearer, 1 the farther; 0 on triangles and where a line touches a sphere
  double t;      ///< in units of the direction
  double error;  ///< |exact t - t| is no larger, and no more than 2^-40 of t
};

/// One ray against any valid primitive, decided exactly. A triangle includes its edges and vertices; one without
/// area, and one in whose plane the ray runs, is not met: the tests in float miss it too, and in a closed
/// surface its neighbours are met where it ends. A line that touches a sphere meets it.
/// Denormals count as zero, in coordinates as in t (see Accelerator), whatever the flags of the thread.
/// Nothing is allocated.
class ExactTest {
 public:
  /// What decides: balls in double, then integers where they cannot; or integers alone, which is slow and must
  /// answer the same.
  enum class Arithmetic { adaptive, integers };

  /// Views the geometry.
  ExactTest(const Geometry& geometry, const Ray& ray, Arithmetic arithmetic = Arithmetic::adaptive);

  /// As it is understood: without denormals.
  const Ray& ray() const { return ray_; }

  /// The nearest crossing with t_min < t < t_max. There is none if no float lies between the two.
  std::optional<Crossing> operator()(const PrimitiveId& id) const;

  /// Whether a comes before b: smaller t, or the same and the smaller id.
  bool before(const Crossing& a, const Crossing& b) const;

  /// t, u and v are the floats nearest to the exact values, and t the nearest of those inside the interval.
  Hit to_hit(const Crossing& crossing) const;

 private:
  struct Exact;
  Exact exact_t(const Crossing& crossing) const;
  std::optional<Crossing> triangle(const PrimitiveId& id) const;
  std::optional<Crossing> sphere(const PrimitiveId& id) const;
  std::optional<Crossing> enclosed(Crossing crossing) const;
  int compare(const Crossing& crossing, double t) const;

  const Geometry& geometry_;
  Ray ray_;
  Arithmetic arithmetic_;
  float first_, last_;  ///< of the floats inside the interval
};

}  // namespace raylab
