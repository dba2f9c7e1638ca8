#pragma once
// Packets of rays against triangles and spheres, as far as they are not the formulas themselves.
#include "geometry/sphere_test.hpp"
#include "ray_traversal.hpp"

namespace raylab::bvh {
namespace {

/// Corner k of the triangles that each lane names.
inline WideVec3 corner_at(const SharedBlock& block, int k, WideUInt triangle) {
  const WideUInt at = look_up16(block.corner[k], triangle);
  return {look_up16(block.position[0], at), look_up16(block.position[1], at), look_up16(block.position[2], at)};
}
inline WideVec3 corner_at(const SeparateBlock& block, int k, WideUInt triangle) {
  const int first = k * kBlockSize;
  return {look_up16(block.position[0] + first, triangle), look_up16(block.position[1] + first, triangle),
          look_up16(block.position[2] + first, triangle)};
}

/// The lanes whose rays may hit a sphere; `length2` is that of the direction, squared. Conservative: the line's
/// distance from the centre, squared and times length2, errs by a few roundings of the centre's, and what is flushed
/// to 0 is less than 2^-100. NaN and overflow count as perhaps.
inline WideMask may_hit_sphere(const WideVec3& origin, const WideVec3& direction, Wide length2, const float* sphere) {
  const WideVec3 oc = origin - WideVec3(Wide(sphere[0]), Wide(sphere[1]), Wide(sphere[2]));
  const float radius2 = sphere[3] * sphere[3];
  const Wide distance2 = multiply_add(oc.x, oc.x, multiply_add(oc.y, oc.y, oc.z * oc.z));
  const Wide along = multiply_add(oc.x, direction.x, multiply_add(oc.y, direction.y, oc.z * direction.z));
  const Wide whole = distance2 * length2;
  const Wide reach = multiply_add(distance2, Wide(0x1p-18f), Wide(radius2 * (1.0f + 0x1p-18f)));
  const WideMask passes =
      (multiply_add(length2, reach, Wide(0x1p-100f)) < multiply_add(-along, along, whole)) & (whole < Wide(kInfinity));
  // Outside, and leaving.
  const WideMask leaves = (Wide(radius2 * (1.0f + 0x1p-16f)) < distance2) & (Wide(0x1p-100f) < along);
  return !(passes | leaves);
}

/// The nearest t with t_min < t <= limit at which rays hit spheres, in those of the lanes it returns. t_min is not
/// negative. Divisions that are not wanted are left out.
[[gnu::always_inline]] inline WideMask hit_sphere(WideMask lanes, const WideVec3& origin, const WideVec3& direction,
                                                  const Vec3<WideDouble>& center, const WideDouble& radius, Wide t_min,
                                                  Wide limit, Wide& t) {
  using D = WideDouble;
  const SphereQuadratic<D> s(Vec3<D>(origin) - center, Vec3<D>(direction), radius);
  // What starts on the sphere and leaves it mostly ends here.
  const D zero(0.0);
  lanes = lanes & !(s.discriminant < zero) & ((s.c < zero) | !(s.b < zero));
  if (!any(lanes)) return lanes;
  const D q = s.q();
  t = to_float(s.c / q);
  // That is the nearer one if q is positive, or else the farther one, and the other is behind the origin. Where q is 0
  // both are, and t is no number or infinite.
  const WideMask starts_inside = lanes & (zero < q) & !(t_min < t);
  if (any(starts_inside)) t = select(starts_inside, to_float(q / s.a), t);
  return lanes & (t_min < t) & (t <= limit);
}

}  // namespace
}  // namespace raylab::bvh
