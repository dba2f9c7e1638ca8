#pragma once
// Ways from a point to a light over one smooth sphere, reflected or refracted through, over the number type F.
//
// Such a way lies in the plane through its two ends and the sphere's centre, and its straight pieces outside the sphere
// pass the centre at one distance b = R sin t, with t the angle of incidence. Seen from the centre, its ends lie
//   turn(t) = 2 t - asin(b / d) - asin(b / D) - 2 k asin(b / (n R)),   and k pi more,
// apart, where d and D are their distances, n the index and k the number of times that the way crosses the sphere: 0
// for a reflection, 1 for a way straight through, 2 for one that is reflected inside. For n >= 1 the turn is convex in
// t: each term's derivative, cos t / sqrt(a^2 - sin^2 t), falls where a >= 1. So Newton's method started at an end of
// the interval runs to the root without overshooting, and there are at most one reflection and three ways through.
#include "bsdf.hpp"
#include "core/simd/lanes.hpp"
#include "core/warp.hpp"
#include "light_lanes.hpp"

namespace raylab {
namespace {

/// A sphere, and which way light goes: off it (0), or across it once (1) or twice (2).
template <class F>
struct SphereChain {
  Vec3<F> center;
  F radius, index;
  F crossings;
};

/// Where ways that cross twice start and end, at most, as one over the distance from the centre in radii, and their
/// least index: nearer ones may turn by more than pi, which their angle does not say.
constexpr float kTwiceNearest = 0.9f;
constexpr float kTwiceIndex = 1.3f;

/// From the numbers of a row of SphereChainTable, by column.
template <class F, class Column>
SphereChain<F> sphere_chain(const Column& column) {
  return {{column(0), column(1), column(2)}, column(3), column(4), column(5)};
}

/// The two ends of a way over a sphere, lengths in its radii.
template <class F>
struct ChainEnds {
  Vec3<F> axis, light, side;  ///< unit: to the centre, from there to the light, and from the axis to that one's side
  F inv_near, inv_far;        ///< one over the distances of the point and the light from the centre
  F inv_index;
  F crossings;
  F angle;             ///< between the ends as seen from the centre, or what it is short of pi for ways that cross once
  MaskOf<F> opposite;  ///< these
  MaskOf<F> outside;   ///< both ends are far enough from the sphere
};

template <class F>
ChainEnds<F> chain_ends(const SphereChain<F>& chain, const Vec3<F>& p, const Vec3<F>& light,
                        const MaskOf<F>& infinite) {
  ChainEnds<F> ends;
  const Vec3<F> to_center = chain.center - p;
  const F near = sqrt(dot(to_center, to_center));
  const Vec3<F> to_light = select<F>(infinite, light, light - chain.center);
  const F far = sqrt(dot(to_light, to_light));
  ends.axis = to_center / near;
  ends.light = to_light / far;
  ends.inv_near = chain.radius / near;
  ends.inv_far = select(infinite, F(0.0f), chain.radius / far);
  ends.inv_index = F(1.0f) / chain.index;
  ends.crossings = chain.crossings;
  ends.opposite = chain.crossings == F(1.0f);
  const F nearest = select(chain.crossings == F(2.0f), F(kTwiceNearest), F(1.0f));
  ends.outside = (ends.inv_near < nearest) & (ends.inv_far < nearest);
  const F along = dot(ends.light, ends.axis);
  const Vec3<F> across = ends.light - along * ends.axis;
  const F sine = sqrt(dot(across, across));
  ends.side = across / max(sine, F(1e-30f));
  ends.angle = arc_tangent<F>(sine, select(ends.opposite, along, -along));
  return ends;
}

/// A way at one angle of incidence.
template <class F>
struct ChainTurn {
  F cos_near, cos_far;  ///< of the angles between the way and the axes at its ends
  F angle;              ///< the turn
  F sine_ratio;         ///< its sine over that of the angle of incidence
  F slope;              ///< its derivative by the angle of incidence
};

template <class F>
ChainTurn<F> chain_turn(const ChainEnds<F>& ends, const F& sine, const F& cosine) {
  const auto cosine_of = [&](const F& inv) {
    const F s = sine * inv;
    return sqrt(max((F(1.0f) - s) * (F(1.0f) + s), F(1e-30f)));
  };
  ChainTurn<F> turn;
  turn.cos_near = cosine_of(ends.inv_near);
  turn.cos_far = cosine_of(ends.inv_far);
  const F cos_inside = cosine_of(ends.inv_index);
  // As a product of complex numbers, whose imaginary parts are kept over `sine`: so it is exact for small ones.
  const F sine2 = sine * sine;
  F real = cosine * cosine - sine2, imaginary = F(2.0f) * cosine;
  const auto turn_back = [&](const F& c, const F& s) {
    const F r = real * c + sine2 * (imaginary * s);
    imaginary = imaginary * c - real * s;
    real = r;
  };
  turn_back(turn.cos_near, ends.inv_near);
  turn_back(turn.cos_far, ends.inv_far);
  turn.slope = F(2.0f) - cosine * (ends.inv_near / turn.cos_near + ends.inv_far / turn.cos_far);
  const F cross_c = cos_inside * cos_inside - sine2 * (ends.inv_index * ends.inv_index);
  const F cross_s = F(2.0f) * cos_inside * ends.inv_index;
  for (int k = 1; k <= 2; ++k) {
    const MaskOf<F> crosses = ends.crossings >= F(static_cast<float>(k));
    if (any(crosses)) turn_back(select(crosses, cross_c, F(1.0f)), select(crosses, cross_s, F(0.0f)));
  }
  turn.slope = turn.slope - F(2.0f) * ends.crossings * cosine * (ends.inv_index / cos_inside);
  turn.sine_ratio = imaginary;
  turn.angle = arc_tangent<F>(imaginary * sine, real);
  return turn;
}

/// How many roots are told apart: 1 where the turn rises from the start, as for reflections. Where it falls at first
/// there may be a way with its angle, and two with the opposite one, of which both or none exist.
template <class F>
F chain_roots(const ChainEnds<F>& ends) {
  const F slope = F(2.0f) - ends.inv_near - ends.inv_far - F(2.0f) * ends.crossings * ends.inv_index;
  const MaskOf<F> folded = slope < F(0.0f);
  if (!any(folded)) return F(1.0f);
  const MaskOf<F> crossing = chain_turn<F>(ends, F(1.0f), F(0.0f)).angle >= ends.angle;
  return select(folded, select(crossing, F(3.0f), F(2.0f)), F(1.0f));
}

/// Share of light that the turns leave, which for glass is the probability that scattering takes them.
template <class F>
F chain_reflectance(const ChainEnds<F>& ends, const MaskOf<F>& metal, const F& index, const F& cosine) {
  F cos_t;
  const F reflected = fresnel_dielectric<F>(min(cosine, F(1.0f)), index, cos_t);
  const F through = (F(1.0f) - reflected) * (F(1.0f) - reflected);
  const F inside = select(ends.crossings == F(2.0f), reflected, F(1.0f));
  return select(metal, F(1.0f), select(ends.crossings > F(0.0f), through * inside, reflected));
}

/// Density per steradian at the point over that of the light as seen from the sphere's centre, but for the share of
/// facing areas, |cos| at the light as seen from the centre over |cos| as the way arrives.
template <class F>
F chain_spread(const ChainEnds<F>& ends, const ChainTurn<F>& turn, const F& cosine) {
  return turn.cos_near * turn.cos_far * abs(turn.sine_ratio * turn.slope) /
         (ends.inv_near * ends.inv_near * max(cosine, F(1e-30f)));
}

/// Error of the turn in float, of which the way is found: four times that of the sum of its angles.
constexpr float kTurnError = 4e-6f;

/// A way found.
template <class F>
struct SphereWay {
  Vec3<F> wi;              ///< unit, from the point
  Vec3<F> arrives;         ///< unit, to the light
  Vec3<F> enters, leaves;  ///< unit normals of the sphere where the way meets it first and last
  F cosine;                ///< of the angle of incidence
  F spread;                ///< see chain_spread(), choice of the root included
  MaskOf<F> found;
};

/// `number`, in [0, 1), chooses the root.
template <class F>
SphereWay<F> sphere_way(const ChainEnds<F>& ends, const F& number) {
  const F roots = chain_roots<F>(ends);
  const MaskOf<F> folded = roots > F(1.0f);
  const F chosen = number * roots;
  const MaskOf<F> inner = folded & (chosen < F(1.0f));
  const MaskOf<F> opposite = folded & (chosen < F(2.0f));
  const F target = select(opposite, -ends.angle, ends.angle);
  // The inner root is run to from the axis, where the turn is 0 and falls, the others from the rim.
  F sine = select(inner, F(0.0f), F(1.0f));
  F cosine = select(inner, F(1.0f), F(0.0f));
  MaskOf<F> active = ends.outside, found = MaskOf<F>{};
  ChainTurn<F> turn;
  constexpr int kSteps = 16;
  for (int step = 0;; ++step) {
    turn = chain_turn<F>(ends, sine, cosine);
    const F beyond = turn.angle - target;
    const MaskOf<F> near = abs(beyond) <= F(kTurnError);
    // Where there is no root, the steps lead past the turn's minimum or out of the interval, or the way at the rim
    // turns too little from the start.
    const MaskOf<F> within = (sine >= F(0.0f)) & (cosine >= F(0.0f));
    const MaskOf<F> falls = inner & (turn.slope < F(0.0f)), rises = (!inner) & (turn.slope > F(0.0f));
    const MaskOf<F> runs = within & (falls | rises);
    found = found | (active & near & runs);
    active = active & runs & (beyond > F(0.0f)) & !near;
    if (!any(active) || step == kSteps) break;
    // By 2 atan(step / 2), which falls short of the step.
    const F half = F(0.5f) * beyond / turn.slope;
    const F scale = F(1.0f) / (F(1.0f) + half * half);
    const F c = (F(1.0f) - half * half) * scale, s = F(2.0f) * half * scale;
    const F next = sine * c - cosine * s;
    cosine = select(active, cosine * c + sine * s, cosine);
    sine = select(active, next, sine);
  }
  SphereWay<F> way;
  way.found = found;
  way.cosine = cosine;
  // Each end's part turns in the plane of its own axis and the direction beside it, by the angle between way and axis
  // out there, and by that less the angle of incidence on the sphere.
  const F sign = select(opposite ^ ends.opposite, F(-1.0f), F(1.0f));
  const Vec3<F> beside = sign * ends.side;
  const F across = dot(ends.light, ends.side), along = dot(ends.light, ends.axis);
  const Vec3<F> beside_light = sign * (across * ends.axis - along * ends.side);
  const F sin_near = sine * ends.inv_near, sin_far = sine * ends.inv_far;
  way.wi = turn.cos_near * ends.axis + sin_near * beside;
  way.arrives = turn.cos_far * ends.light + sin_far * beside_light;
  way.enters =
      (sine * turn.cos_near - cosine * sin_near) * beside - (cosine * turn.cos_near + sine * sin_near) * ends.axis;
  way.leaves =
      (cosine * turn.cos_far + sine * sin_far) * ends.light - (sine * turn.cos_far - cosine * sin_far) * beside_light;
  way.spread = chain_spread<F>(ends, turn, cosine) / roots;
  return way;
}

/// How likely a row of SphereChainTable is to be chosen from p, as a weight: as what the sphere hides of the sky.
/// column(k, row) is the k-th number of the row.
template <class F, class Column>
F chain_weight(const Column& column, int row, const Vec3<F>& p) {
  const Vec3<F> to_center = Vec3<F>(F(column(0, row)), F(column(1, row)), F(column(2, row))) - p;
  const F distance2 = dot(to_center, to_center);
  return select(distance2 > F(column(3, row)) * F(column(3, row)), F(column(6, row)) / distance2, F(0.0f));
}

/// The probability of a row.
template <class F, class Column>
F chain_choice(int count, const Column& column, const Vec3<F>& p, std::uint32_t row) {
  F total(0.0f);
  for (int i = 0; i < count; ++i) total = total + chain_weight<F>(column, i, p);
  return chain_weight<F>(column, static_cast<int>(row), p) / total;
}

template <class F>
struct ChosenChain {
  UIntOf<F> row;
  F probability;  ///< 0 where p lies within all spheres
  F left;         ///< of the number that chose it, in [0, 1)
};

template <class F, class Column>
ChosenChain<F> choose_chain(int count, const Column& column, const Vec3<F>& p, const F& number) {
  constexpr int kMost = 16;
  F weights[kMost];
  F total(0.0f);
  for (int i = 0; i < count; ++i) {
    weights[i] = chain_weight<F>(column, i, p);
    total = total + weights[i];
  }
  const F mark = number * total;
  ChosenChain<F> chosen{UIntOf<F>(0u), F(0.0f), F(0.0f)};
  F before(0.0f);
  for (int i = 0; i < count; ++i) {
    const MaskOf<F> here = (weights[i] > F(0.0f)) & (mark >= before);
    chosen.row = select(here, UIntOf<F>(static_cast<std::uint32_t>(i)), chosen.row);
    chosen.probability = select(here, weights[i] / total, chosen.probability);
    chosen.left = select(here, min((mark - before) / weights[i], F(kBelowOne)), chosen.left);
    before = before + weights[i];
  }
  return chosen;
}

/// A way over a sphere to a point of a light, as a sampled light in the direction in which it starts: its density is
/// over the probability that scattering takes the way's turns, so that it is to be weighed against scattering's own.
template <class F>
struct LightOverSphere {
  Vec3<F> wi;
  F pdf;                   ///< 0: there is no way
  Vec3<F> enters, leaves;  ///< as in SphereWay
};

/// light: as sampled from the sphere's centre.
template <class F>
LightOverSphere<F> light_over_sphere(const SphereChain<F>& chain, const ChosenChain<F>& chosen, const Vec3<F>& p,
                                     const SampledLight<F>& light) {
  const ChainEnds<F> ends =
      chain_ends<F>(chain, p, select<F>(light.infinite, light.wi, light.position), light.infinite);
  const SphereWay<F> way = sphere_way<F>(ends, chosen.left);
  const F facing = select(light.infinite, F(1.0f), abs(dot(ends.light, light.ng) / dot(way.arrives, light.ng)));
  const F reflectance = chain_reflectance<F>(ends, chain.index == F(1.0f), chain.index, way.cosine);
  const F density = light.pdf * chosen.probability * (way.spread * facing) / reflectance;
  const MaskOf<F> usable = way.found & (density > F(0.0f)) & (density < F(kInfinity));
  return {way.wi, select(usable, density, F(0.0f)), way.enters, way.leaves};
}

/// The two rays of a way outside the sphere, of which neither may be occluded: both end, or start, outside of what
/// rounding leaves uncertain of the sphere.
template <class F>
struct SphereRays {
  F first_end;  ///< t_max of a ray from `start` that has its direction
  Vec3<F> first_direction;
  Vec3<F> origin, direction;  ///< of the last one
  F end;
};

template <class F>
SphereRays<F> sphere_rays(const SphereChain<F>& chain, const LightOverSphere<F>& over, const SampledLight<F>& light,
                          const Vec3<F>& start) {
  const auto offset = [&](const Vec3<F>& n) {
    return F(gamma_bound(16)) * (dot(abs(n), abs(chain.center)) + chain.radius);
  };
  SphereRays<F> rays;
  rays.first_direction = chain.center + chain.radius * over.enters - start;
  rays.first_end = shadow_end<F>(rays.first_direction, over.enters, offset(over.enters),
                                 F(1.0f) / abs(dot(rays.first_direction, over.enters)));
  rays.origin = chain.center + (chain.radius + offset(over.leaves)) * over.leaves;
  rays.direction = select<F>(light.infinite, light.wi, light.position - rays.origin);
  // As long before the light as from the centre.
  const Vec3<F> from_center = light.position - chain.center;
  const F share = sqrt(dot(from_center, from_center) / dot(rays.direction, rays.direction));
  rays.end = select(light.infinite, F(kInfinity), max(F(1.0f) - (F(1.0f) - light.end) * share, F(0.0f)));
  return rays;
}

}  // namespace
}  // namespace raylab
