#pragma once
// Points of lights for the lanes of a vector, and the probabilities with which they are chosen.
#include "light_choice.hpp"
#include "path_vertex.hpp"
#include "shading_scene.hpp"
#include "wavefront_queues.hpp"

namespace raylab {
namespace {

/// The numbers of the bits that are set.
template <class Visit>
void for_each(std::uint32_t bits, const Visit& visit) {
  for (; bits != 0; bits &= bits - 1) visit(__builtin_ctz(bits));
}

inline vec3 lane(const VectorLanes& a, int i) { return {a[0][i], a[1][i], a[2][i]}; }

/// Lights::sample() and the like for lanes.
class LightSampler {
 public:
  explicit LightSampler(const ShadingScene& scene) : scene_(scene) {}

  /// A point of a light for each lane as seen from a position, by the sampler's dimensions `point` and `choice`, which
  /// are kLightPoint and kLightChoice or others in their place. ng: of the surface that receives; 0 for all sides.
  SampledLight<Wide> sample(WideMask lanes, const BasicSampler<Wide>& sampler, std::uint32_t point,
                            std::uint32_t choice, const WideVec3& position, const WideVec3& ng) {
    const auto bits = sampler.bits2(point);
    const Wide v = bits_to_unit(bits.second);
    const LightTable& few = scene_.light_table;
    if (few.count != 0) {
      const Wide number = bits_to_unit(bits.first);
      WideUInt chosen(0u);
      for (int i = 1; i < few.count; ++i) chosen += select(Wide(few.first[i]) <= number, WideUInt(1u), WideUInt(0u));
      const Wide u = left_of_choice(number, look_up16(few.first, chosen), look_up16(few.scale, chosen));
      return sample_triangles([&](int k) { return look_up16(few.columns[k], chosen); }, position, {u, v});
    }
    alignas(64) std::uint32_t select_high[kMostLanes], select_low[kMostLanes];
    alignas(64) float v_lanes[kMostLanes];
    VectorLanes p;
    bits.first.store(select_high);
    sampler.bits2(choice).first.store(select_low);
    v.store(v_lanes);
    store3(position, p);
    if (scene_.light_tree.nodes != nullptr) {
      return sample_tree(lanes, select_high, select_low, v, v_lanes, position, p, ng);
    }
    scene_.lights.sample(lanes.bits(), select_high, select_low, v_lanes, {p[0], p[1], p[2]}, light_);
    const WideMask triangles = WideMask::of(light_.triangles);
    SampledLight<Wide> light{load3(light_.wi),       load3(light_.position), load3(light_.radiance),
                             Wide::load(light_.end), Wide::load(light_.pdf), WideMask::of(light_.infinite),
                             load3(light_.ng)};
    if (any(triangles)) {
      constexpr auto row = static_cast<std::uint32_t>(sizeof(TriangleEmitter) / sizeof(float));
      const WideUInt chosen = WideUInt::load(light_.emitter) * row;
      const SampledLight<Wide> s = sample_triangles(
          [&](int k) { return gather(scene_.emitters + k, chosen, triangles); }, position, {Wide::load(light_.u), v});
      light.wi = select<Wide>(triangles, s.wi, light.wi);
      light.position = select<Wide>(triangles, s.position, light.position);
      light.end = select(triangles, s.end, light.end);
      light.radiance = select<Wide>(triangles, s.radiance, light.radiance);
      light.pdf = select(triangles, s.pdf, light.pdf);
      light.ng = select<Wide>(triangles, s.ng, light.ng);
    }
    return light;
  }

  /// With which a tree chooses the emitters hit, for receivers at p.
  [[gnu::noinline]] Wide probabilities(WideMask lanes, const HitLanes& hits, const WideVec3& p,
                                       const WideVec3& ng) const {
    alignas(64) float probability[kMostLanes] = {};
    VectorLanes from, normal;
    store3(p, from);
    store3(ng, normal);
    for_each(lanes.bits(), [&](int i) {
      probability[i] = light_probability<Wide>(scene_.light_tree, receiver(from, normal, i),
                                               scene_.lights.tree().place(hits.geometry[i], hits.primitive[i]));
    });
    return Wide::load(probability);
  }

 private:
  static Receiver receiver(const VectorLanes& p, const VectorLanes& ng, int i) { return {lane(p, i), lane(ng, i)}; }

  /// From emitters that a tree chooses, lane by lane.
  SampledLight<Wide> sample_tree(WideMask lanes, const std::uint32_t* select_high, const std::uint32_t* select_low,
                                 const Wide& v, const float* v_lanes, const WideVec3& position, const VectorLanes& p,
                                 const WideVec3& ng) {
    VectorLanes normal;
    store3(ng, normal);
    LightChoice choice[kMostLanes];
    std::uint32_t choosing = 0;
    for_each(lanes.bits(), [&](int i) {
      const std::uint64_t number = static_cast<std::uint64_t>(select_high[i]) << 32 | select_low[i];
      if (begin_choice(scene_.light_tree, number, choice[i])) choosing |= 1u << i;
    });
    while (choosing != 0) {
      for_each(choosing, [&](int i) {
        if (!choose_child<Wide>(scene_.light_tree, receiver(p, normal, i), choice[i])) choosing &= ~(1u << i);
      });
    }
    for_each(lanes.bits(), [&](int i) {
      light_.emitter[i] = choice[i].at;
      light_.u[i] = choice[i].u();
      light_.probability[i] = static_cast<float>(choice[i].probability);
    });
    scene_.lights.fetch(lanes.bits(), v_lanes, {p[0], p[1], p[2]}, light_);
    SampledLight<Wide> light{load3(light_.wi),       load3(light_.position), load3(light_.radiance),
                             Wide::load(light_.end), Wide::load(light_.pdf), WideMask::of(light_.infinite),
                             load3(light_.ng)};
    const auto take = [&](WideMask which, const EmitterSample<Wide>& s) {
      light.wi = select<Wide>(which, s.wi, light.wi);
      light.position = select<Wide>(which, s.position, light.position);
      light.end = select(which, s.end, light.end);
      light.pdf = select(which, s.pdf, light.pdf);
      light.ng = select<Wide>(which, s.ng, light.ng);
    };
    const auto& c = light_.corner;
    const WideVec3 first = load3(c[0], c[1], c[2]);
    const Wide probability = Wide::load(light_.probability);
    const WideVec2 u{Wide::load(light_.u), v};
    const WideMask triangles = WideMask::of(light_.triangles), spheres = WideMask::of(light_.spheres);
    if (any(triangles)) {
      take(triangles, sample_triangle<Wide>(triangles, first, load3(c[3], c[4], c[5]), load3(c[6], c[7], c[8]),
                                            probability, position, u));
    }
    if (any(spheres)) take(spheres, sample_sphere_outside<Wide>(first, Wide::load(c[3]), probability, position, u));
    return light;
  }

  /// From the numbers of TriangleEmitter as far as the radiance, given by column.
  template <class Column>
  static SampledLight<Wide> sample_triangles(const Column& column, const WideVec3& position, const WideVec2& u) {
    const auto three = [&](int k) { return WideVec3(column(k), column(k + 1), column(k + 2)); };
    const EmittingTriangle<Wide> emitter{three(0), three(3), three(6), three(9), column(12), column(13)};
    const EmitterSample<Wide> s = sample_triangle<Wide>(emitter, position, u);
    return {s.wi, s.position, three(14), s.end, s.pdf, WideMask::of(0), s.ng};
  }

  const ShadingScene& scene_;
  LightLanes light_{};
};

}  // namespace
}  // namespace raylab
