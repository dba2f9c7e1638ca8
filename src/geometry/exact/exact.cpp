#include "raylab/geometry/exact.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

#include "surd.hpp"
#include "terms.hpp"

namespace raylab {

namespace {

using exact::Ball;
using exact::in_balls;
using exact::in_integers;
using exact::Integer;
using exact::SphereTerms;
using exact::Surd;
using exact::TriangleTerms;

constexpr float kSmallest = std::numeric_limits<float>::min();
constexpr float kLargest = std::numeric_limits<float>::max();

/// How near a crossing is enclosed without asking integers.
constexpr double kEnoughDigits = 0x1p-40;

vec3 without_denormals(const vec3& v) { return {without_denormal(v.x), without_denormal(v.y), without_denormal(v.z)}; }

Surd fraction(Integer numerator, Integer denominator, int exponent) {
  if (denominator.sign() < 0) {
    numerator = -numerator;
    denominator = -denominator;
  }
  return {std::move(numerator), 0, std::move(denominator), 0, exponent};
}

Surd exact_double(double x) {
  int exponent;
  std::frexp(x, &exponent);
  return {exact::scaled(x, exponent - 53), 0, 1, 0, exponent - 53};
}

/// The float nearest to a number within [lower, upper], of two equally near the even one.
/// compare(x) gives the sign of the number less x.
template <class Compare>
float nearest_float(float lower, float upper, const Compare& compare) {
  auto low = std::bit_cast<std::uint32_t>(lower);  // nonnegative floats are in the order of their bits
  auto high = std::bit_cast<std::uint32_t>(upper);
  if (compare(lower) <= 0) return lower;
  if (compare(upper) >= 0) return upper;
  while (high - low > 1) {
    const std::uint32_t middle = low + (high - low) / 2;
    (compare(static_cast<double>(std::bit_cast<float>(middle))) >= 0 ? low : high) = middle;
  }
  const auto below = std::bit_cast<float>(low);
  const auto above = std::bit_cast<float>(high);
  const int side = compare(0.5 * (static_cast<double>(below) + static_cast<double>(above)));
  return side < 0 || (side == 0 && low % 2 == 0) ? below : above;
}

Triangle corners(const Geometry& geometry, const PrimitiveId& id) {
  const Triangle t = triangle_corners(geometry.meshes[id.geometry], id.primitive);
  return {without_denormals(t.p0), without_denormals(t.p1), without_denormals(t.p2)};
}

Sphere sphere_of(const Geometry& geometry, const PrimitiveId& id) {
  const Sphere& s = geometry.spheres[id.primitive];
  return {without_denormals(s.center), s.radius};
}

}  // namespace

struct ExactTest::Exact {
  Surd value;
};

ExactTest::ExactTest(const Geometry& geometry, const Ray& ray, Arithmetic arithmetic)
    : geometry_(geometry),
      ray_{without_denormals(ray.origin), without_denormals(ray.direction), ray.t_min, ray.t_max},
      arithmetic_(arithmetic),
      first_(std::max(next_float_up(ray.t_min), kSmallest)),
      last_(next_float_down(ray.t_max)) {}

std::optional<Crossing> ExactTest::operator()(const PrimitiveId& id) const {
  if (!(first_ <= last_) || ray_.direction == vec3(0.0f)) return std::nullopt;
  return geometry_.is_sphere(id.geometry) ? sphere(id) : triangle(id);
}

std::optional<Crossing> ExactTest::triangle(const PrimitiveId& id) const {
  const Triangle corners_of = corners(geometry_, id);
  const TriangleTerms<Ball> terms = in_balls(ray_, corners_of);
  std::array<std::optional<int>, 3> signs;
  if (arithmetic_ == Arithmetic::adaptive) {
    signs = {terms.u().sign(), terms.v().sign(), terms.w().sign()};
    const auto any = [&](int sign) { return std::find(signs.begin(), signs.end(), sign) != signs.end(); };
    if (any(1) && any(-1)) return std::nullopt;
  }
  if (!signs[0] || !signs[1] || !signs[2]) {
    const auto integer = in_integers(ray_, corners_of).terms;
    signs = {integer.u().sign(), integer.v().sign(), integer.w().sign()};
  }
  const int least = std::min({*signs[0], *signs[1], *signs[2]});
  const int most = std::max({*signs[0], *signs[1], *signs[2]});
  if (least < 0 && most > 0) return std::nullopt;
  if (least == 0 && most == 0) return std::nullopt;
  const Ball t = terms.height() / terms.facing();
  return enclosed({id, 0, t.mid, t.error});
}

std::optional<Crossing> ExactTest::sphere(const PrimitiveId& id) const {
  const Sphere s = sphere_of(geometry_, id);
  const SphereTerms<Ball> terms = in_balls(ray_, s);
  std::optional<int> sign;
  if (arithmetic_ == Arithmetic::adaptive) sign = terms.discriminant.sign();
  if (!sign) sign = in_integers(ray_, s).terms.discriminant.sign();
  if (*sign < 0) return std::nullopt;
  for (const int root : {-*sign, *sign}) {
    const Ball t = exact::root_of(terms, root);
    if (const auto crossing = enclosed({id, root, t.mid, t.error})) return crossing;
  }
  return std::nullopt;
}

/// The crossing with its t enclosed tightly, if it lies inside the interval.
std::optional<Crossing> ExactTest::enclosed(Crossing crossing) const {
  if (arithmetic_ == Arithmetic::integers || !(crossing.error <= kEnoughDigits * std::abs(crossing.t))) {
    crossing.t = exact::approximate(exact_t(crossing).value);
    crossing.error = std::abs(crossing.t) * 0x1p-44;
  }
  const double t_min = ray_.t_min, t_max = ray_.t_max;
  if (!(compare(crossing, t_min) > 0 && compare(crossing, kSmallest) >= 0)) return std::nullopt;
  if (!(compare(crossing, t_max) < 0 && compare(crossing, kLargest) <= 0)) return std::nullopt;
  return crossing;
}

/// The sign of the exact t less the given one.
int ExactTest::compare(const Crossing& crossing, double t) const {
  if (t == std::numeric_limits<double>::infinity()) return -1;
  if (arithmetic_ == Arithmetic::adaptive) {
    const Ball ball{crossing.t, crossing.error};
    if (ball.lower() > t) return 1;
    if (ball.upper() < t) return -1;
  }
  return exact::compare(exact_t(crossing).value, exact_double(t));
}

bool ExactTest::before(const Crossing& a, const Crossing& b) const {
  int order = 0;
  const Ball ball_a{a.t, a.error}, ball_b{b.t, b.error};
  if (arithmetic_ == Arithmetic::adaptive && ball_a.upper() < ball_b.lower()) {
    order = -1;
  } else if (arithmetic_ == Arithmetic::adaptive && ball_b.upper() < ball_a.lower()) {
    order = 1;
  } else {
    order = exact::compare(exact_t(a).value, exact_t(b).value);
  }
  if (order != 0) return order < 0;
  return a.id < b.id;
}

ExactTest::Exact ExactTest::exact_t(const Crossing& crossing) const {
  if (geometry_.is_sphere(crossing.id.geometry)) {
    const auto [terms, exponent] = in_integers(ray_, sphere_of(geometry_, crossing.id));
    return {{terms.towards, terms.discriminant, terms.length_squared, crossing.root, exponent}};
  }
  const auto [terms, exponent] = in_integers(ray_, corners(geometry_, crossing.id));
  return {fraction(terms.height(), terms.facing(), exponent)};
}

Hit ExactTest::to_hit(const Crossing& crossing) const {
  // Each number starts from the floats that its ball lies between.
  const auto rounded = [&](const Ball& ball, float least, float most, const auto& exact_value) {
    float lower = least, upper = most;
    if (arithmetic_ == Arithmetic::adaptive && ball.error < kInfinity) {
      lower = std::clamp(next_float_down(static_cast<float>(ball.lower())), least, most);
      upper = std::clamp(next_float_up(static_cast<float>(ball.upper())), least, most);
      const auto near = static_cast<float>(ball.lower());
      if (near == static_cast<float>(ball.upper())) return std::clamp(near, least, most);
    }
    const Surd value = exact_value();
    return nearest_float(lower, upper, [&](double x) { return exact::compare(value, exact_double(x)); });
  };
  Hit hit{0.0f, 0.0f, 0.0f, crossing.id.geometry, crossing.id.primitive};
  hit.t = rounded({crossing.t, crossing.error}, first_, last_, [&] { return exact_t(crossing).value; });
  if (geometry_.is_sphere(crossing.id.geometry)) return hit;
  const Triangle triangle = corners(geometry_, crossing.id);
  const TriangleTerms<Ball> terms = in_balls(ray_, triangle);
  const Ball facing = terms.facing();
  hit.u = rounded(terms.v() / facing, 0.0f, 1.0f, [&] {
    const auto integer = in_integers(ray_, triangle).terms;
    return fraction(integer.v(), integer.facing(), 0);
  });
  hit.v = rounded(terms.w() / facing, 0.0f, 1.0f, [&] {
    const auto integer = in_integers(ray_, triangle).terms;
    return fraction(integer.w(), integer.facing(), 0);
  });
  hit.u = without_denormal(hit.u);
  hit.v = without_denormal(hit.v);
  return hit;
}

}  // namespace raylab
