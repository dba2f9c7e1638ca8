#pragma once
// Several rays, one in each lane of a vector, against one box, triangle or sphere. Lane by lane the operations on
// triangles are those of BlockTest, so the hits are the same bit for bit. Local to the including file.
#include "block_test.hpp"
#include "raylab/core/wide_double.hpp"

namespace raylab::bvh {
namespace {

/// kx, ky, kz of BlockTest for each lane, without its swap for directions down the z axis: that turns all three
/// edge functions around, which changes no answer.
class PacketTriangleTest {
 public:
  PacketTriangleTest() = default;
  PacketTriangleTest(const WideVec3& origin, const WideVec3& direction) : origin_(origin), direction_(direction) {
    const WideVec3 size = abs(direction);
    const WideMask x_over_y = size.x > size.y;
    z_is_x_ = x_over_y & (size.x > size.z);
    z_is_y_ = (!x_over_y) & (size.y > size.z);
    Wide x, y;
    permute(direction, x, y, direction_z_);
    shear_x_ = x / direction_z_;
    shear_y_ = y / direction_z_;
  }

  struct Vertex {
    Wide x, y, z;
  };
  Vertex transform(const WideVec3& p) const {
    Vertex v;
    permute(p - origin_, v.x, v.y, v.z);
    v.x = v.x - shear_x_ * v.z;
    v.y = v.y - shear_y_ * v.z;
    return v;
  }

  struct Edges {
    Wide u, v, w, smallest, largest;
  };
  static Edges edges(const Vertex& a, const Vertex& b, const Vertex& c) {
    Edges e;
    e.u = c.x * b.y - c.y * b.x;
    e.v = a.x * c.y - a.y * c.x;
    e.w = b.x * a.y - b.y * a.x;
    e.smallest = lesser(e.w, lesser(e.v, e.u));
    e.largest = greater(e.w, greater(e.v, e.u));
    return e;
  }
  /// The lanes whose rays pass inside the edges of a triangle, or through them.
  static WideMask inside(const Vertex& a, const Vertex& b, const Vertex& c) {
    const Edges e = edges(a, b, c);
    return !((e.smallest < Wide(0.0f)) & (Wide(0.0f) < e.largest));
  }

  struct Found {
    WideMask hit;        ///< certainly, at t, with t_min < t <= limit
    WideMask imprecise;  ///< certainly, but t has to be computed again: see plane_distance()
    WideMask unsure;     ///< only the scalar test can tell
    Wide t, beta, gamma;
  };
  /// Of lanes that are inside. With any_hit the distances need not be right.
  template <bool any_hit>
  Found find(WideMask lanes, const Vertex& a, const Vertex& b, const Vertex& c, Wide t_min, Wide limit) const {
    Found found;
    const Wide zero(0.0f);
    const Edges e = edges(a, b, c);
    const Wide det = e.u + e.v + e.w;
    const Wide inv_det = Wide(1.0f) / det;
    found.beta = e.v * inv_det;
    found.gamma = e.w * inv_det;
    const Wide ab = b.z - a.z, ac = c.z - a.z;
    const Wide z = a.z + found.beta * ab + found.gamma * ac;
    found.t = z / direction_z_;
    const Wide size = magnitude(det);
    const Wide xy_size = greater(largest_xy(a), greater(largest_xy(b), largest_xy(c)));
    const Wide z_size = greater(magnitude(a.z), greater(magnitude(b.z), magnitude(c.z)));
    const Wide error = z_size * (greater(magnitude(ab), magnitude(ac)) * xy_size);
    const Wide depth = magnitude(z) * size;
    const WideMask precise =
        (error < Wide(kTrustedSlope) * depth) | ((found.t < zero) & (error < Wide(kTrustedSignSlope) * depth));
    const WideMask sure =
        lanes & (Wide(0x1p-100f) < size) & (size < Wide(0x1p120f)) & (e.smallest != zero) & (e.largest != zero);
    const Wide margin = greater(error, Wide(kSmallestError)) * Wide(kRoughError) * magnitude(found.t);
    WideMask decided = precise | (margin < (found.t - limit) * depth);
    if constexpr (any_hit) {
      decided = decided | ((margin < (limit - found.t) * depth) & (margin < (found.t - t_min) * depth));
    }
    found.unsure = lanes & !sure;
    found.imprecise = sure & !decided;
    found.hit = sure & decided & (t_min < found.t) & (found.t <= limit);
    return found;
  }

  /// watertight_plane_distance() for all lanes, of triangles with these corners.
  Wide plane_distance(const WideVec3 (&corner)[3], Wide otherwise) const {
    const WideDouble p0x(corner[0].x), p0y(corner[0].y), p0z(corner[0].z);
    const WideDouble e1x = WideDouble(corner[1].x) - p0x, e2x = WideDouble(corner[2].x) - p0x;
    const WideDouble e1y = WideDouble(corner[1].y) - p0y, e2y = WideDouble(corner[2].y) - p0y;
    const WideDouble e1z = WideDouble(corner[1].z) - p0z, e2z = WideDouble(corner[2].z) - p0z;
    const WideDouble nx = e1y * e2z - e2y * e1z, ny = e1z * e2x - e2z * e1x, nz = e1x * e2y - e2x * e1y;
    const WideDouble x = WideDouble(direction_.x) * nx;
    const WideDouble y = WideDouble(direction_.y) * ny;
    const WideDouble z = WideDouble(direction_.z) * nz;
    const WideDouble facing = x + y + z;
    const WideDouble distance = (p0x - WideDouble(origin_.x)) * nx + (p0y - WideDouble(origin_.y)) * ny +
                                (p0z - WideDouble(origin_.z)) * nz;
    const WideDouble t = distance / facing;
    const WideMask doubtful =
        !(WideDouble(kDoubtfulFacing) * (magnitude(x) + magnitude(y) + magnitude(z)) < magnitude(facing));
    if (!any(doubtful)) [[likely]]
      return t.to_float();
    const WideDouble direction_z(direction_z_);
    const WideDouble origin_z(z_of(origin_));
    const auto at_corner = [&](int k) { return (WideDouble(z_of(corner[k])) - origin_z) / direction_z; };
    const WideDouble t0 = at_corner(0), t1 = at_corner(1), t2 = at_corner(2);
    const WideDouble kept = at_most(at_least(t, at_most(at_most(t0, t1), t2)), at_least(at_least(t0, t1), t2));
    const WideMask along = !((facing < WideDouble(0.0)) | (WideDouble(0.0) < facing));
    return select(doubtful, select(along, otherwise, kept.to_float()), t.to_float());
  }

 private:
  static Wide largest_xy(const Vertex& v) { return greater(magnitude(v.x), magnitude(v.y)); }
  Wide z_of(const WideVec3& v) const { return select(z_is_x_, v.x, select(z_is_y_, v.y, v.z)); }
  void permute(const WideVec3& v, Wide& x, Wide& y, Wide& z) const {
    x = select(z_is_x_, v.y, select(z_is_y_, v.z, v.x));
    y = select(z_is_x_, v.z, select(z_is_y_, v.x, v.y));
    z = z_of(v);
  }

  WideVec3 origin_, direction_;
  WideMask z_is_x_, z_is_y_;
  Wide direction_z_, shear_x_, shear_y_;
};

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

/// BoxTest with the lanes for rays instead of children.
class PacketBoxTest {
 public:
  explicit PacketBoxTest(const WideVec3& origin, const WideVec3& direction) : origin_(origin) {
    const WideVec3 reciprocal(Wide(1.0f) / direction.x, Wide(1.0f) / direction.y, Wide(1.0f) / direction.z);
    to_near_ = reciprocal * Wide(kShrink);
    to_far_ = reciprocal * Wide(kGrow);
    // By the sign bit of the reciprocal, -0 being downwards.
    down_x_ = reciprocal.x < Wide(0.0f);
    down_y_ = reciprocal.y < Wide(0.0f);
    down_z_ = reciprocal.z < Wide(0.0f);
  }

  int octant(int lane) const {
    return static_cast<int>((down_x_.bits() >> lane & 1u) | (down_y_.bits() >> lane & 1u) << 1 |
                            (down_z_.bits() >> lane & 1u) << 2);
  }

  template <int width>
  WideMask operator()(const Node<width>& node, int child, Wide t_min, Wide limit, Wide& near) const {
    const Wide lower_x(node.planes[0][child]), upper_x(node.planes[1][child]);
    const Wide lower_y(node.planes[2][child]), upper_y(node.planes[3][child]);
    const Wide lower_z(node.planes[4][child]), upper_z(node.planes[5][child]);
    const Wide x = (select(down_x_, upper_x, lower_x) - origin_.x) * to_near_.x;
    const Wide y = (select(down_y_, upper_y, lower_y) - origin_.y) * to_near_.y;
    const Wide z = (select(down_z_, upper_z, lower_z) - origin_.z) * to_near_.z;
    const Wide far_x = (select(down_x_, lower_x, upper_x) - origin_.x) * to_far_.x;
    const Wide far_y = (select(down_y_, lower_y, upper_y) - origin_.y) * to_far_.y;
    const Wide far_z = (select(down_z_, lower_z, upper_z) - origin_.z) * to_far_.z;
    near = greater(greater(x, y), greater(z, t_min));
    return near <= lesser(lesser(far_x, far_y), lesser(far_z, limit));
  }

 private:
  WideVec3 origin_, to_near_, to_far_;
  WideMask down_x_, down_y_, down_z_;
};

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
  const WideMask passes = (multiply_add(length2, reach, Wide(0x1p-100f)) < multiply_add(-along, along, whole)) &
                          (whole < Wide(kInfinity));
  // Outside, and leaving.
  const WideMask leaves = (Wide(radius2 * (1.0f + 0x1p-16f)) < distance2) & (Wide(0x1p-100f) < along);
  return !(passes | leaves);
}

/// intersect_sphere() operation by operation, but for divisions that are not wanted: the nearest t with
/// t_min < t <= limit, in those of the lanes it returns. t_min is not negative.
/// Number is double where it is one sphere for all lanes, or else WideDouble.
template <class Number>
WideMask sphere_distance(WideMask lanes, const WideVec3& origin, const WideVec3& direction, const Number (&sphere)[4],
                         Wide t_min, Wide limit, Wide& t) {
  const WideDouble dx(direction.x), dy(direction.y), dz(direction.z);
  const WideDouble ox = WideDouble(origin.x) - sphere[0];
  const WideDouble oy = WideDouble(origin.y) - sphere[1];
  const WideDouble oz = WideDouble(origin.z) - sphere[2];
  const Number& radius = sphere[3];
  const WideDouble a = dx * dx + dy * dy + dz * dz;
  const WideDouble b = -(ox * dx + oy * dy + oz * dz);
  const WideDouble mx = oy * dz - dy * oz, my = oz * dx - dz * ox, mz = ox * dy - dx * oy;
  const WideDouble discriminant = WideDouble(radius * radius) * a - (mx * mx + my * my + mz * mz);
  const WideDouble c = ox * ox + oy * oy + oz * oz - radius * radius;
  // What starts on the sphere and leaves it mostly ends here.
  const WideDouble zero(0.0);
  lanes = lanes & !(discriminant < zero) & ((c < zero) | !(b < zero));
  if (!any(lanes)) return lanes;
  const WideDouble q = b + flipped_with(square_root(discriminant), b);
  t = (c / q).to_float();
  // That is the nearer one if q is positive, or else the farther one, and the other is behind the origin. Where q is 0
  // both are, and t is no number or infinite.
  const WideMask starts_inside = lanes & (zero < q) & !(t_min < t);
  if (any(starts_inside)) t = select(starts_inside, (q / a).to_float(), t);
  return lanes & (t_min < t) & (t <= limit);
}

}  // namespace
}  // namespace raylab::bvh
