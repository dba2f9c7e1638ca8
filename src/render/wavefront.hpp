#pragma once
// The path tracing loop, compiled once for each instruction set. All of it is local to the including file. It calls no
// inline function on plain floats: one could end up in the program as compiled for the newer processor.
#include <cstddef>

#include "raylab/core/frame.hpp"
#include "raylab/core/wide.hpp"
#include "raylab/render/bsdf.hpp"
#include "shading_scene.hpp"

namespace raylab {
namespace {

/// Draws of one path segment, from Integrator::kFirstDimension on.
enum Draw : std::uint32_t { kDirection, kLobe, kLightPoint, kLightChoice, kRoulette, kDrawsPerSegment };

/// t_min of the One Weekend books.
constexpr float kBookOffset = 0.001f;

/// Power heuristic for one sample of each strategy (Veach 1997, §9.2).
Wide mis_weight(Wide pdf, Wide other_pdf) {
  const Wide a = pdf * pdf;
  const Wide b = other_pdf * other_pdf;
  // Densities whose square overflows are delta-like: they take all of the weight.
  return select(a == Wide(kInfinity), Wide(1.0f), select(a > Wide(0.0f), a / (a + b), Wide(0.0f)));
}

WideMask is_black(const WideVec3& c) { return (c.x == Wide(0.0f)) & (c.y == Wide(0.0f)) & (c.z == Wide(0.0f)); }

/// Vectors are stored whole, so every array has room for one more.
constexpr std::size_t kRoom = PathBatch::kMost + kLanes;
using Floats = float[kRoom];
using UInts = std::uint32_t[kRoom];

WideVec3 load3(const Floats (&a)[3], std::size_t i) { return WideVec3::load(a[0] + i, a[1] + i, a[2] + i); }
WideVec3 load3(const VectorLanes& a) { return WideVec3::load(a[0], a[1], a[2]); }
void store3(const WideVec3& v, VectorLanes& a) {
  v.x.store(a[0]);
  v.y.store(a[1]);
  v.z.store(a[2]);
}
void pack3(const WideVec3& v, WideMask m, Floats (&a)[3], std::size_t i) {
  store_packed(v.x, m, a[0] + i);
  store_packed(v.y, m, a[1] + i);
  store_packed(v.z, m, a[2] + i);
}

/// The paths of a batch that still go on, side by side.
struct alignas(64) PathState {
  Floats origin[3], direction[3], t_min, t_max;
  Floats throughput[3];
  Floats eta_scale;            ///< undoes the radiance scaling of refraction: roulette sees the path's power
  Floats scatter_pdf;          ///< density of the last direction; 0: light sampling could not have found it
  Floats scatter_position[3];
  UInts seed_low, seed_high, sample;
  UInts slot;  ///< in the batch
};

/// Shadow rays, and what arrives where nothing is in between.
struct alignas(64) ShadowState {
  Floats origin[3], direction[3], t_min, t_max;
  Floats radiance[3];
  UInts slot;
  std::uint8_t occluded[kRoom];
};

class Wavefront {
 public:
  Wavefront(const ShadingScene& shading, const PathBatch& paths, BatchRadiance& radiance)
      : shading_(shading),
        sampler_kind_(paths.sampler),
        book_offset_(shading.settings.ray_offset == RayOffset::book),
        radiance_(radiance) {
    start(paths);
  }

  void run(RayCounts& counts) {
    counts.camera += count_;
    for (int segment = 1; count_ != 0; ++segment) {
      if (segment > 1) counts.scattered += count_;
      shading_.accelerator.intersect_batch(rays(paths_, count_), {hit_t_, hit_u_, hit_v_, hit_geometry_, hit_primitive_});
      kept_ = 0;
      shadows_ = 0;
      for (std::size_t first = 0; first < count_; first += kLanes) shade(first, segment);
      count_ = kept_;
      counts.shadow += shadows_;
      light();
    }
  }

 private:
  template <class State>
  static RayBatch rays(const State& s, std::size_t count) {
    return {count, {s.origin[0], s.origin[1], s.origin[2]}, {s.direction[0], s.direction[1], s.direction[2]}, s.t_min,
            s.t_max};
  }

  void start(const PathBatch& paths) {
    count_ = paths.count;
    for (std::size_t c = 0; c < 3; ++c) __builtin_memset(radiance_[c].data(), 0, count_ * sizeof(float));
    for (std::size_t i = 0; i < count_; i += kLanes) {
      const WideUInt seed_low = WideUInt::load(paths.seed_low.data() + i);
      const WideUInt seed_high = WideUInt::load(paths.seed_high.data() + i);
      const WideUInt sample = WideUInt::load(paths.sample.data() + i);
      const BasicSampler<Wide> sampler(sampler_kind_, seed_low, seed_high, sample);
      const WideVec2 jitter = sampler.get2(Integrator::kPixelDimension);
      WideVec2 lens{0.5f, 0.5f};
      if (shading_.needs.lens) lens = sampler.get2(Integrator::kLensDimension);
      WideVec3 origin, direction;
      shading_.camera.ray<Wide>(Wide::load(paths.x.data() + i) + jitter.x, Wide::load(paths.y.data() + i) + jitter.y,
                                lens, origin, direction);
      direction = direction * (Wide(1.0f) / square_root(dot(direction, direction)));  // unit from here on
      const WideMask all = first_lanes(kLanes);
      pack3(origin, all, paths_.origin, i);
      pack3(direction, all, paths_.direction, i);
      pack3(WideVec3(Wide(1.0f)), all, paths_.throughput, i);
      pack3(origin, all, paths_.scatter_position, i);
      Wide(1.0f).store(paths_.eta_scale + i);
      Wide(0.0f).store(paths_.scatter_pdf + i);
      Wide(0.0f).store(paths_.t_min + i);
      Wide(kInfinity).store(paths_.t_max + i);
      seed_low.store(paths_.seed_low + i);
      seed_high.store(paths_.seed_high + i);
      sample.store(paths_.sample + i);
      for (std::size_t k = i; k < i + kLanes; ++k) paths_.slot[k] = static_cast<std::uint32_t>(k);
    }
  }

  void add_radiance(WideMask lanes, std::size_t first, const WideVec3& value) {
    VectorLanes v;
    store3(value, v);
    for (std::uint32_t bits = lanes.bits(); bits != 0; bits &= bits - 1) {
      const int i = __builtin_ctz(bits);
      const std::uint32_t slot = paths_.slot[first + static_cast<std::size_t>(i)];
      for (std::size_t c = 0; c < 3; ++c) radiance_[c].data()[slot] += v[c][i];
    }
  }

  /// Rays that have left the scene.
  void shade_misses(WideMask lanes, std::size_t first, const WideVec3& throughput) {
    const Environment& environment = shading_.scene.environment;
    const WideVec3 direction = load3(paths_.direction, first);
    WideVec3 arriving(environment.bottom);
    if (environment.kind == Environment::Kind::image || (shading_.sample_lights && shading_.needs.environment_sampling)) {
      VectorLanes d, r;
      alignas(64) float pdf[kMostLanes];
      store3(direction, d);
      shading_.environment(lanes.bits(), d, r, pdf);
      arriving = load3(r);
      if (shading_.sample_lights) {
        const Wide scatter_pdf = Wide::load(paths_.scatter_pdf + first);
        const Wide weight = mis_weight(scatter_pdf, Wide::load(pdf));
        arriving *= WideVec3(select(scatter_pdf > Wide(0.0f), weight, Wide(1.0f)));
      }
    } else if (environment.kind == Environment::Kind::gradient) {
      const Wide a = Wide(0.5f) * (direction.y + Wide(1.0f));
      arriving = (Wide(1.0f) - a) * WideVec3(environment.bottom) + a * WideVec3(environment.top);
    }
    add_radiance(lanes, first, throughput * arriving);
  }

  /// Rays that have met an emitter, where their paths end.
  void shade_lights(WideMask lanes, std::size_t first, const HitLanes& hits, Wide pdf_area,
                    const BasicSurfacePoint<Wide>& point, const WideVec3& throughput, const WideVec3& radiance) {
    Wide weight(1.0f);
    if (shading_.sample_lights) {
      const Wide scatter_pdf = Wide::load(paths_.scatter_pdf + first);
      const WideVec3 scatter_position = load3(paths_.scatter_position, first);
      const WideVec3 wi = load3(paths_.direction, first);
      Wide pdf = triangle_pdf<Wide>(pdf_area, scatter_position, point.position, point.ng, wi);
      const WideMask spheres = lanes & WideMask::of(surfaces_.spheres);
      if (any(spheres)) {
        VectorLanes p, position, direction;
        alignas(64) float sphere_pdf[kMostLanes];
        store3(scatter_position, p);
        store3(point.position, position);
        store3(wi, direction);
        shading_.sphere_light_pdfs(spheres.bits(), hits, p, position, direction, sphere_pdf);
        pdf = select(spheres, Wide::load(sphere_pdf), pdf);
      }
      weight = select(scatter_pdf > Wide(0.0f), mis_weight(scatter_pdf, pdf), Wide(1.0f));
    }
    add_radiance(lanes, first, throughput * radiance * weight);
  }

  /// Shadow rays towards one point of one light for each lane.
  void sample_lights(WideMask lanes, std::size_t first, const BasicSampler<Wide>& sampler, std::uint32_t draws,
                     const BasicSurfacePoint<Wide>& point, const WideVec3& ng, const BasicFrame<Wide>& frame,
                     WideMask bent, const MaterialLanes<Wide>& material, const WideVec3& color, const WideVec3& wo_local,
                     const WideVec3& throughput) {
    const WideVec2 u = sampler.get2(draws + kLightPoint);
    const LightTable& few = shading_.light_table;
    WideMask triangles = lanes;
    light_.infinite = 0;
    if (few.count == 0) {
      alignas(64) std::uint32_t choice_high[kMostLanes], choice_low[kMostLanes];
      alignas(64) float u_x[kMostLanes], u_y[kMostLanes];
      VectorLanes p;
      const auto choice = sampler.bits2(draws + kLightChoice);
      choice.first.store(choice_high);
      choice.second.store(choice_low);
      u.x.store(u_x);
      u.y.store(u_y);
      store3(point.position, p);
      shading_.lights.sample(lanes.bits(), choice_high, choice_low, u_x, u_y, {p[0], p[1], p[2]}, light_);
      triangles = WideMask::of(light_.triangles);
    }
    WideVec3 wi, target, radiance;
    Wide pdf;
    if (any(triangles)) {
      WideUInt chosen(0u);
      const float* const table = shading_.emitters;
      if (few.count != 0) {
        const Wide choice = sampler.get1(draws + kLightChoice);
        for (int i = 0; i < few.count - 1; ++i)
          chosen += select(Wide(few.cdf[i]) <= choice, WideUInt(1u), WideUInt(0u));
      } else {
        chosen = WideUInt::load(light_.emitter) * static_cast<std::uint32_t>(sizeof(TriangleEmitter) / sizeof(float));
      }
      const auto column = [&](int k) {
        return few.count != 0 ? look_up16(few.columns[k], chosen) : gather(table + k, chosen, triangles);
      };
      const auto column3 = [&](int k) { return WideVec3(column(k), column(k + 1), column(k + 2)); };
      const EmittingTriangle<Wide> emitter{column3(0), column3(3), column3(6), column3(9), column(12), column(13)};
      radiance = column3(14);
      const TriangleLightSample<Wide> s = sample_triangle<Wide>(emitter, point.position, u);
      wi = s.wi;
      target = s.target;
      pdf = s.pdf;
    }
    if (any(lanes & !triangles)) {
      wi = select(triangles, wi, load3(light_.wi));
      radiance = select(triangles, radiance, load3(light_.radiance));
      target = select(triangles, target, load3(light_.target));
      pdf = select(triangles, pdf, Wide::load(light_.pdf));
    }
    WideMask usable = lanes & (pdf > Wide(0.0f)) & (dot(wi, ng) > Wide(0.0f));
    if (!any(usable)) return;
    const WideVec3 wi_local = frame.to_local(wi);
    BasicBsdfValue<Wide> f = eval_bsdf<Wide>(material, color, wo_local, wi_local);
    if (any(bent)) {
      const BasicBsdfValue<Wide> above = eval_bsdf_above<Wide>(material, color, wo_local, wi_local, frame.to_local(ng));
      f.value = select(bent, above.value, f.value);
      f.pdf = select(bent, above.pdf, f.pdf);
    }
    usable = usable & (f.pdf > Wide(0.0f));
    if (!any(usable)) return;
    const WideVec3 start = book_offset_ ? point.position : offset_origin<Wide>(point, wi);
    const WideMask infinite = WideMask::of(light_.infinite);
    const WideVec3 direction = select(infinite, wi, target - start);
    const WideVec3 arriving = throughput * f.value * radiance * (mis_weight(pdf, f.pdf) / pdf);
    pack3(start, usable, shadow_.origin, shadows_);
    pack3(direction, usable, shadow_.direction, shadows_);
    store_packed(Wide(0.0f), usable, shadow_.t_min + shadows_);
    store_packed(select(infinite, Wide(kInfinity), Wide(kShadowEnd)), usable, shadow_.t_max + shadows_);
    pack3(arriving, usable, shadow_.radiance, shadows_);
    store_packed(WideUInt::load(paths_.slot + first), usable, shadow_.slot + shadows_);
    shadows_ += static_cast<std::size_t>(__builtin_popcount(usable.bits()));
  }

  /// One segment of the paths [first, first + kLanes).
  void shade(std::size_t first, int segment) {
    const WideUInt seed_low = WideUInt::load(paths_.seed_low + first);
    const WideUInt seed_high = WideUInt::load(paths_.seed_high + first);
    const WideUInt sample = WideUInt::load(paths_.sample + first);
    const BasicSampler<Wide> sampler(sampler_kind_, seed_low, seed_high, sample);
    const std::uint32_t draws =
        Integrator::kFirstDimension + static_cast<std::uint32_t>(segment - 1) * kDrawsPerSegment;
    // A long chain of operations that needs nothing of the hit: begun first, the processor does it beside the others.
    const WideVec2 u = sampler.get2(draws + kDirection);
    const WideMask valid = first_lanes(count_ - first);
    const HitLanes hits{hit_u_ + first, hit_v_ + first, hit_geometry_ + first, hit_primitive_ + first};
    shading_.fetch_surfaces(hits, __builtin_popcount(valid.bits()), surfaces_);
    const WideUInt material_id = WideUInt::load(surfaces_.material);
    const auto column = [&](int k) {
      return shading_.few_materials ? look_up16(shading_.material_columns[k], material_id)
                                    : gather(shading_.material_rows + k, material_id * kMaterialColumns, valid);
    };
    MaterialLanes<Wide> material{column(0), column(1), column(2)};
    WideVec3 throughput = load3(paths_.throughput, first);
    const WideMask missed = valid & (material.kind == Wide(kMissKind));
    if (any(missed)) shade_misses(missed, first, throughput);
    const WideMask hit = valid & !missed;
    if (!any(hit)) return;

    const WideVec3 direction = load3(paths_.direction, first);
    BasicSurfacePoint<Wide> point;
    const auto& c = surfaces_.corner;
    const WideVec3 p0 = WideVec3::load(c[0], c[1], c[2]);
    place_on_triangle<Wide>(p0, WideVec3::load(c[3], c[4], c[5]), WideVec3::load(c[6], c[7], c[8]),
                            Wide::load(hits.u), Wide::load(hits.v), point);
    if (surfaces_.spheres != 0) {
      const WideMask spheres = WideMask::of(surfaces_.spheres);
      BasicSurfacePoint<Wide> on_sphere;
      place_on_sphere<Wide>(p0, Wide::load(c[3]), load3(paths_.origin, first) + Wide::load(hit_t_ + first) * direction,
                            on_sphere);
      point.position = select(spheres, on_sphere.position, point.position);
      point.ng = select(spheres, on_sphere.ng, point.ng);
      point.offset = select(spheres, on_sphere.offset, point.offset);
    }
    if (surfaces_.varying != 0) {
      VectorLanes position, normal;
      store3(point.position, position);
      store3(point.ng, normal);
      shading_.look_up_colors(hits, position, normal, surfaces_);
    }
    WideVec3 color(column(4), column(5), column(6));
    if (surfaces_.varying != 0) color = select(WideMask::of(surfaces_.varying), load3(surfaces_.color), color);
    const WideMask lights = hit & material.is(Material::Kind::diffuse_light);
    if (any(lights)) shade_lights(lights, first, hits, column(3), point, throughput, color);
    WideMask alive = hit & !lights;
    if (segment >= shading_.settings.max_depth || !any(alive)) return;

    // The shading frame on wo's side. Where interpolation turns the shading normal away from wo, the geometric one
    // takes its place: a surface is seen from the side it is on.
    const WideVec3 wo = -direction;
    const WideMask inside = dot(wo, point.ng) < Wide(0.0f);
    const WideVec3 ng = select(inside, -point.ng, point.ng);
    WideVec3 ns = ng;
    WideMask bent{};
    if (shading_.needs.shading_normals) {
      const WideVec3 smooth = shading_normal<Wide>(load3(surfaces_.normal_sum), ng);
      ns = select((dot(wo, smooth) > Wide(0.0f)) & !WideMask::of(surfaces_.spheres), smooth, ng);
      bent = alive & ((ns.x != ng.x) | (ns.y != ng.y) | (ns.z != ng.z));
    }
    const BasicFrame<Wide> frame(ns);
    const WideVec3 wo_local = frame.to_local(wo);
    if (shading_.sample_lights) {
      const WideMask lit = alive & has_density(material);
      if (any(lit)) {
        sample_lights(lit, first, sampler, draws, point, ng, frame, bent, material, color, wo_local, throughput);
      }
    }

    Wide lobe(0.0f);
    if (any(alive & material.is(Material::Kind::dielectric))) lobe = sampler.get1(draws + kLobe);
    BasicBsdfSample<Wide> scattered = sample_bsdf<Wide>(material, color, wo_local, inside, u, lobe);
    if (any(bent)) {
      const BasicBsdfSample<Wide> above =
          sample_bsdf_above<Wide>(material, color, wo_local, frame.to_local(ng), inside, u, lobe);
      scattered.wi = select(bent, above.wi, scattered.wi);
      scattered.pdf = select(bent, above.pdf, scattered.pdf);
    }
    alive = alive & !is_black(scattered.weight);
    const WideVec3 wi = frame.to_world(scattered.wi);
    throughput *= scattered.weight;
    const Wide eta_scale = Wide::load(paths_.eta_scale + first) * scattered.eta_squared;
    const Wide scatter_pdf = select(scattered.delta, Wide(0.0f), scattered.pdf);
    if (segment >= Integrator::kFirstRouletteSegment && shading_.settings.kind == IntegratorKind::path) {
      const Wide survival =
          lesser(greater(throughput.x, greater(throughput.y, throughput.z)) * eta_scale, Wide(1.0f));
      alive = alive & (sampler.get1(draws + kRoulette) < survival);
      throughput = throughput / survival;
    }
    if (!any(alive)) return;
    const WideVec3 start = book_offset_ ? point.position : offset_origin<Wide>(point, wi);
    const WideUInt slot = WideUInt::load(paths_.slot + first);
    pack3(start, alive, paths_.origin, kept_);
    pack3(wi, alive, paths_.direction, kept_);
    pack3(throughput, alive, paths_.throughput, kept_);
    pack3(point.position, alive, paths_.scatter_position, kept_);
    store_packed(eta_scale, alive, paths_.eta_scale + kept_);
    store_packed(scatter_pdf, alive, paths_.scatter_pdf + kept_);
    store_packed(seed_low, alive, paths_.seed_low + kept_);
    store_packed(seed_high, alive, paths_.seed_high + kept_);
    store_packed(sample, alive, paths_.sample + kept_);
    store_packed(slot, alive, paths_.slot + kept_);
    if (book_offset_) store_packed(Wide(kBookOffset), alive, paths_.t_min + kept_);
    kept_ += static_cast<std::size_t>(__builtin_popcount(alive.bits()));
  }

  /// What the shadow rays let through.
  void light() {
    if (shadows_ == 0) return;
    shading_.accelerator.occluded_batch(rays(shadow_, shadows_), shadow_.occluded);
    for (std::size_t i = 0; i < shadows_; ++i) {
      if (shadow_.occluded[i] != 0) continue;
      for (std::size_t c = 0; c < 3; ++c) radiance_[c].data()[shadow_.slot[i]] += shadow_.radiance[c][i];
    }
  }

  const ShadingScene& shading_;
  SamplerKind sampler_kind_;
  bool book_offset_;
  BatchRadiance& radiance_;
  std::size_t count_ = 0, kept_ = 0, shadows_ = 0;
  PathState paths_;
  ShadowState shadow_;
  alignas(64) Floats hit_t_, hit_u_, hit_v_;
  UInts hit_geometry_, hit_primitive_;
  SurfaceLanes surfaces_{};
  LightLanes light_{};
};

void trace(const ShadingScene& shading, const PathBatch& paths, BatchRadiance& radiance, RayCounts& counts) {
  Wavefront(shading, paths, radiance).run(counts);
}

}  // namespace
}  // namespace raylab
