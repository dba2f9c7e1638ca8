#pragma once
// The path tracing loop over many paths at a time, compiled once for each instruction set: see core/simd/lanes.hpp.
// What happens at a vertex stands in path_vertex.hpp; here paths and their data are moved in and out of vectors.
#include <cstddef>

#include "wavefront_lights.hpp"
#include "wavefront_queues.hpp"

namespace raylab {
namespace {

class Wavefront {
 public:
  Wavefront(const ShadingScene& scene, const PathBatch& paths, BatchRadiance& radiance)
      : scene_(scene),
        lights_(scene),
        sampler_kind_(paths.sampler),
        offset_(scene.settings.ray_offset),
        radiance_(radiance) {
    start(paths);
  }

  void run(RayCounts& counts) {
    counts.camera += count_;
    for (int segment = 1; count_ != 0; ++segment) {
      if (segment > 1) counts.scattered += count_;
      scene_.accelerator.intersect_batch(rays(paths_, count_), {hit_t_, hit_u_, hit_v_, hit_geometry_, hit_primitive_});
      kept_ = 0;
      shadows_ = 0;
      mirrored_ = 0;
      over_spheres_ = 0;
      for (std::size_t first = 0; first < count_; first += kLanes) shade(first, segment);
      count_ = kept_;
      counts.shadow += shadows_;
      trace_shadow_rays(shadow_, shadows_);
      if (mirrored_ != 0) trace_mirrored_rays(counts);
      if (over_spheres_ != 0) trace_rays_over_spheres(counts);
    }
  }

 private:
  template <class Queue>
  static RayBatch rays(const Queue& s, std::size_t count) {
    return {count,
            {s.origin[0], s.origin[1], s.origin[2]},
            {s.direction[0], s.direction[1], s.direction[2]},
            s.t_min,
            s.t_max};
  }

  BasicSampler<Wide> sampler_of(std::size_t first) const {
    return {sampler_kind_, WideUInt::load(paths_.seed_low + first), WideUInt::load(paths_.seed_high + first),
            WideUInt::load(paths_.sample + first)};
  }

  void start(const PathBatch& paths) {
    count_ = paths.count;
    for (std::size_t c = 0; c < 3; ++c) __builtin_memset(radiance_[c].data(), 0, count_ * sizeof(float));
    for (std::size_t i = 0; i < count_; i += kLanes) {
      WideUInt::load(paths.seed_low.data() + i).store(paths_.seed_low + i);
      WideUInt::load(paths.seed_high.data() + i).store(paths_.seed_high + i);
      WideUInt::load(paths.sample.data() + i).store(paths_.sample + i);
      paths_.store(camera_path<Wide>(scene_.camera.rays(), sampler_of(i), Wide::load(paths.x.data() + i),
                                     Wide::load(paths.y.data() + i)),
                   i);
      Wide(0.0f).store(paths_.t_min + i);
      Wide(kInfinity).store(paths_.t_max + i);
      for (std::size_t k = i; k < i + kLanes; ++k) paths_.slot[k] = static_cast<std::uint32_t>(k);
      WideUInt(0u).store(paths_.chain + i);
    }
  }

  void add_radiance(WideMask lanes, std::size_t first, const WideVec3& value) {
    VectorLanes v;
    store3(value, v);
    for_each(lanes.bits(), [&](int i) {
      const std::uint32_t slot = paths_.slot[first + static_cast<std::size_t>(i)];
      for (std::size_t c = 0; c < 3; ++c) radiance_[c].data()[slot] += v[c][i];
    });
  }

  /// One segment of the paths [first, first + kLanes), stage by stage.
  void shade(std::size_t first, int segment) {
    const BasicSampler<Wide> sampler = sampler_of(first);
    const std::uint32_t draw = first_draw(segment);
    // This long chain of operations does not need the hit; begun first, it overlaps with the rest.
    const WideVec2 u = sampler.get2(draw + kDirection);
    const WideMask valid = first_lanes(count_ - first);
    const HitLanes hits{hit_u_ + first, hit_v_ + first, hit_geometry_ + first, hit_primitive_ + first};
    scene_.fetch_surfaces(hits, __builtin_popcount(valid.bits()), surfaces_);
    const MaterialColumns column{scene_, WideUInt::load(surfaces_.material), valid};
    const auto material = MaterialLanes<Wide>::of(column);
    PathState<Wide> path = paths_.load(first);

    const WideMask missed = valid & (material.kind == Wide(kMissKind));
    if (any(missed)) escaped_rays(missed, first, path);
    const WideMask hit = valid & !missed;
    if (!any(hit)) return;

    const PointLanes<Wide> point = surface_points(hit, first, hits, path);
    const WideVec3 color = surface_colors(column, hits, point);
    const WideMask lights = hit & material.is(Material::Kind::diffuse_light);
    if (any(lights)) emitters(lights, first, hits, column(kLightPdfColumn), point, path, color);
    const WideMask alive = hit & !lights;
    if (segment >= scene_.settings.max_depth || !any(alive)) return;

    WideVec3 normal_sum;
    if (scene_.needs.shading_normals) normal_sum = load3(surfaces_.normal_sum);
    PathVertex<Wide> vertex =
        path_vertex<Wide>(material, color, point, path.direction, scene_.needs.shading_normals ? &normal_sum : nullptr);
    vertex.smooth = vertex.smooth & alive;
    if (scene_.sample_lights) {
      const WideMask lit = alive & has_density(material);
      if (any(lit)) light_samples(lit, first, sampler, draw, vertex, path);
      if (any(lit) && !scene_.mirrors.empty()) mirrored_light_samples(lit, first, segment, sampler, draw, vertex, path);
      if (any(lit) && !scene_.spheres.empty()) sphere_light_samples(lit, first, segment, sampler, draw, vertex, path);
    }
    go_on(alive, first, segment, sampler, u, vertex, path);
  }

  /// What materials() has of the lanes' materials, by column.
  struct MaterialColumns {
    const ShadingScene& scene;
    WideUInt id;
    WideMask valid;
    Wide operator()(int k) const {
      return scene.few_materials ? look_up16(scene.material_columns[k], id)
                                 : gather(scene.material_rows + k, id * kMaterialColumns, valid);
    }
  };

  /// Flattened: every hit comes here, and what the points of lights have use of too would be called otherwise.
  [[gnu::flatten]] PointLanes<Wide> surface_points(WideMask hit, std::size_t first, const HitLanes& hits,
                                                   const PathState<Wide>& path) const {
    PointLanes<Wide> point{};
    const auto& c = surfaces_.corner;
    const WideVec3 p0 = load3(c[0], c[1], c[2]);
    const Wide t = Wide::load(hit_t_ + first);
    const WideMask spheres = WideMask::of(surfaces_.spheres), triangles = hit & !spheres;
    if (any(triangles)) {
      const WideVec3 p1 = load3(c[3], c[4], c[5]), p2 = load3(c[6], c[7], c[8]);
      place_on_triangle<Wide>(triangles, p0, p1, p2, Wide::load(hits.u), Wide::load(hits.v), point);
      place_on_ray<Wide>(triangles, p0, p1, p2, path.origin, path.direction, t, point);
    }
    if (any(spheres)) {
      PointLanes<Wide> on_sphere;
      place_on_sphere<Wide>(p0, Wide::load(c[3]), path.origin, path.direction, t, on_sphere);
      point.position = select<Wide>(spheres, on_sphere.position, point.position);
      point.ng = select<Wide>(spheres, on_sphere.ng, point.ng);
      point.offset = select(spheres, on_sphere.offset, point.offset);
    }
    return point;
  }

  WideVec3 surface_colors(const MaterialColumns& column, const HitLanes& hits, const PointLanes<Wide>& point) {
    const WideVec3 color(column(kColorColumn), column(kColorColumn + 1), column(kColorColumn + 2));
    if (surfaces_.varying == 0) return color;
    VectorLanes position, normal;
    store3(point.position, position);
    store3(point.ng, normal);
    scene_.look_up_colors(hits, position, normal, surfaces_);
    return select<Wide>(WideMask::of(surfaces_.varying), load3(surfaces_.color), color);
  }

  /// Rays that have left the scene, where their paths end.
  void escaped_rays(WideMask lanes, std::size_t first, const PathState<Wide>& path) {
    const Environment& environment = scene_.scene.environment;
    WideVec3 arriving(environment.bottom);
    if (environment.kind == Environment::Kind::image || (scene_.sample_lights && scene_.needs.environment_sampling)) {
      VectorLanes d, r;
      alignas(64) float pdf[kMostLanes];
      store3(path.direction, d);
      scene_.environment(lanes.bits(), d, r, pdf);
      arriving = load3(r);
      if (scene_.sample_lights) {
        Wide density = Wide::load(pdf);
        if (scene_.has_chains()) {
          VectorLanes from;
          store3(path.scatter_position, from);
          density = density * chain_shares(lanes, first, path, d, d, true, from, d);
        }
        arriving = arriving * met_light_weight(path, density);
      }
    } else if (environment.kind == Environment::Kind::gradient) {
      const Wide a = Wide(0.5f) * (path.direction.y + Wide(1.0f));
      arriving = (Wide(1.0f) - a) * WideVec3(environment.bottom) + a * WideVec3(environment.top);
    }
    add_radiance(lanes, first, path.throughput * arriving);
  }

  /// Rays that have met an emitter, where their paths end.
  void emitters(WideMask lanes, std::size_t first, const HitLanes& hits, Wide pdf_area, const PointLanes<Wide>& point,
                const PathState<Wide>& path, const WideVec3& radiance) {
    Wide weight(1.0f);
    if (scene_.sample_lights) {
      WideVec3 from = path.scatter_position, wi = path.direction;
      Wide share(1.0f);
      VectorLanes p, position, direction;
      const WideMask spheres = lanes & WideMask::of(surfaces_.spheres);
      const bool chains = scene_.has_chains() && are_over_chains(lanes, first);
      if (chains || any(spheres)) {
        store3(from, p);
        store3(point.position, position);
        store3(wi, direction);
      }
      if (chains) {
        VectorLanes ng;
        store3(point.ng, ng);
        share = chain_shares(lanes, first, path, position, ng, false, p, direction);
        from = load3(p);
        wi = load3(direction);
      }
      Wide probability(1.0f);
      if (scene_.light_tree.nodes != nullptr) {
        probability =
            lights_.probabilities(lanes & (path.scatter_pdf > Wide(0.0f)), hits, from, load3(paths_.scatter_ng, first));
        const auto& c = surfaces_.corner;
        pdf_area =
            triangle_pdf_area(probability, load3(c[0], c[1], c[2]), load3(c[3], c[4], c[5]), load3(c[6], c[7], c[8]));
      }
      Wide pdf = triangle_pdf<Wide>(pdf_area, from, point.position, point.ng, wi);
      if (any(spheres)) {
        alignas(64) float sphere_pdf[kMostLanes];
        scene_.sphere_light_pdfs(spheres.bits(), hits, p, position, direction, sphere_pdf);
        pdf = select(spheres, probability * Wide::load(sphere_pdf), pdf);
      }
      if (chains) pdf = pdf * share;
      weight = met_light_weight(path, pdf);
    }
    add_radiance(lanes, first, path.throughput * radiance * weight);
  }

  /// ShadingScene::chain_share for the lanes.
  Wide chain_shares(WideMask lanes, std::size_t first, const PathState<Wide>& path, const VectorLanes& light,
                    const VectorLanes& ng, bool infinite, VectorLanes& from, VectorLanes& direction) const {
    alignas(64) float share[kMostLanes];
    VectorLanes origin;
    store3(path.origin, origin);
    for (int i = 0; i < kLanes; ++i) {
      share[i] = 1.0f;
      const ChainId chain = paths_.chain[first + static_cast<std::size_t>(i)];
      if ((lanes.bits() >> i & 1u) == 0 || chain == 0) continue;
      vec3 p = lane(from, i), wi = lane(direction, i);
      share[i] = scene_.chain_share(chain, p, lane(origin, i), wi, lane(light, i), lane(ng, i), infinite);
      for (int c = 0; c < 3; ++c) {
        from[c][i] = p[c];
        direction[c][i] = wi[c];
      }
    }
    return Wide::load(share);
  }
  bool are_over_chains(WideMask lanes, std::size_t first) const {
    ChainId chains = 0;
    for_each(lanes.bits(), [&](int i) { chains |= paths_.chain[first + static_cast<std::size_t>(i)]; });
    return chains != 0;
  }

  /// Shadow rays towards one point of one light for each lane.
  [[gnu::noinline]] void light_samples(WideMask lanes, std::size_t first, const BasicSampler<Wide>& sampler,
                                       std::uint32_t draw, const PathVertex<Wide>& vertex,
                                       const PathState<Wide>& path) {
    const ShadowRay<Wide> ray = shadow_ray(
        vertex, path,
        lights_.sample(lanes, sampler, draw + kLightPoint, draw + kLightChoice, vertex.point.position, vertex.ng),
        offset_);
    const WideMask usable = lanes & ray.usable;
    if (!any(usable)) return;
    put(usable, first, ray, shadow_, shadows_);
    shadows_ += static_cast<std::size_t>(__builtin_popcount(usable.bits()));
  }

  /// The same over chains of mirrors.
  [[gnu::noinline]] void mirrored_light_samples(WideMask lanes, std::size_t first, int segment,
                                                const BasicSampler<Wide>& sampler, std::uint32_t draw,
                                                const PathVertex<Wide>& vertex, const PathState<Wide>& path) {
    const auto bits = sampler.bits2(draw + kMirrorPoint);
    const auto choices = sampler.bits2(draw + kMirrorChoice);
    alignas(64) float choice[kMostLanes], v[kMostLanes], pdf[kMostLanes];
    alignas(64) std::uint32_t high[kMostLanes], low[kMostLanes];
    VectorLanes p, wi, image, radiance;
    MirroredLight lights[kMostLanes];
    bits_to_unit(choices.first).store(choice);
    bits.first.store(high);
    choices.second.store(low);
    bits_to_unit(bits.second).store(v);
    store3(vertex.point.position, p);
    for (int i = 0; i < kLanes; ++i) {
      if ((lanes.bits() >> i & 1u) != 0) {
        lights[i] = scene_.mirrors.sample({p[0][i], p[1][i], p[2][i]}, choice[i],
                                          static_cast<std::uint64_t>(high[i]) << 32 | low[i], v[i],
                                          scene_.settings.max_depth - segment - 1);
      }
      for (int c = 0; c < 3; ++c) {
        wi[c][i] = lights[i].wi[c];
        image[c][i] = lights[i].image[c];
        radiance[c][i] = lights[i].radiance[c];
      }
      pdf[i] = lights[i].pdf;
    }
    const ShadowRay<Wide> ray = shadow_ray<Wide>(
        vertex, path, {load3(wi), load3(image), load3(radiance), Wide(1.0f), Wide::load(pdf), WideMask::of(0)},
        offset_);
    const WideMask usable = lanes & ray.usable;
    if (!any(usable)) return;
    VectorLanes origin, direction;
    alignas(64) float t_min[kMostLanes];
    store3(ray.origin, origin);
    store3(ray.direction, direction);
    store3(ray.radiance, radiance);
    ray.t_min.store(t_min);
    for_each(usable.bits(), [&](int i) {
      mirror_.put(mirrored_++,
                  {{lane(origin, i), lane(direction, i), t_min[i]},
                   lights[i].light,
                   lights[i].gap,
                   lane(radiance, i),
                   lights[i].chain,
                   0},
                  paths_.slot[first + static_cast<std::size_t>(i)]);
    });
  }

  /// The same over spheres.
  [[gnu::noinline]] void sphere_light_samples(WideMask lanes, std::size_t first, int segment,
                                              const BasicSampler<Wide>& sampler, std::uint32_t draw,
                                              const PathVertex<Wide>& vertex, const PathState<Wide>& path) {
    const SphereChainTable& table = scene_.spheres.table();
    const WideVec3& p = vertex.point.position;
    const ChosenChain<Wide> chosen = choose_chain<Wide>(
        table.count, [&](int k, int row) { return table.columns[k][row]; }, p,
        bits_to_unit(sampler.bits2(draw + kSphereChoice).second));
    const auto column = [&](int k) { return look_up16(table.columns[k], chosen.row); };
    const SphereChain<Wide> chain = sphere_chain<Wide>(column);
    lanes = lanes & (chain.crossings <= Wide(static_cast<float>(scene_.settings.max_depth - segment - 2)));
    if (!any(lanes)) return;
    const SampledLight<Wide> light =
        lights_.sample(lanes, sampler, draw + kSpherePoint, draw + kSphereChoice, chain.center, WideVec3(Wide(0.0f)));
    const LightOverSphere<Wide> over = light_over_sphere<Wide>(chain, chosen, p, light);
    const ShadowRay<Wide> to_sphere = shadow_ray<Wide>(
        vertex, path, {over.wi, light.position, light.radiance, Wide(kInfinity), over.pdf, WideMask::of(~0u)}, offset_);
    const WideMask usable = lanes & to_sphere.usable;
    if (!any(usable)) return;
    const SphereRays<Wide> way = sphere_rays<Wide>(chain, over, light, to_sphere.origin);
    const WideVec3 radiance = to_sphere.radiance * WideVec3(column(7), column(8), column(9));
    put(usable, first, {to_sphere.origin, way.first_direction, to_sphere.t_min, way.first_end, radiance, usable},
        sphere_.first, over_spheres_);
    put(usable, first, {way.origin, way.direction, Wide(0.0f), way.end, radiance, usable}, sphere_.last, over_spheres_);
    over_spheres_ += static_cast<std::size_t>(__builtin_popcount(usable.bits()));
  }

  void put(WideMask lanes, std::size_t first, const ShadowRay<Wide>& ray, ShadowQueue& to, std::size_t at) const {
    compress3(ray.origin, lanes, to.origin, at);
    compress3(ray.direction, lanes, to.direction, at);
    compress(ray.t_min, lanes, to.t_min + at);
    compress(ray.t_max, lanes, to.t_max + at);
    compress3(ray.radiance, lanes, to.radiance, at);
    compress(WideUInt::load(paths_.slot + first), lanes, to.slot + at);
  }

  /// To the spheres, and those that get there on to the lights.
  void trace_rays_over_spheres(RayCounts& counts) {
    counts.shadow += over_spheres_;
    scene_.accelerator.occluded_batch(rays(sphere_.first, over_spheres_), sphere_.first.occluded);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < over_spheres_; ++i) {
      if (sphere_.first.occluded[i] != 0) continue;
      sphere_.last.move(i, kept++);
    }
    counts.shadow += kept;
    trace_shadow_rays(sphere_.last, kept);
  }

  /// From mirror to mirror, and past the last ones to the lights.
  void trace_mirrored_rays(RayCounts& counts) {
    shadows_ = 0;
    while (mirrored_ != 0) {
      counts.shadow += mirrored_;
      scene_.accelerator.intersect_batch(rays(mirror_, mirrored_),
                                         {hit_t_, hit_u_, hit_v_, hit_geometry_, hit_primitive_});
      const std::size_t count = mirrored_;
      mirrored_ = 0;
      for (std::size_t i = 0; i < count; ++i) {
        if (hit_geometry_[i] == HitBatch::kNoHit) continue;
        MirroredRay ray = mirror_.get(i);
        const Hit hit{hit_t_[i], hit_u_[i], hit_v_[i], hit_geometry_[i], hit_primitive_[i]};
        if (!scene_.mirrors.reflect(ray, hit, offset_)) continue;
        if (scene_.mirrors.is_last(ray)) {
          put_shadow_ray(ray, mirror_.slot[i]);
        } else {
          mirror_.put(mirrored_++, ray, mirror_.slot[i]);
        }
      }
    }
    counts.shadow += shadows_;
    trace_shadow_rays(shadow_, shadows_);
  }

  void put_shadow_ray(const MirroredRay& ray, std::uint32_t slot) {
    for (int c = 0; c < 3; ++c) {
      shadow_.origin[c][shadows_] = ray.ray.origin[c];
      shadow_.direction[c][shadows_] = ray.ray.direction[c];
      shadow_.radiance[c][shadows_] = ray.radiance[c];
    }
    shadow_.t_min[shadows_] = ray.ray.t_min;
    shadow_.t_max[shadows_] = ray.ray.t_max;
    shadow_.slot[shadows_++] = slot;
  }

  /// Scatters, and keeps the paths that go on.
  void go_on(WideMask alive, std::size_t first, int segment, const BasicSampler<Wide>& sampler, const WideVec2& u,
             const PathVertex<Wide>& vertex, PathState<Wide>& path) {
    const std::uint32_t draw = first_draw(segment);
    Wide lobe(0.0f);
    if (any(alive & has_lobes(vertex.material))) lobe = sampler.get1(draw + kLobe);
    const Wide pdf_before = path.scatter_pdf;
    const WideVec3 position_before = path.scatter_position;
    alive = alive & scatter(vertex, u, lobe, offset_, path);
    alignas(64) std::uint32_t chain[kMostLanes];
    if (scene_.has_chains()) follow_chains(alive, first, pdf_before, position_before, vertex, path, chain);
    if (scene_.settings.kind != IntegratorKind::book)
      alive = alive & survives_roulette<Wide>(segment, path, [&] { return sampler.get1(draw + kRoulette); });
    if (!any(alive)) return;
    paths_.store(path, alive, kept_);
    if (offset_ == RayOffset::book) compress(Wide(kBookOffset), alive, paths_.t_min + kept_);
    const auto keep = [&](UInts& a) { compress(WideUInt::load(a + first), alive, a + kept_); };
    keep(paths_.seed_low);
    keep(paths_.seed_high);
    keep(paths_.sample);
    keep(paths_.slot);
    if (scene_.light_tree.nodes != nullptr) {
      WideVec3 ng = vertex.ng;
      if (scene_.has_chains())
        ng = select<Wide>(to_float(WideUInt::load(chain)) > Wide(0.0f), WideVec3(Wide(0.0f)), ng);
      compress3(ng, alive, paths_.scatter_ng, kept_);
    }
    if (scene_.has_chains()) compress(WideUInt::load(chain), alive, paths_.chain + kept_);
    kept_ += static_cast<std::size_t>(__builtin_popcount(alive.bits()));
  }

  /// Has paths that specular surfaces turn go on over them: see ShadingScene::follow.
  void follow_chains(WideMask alive, std::size_t first, Wide pdf_before, const WideVec3& position_before,
                     const PathVertex<Wide>& vertex, PathState<Wide>& path, std::uint32_t* chain) const {
    const std::uint32_t reflected = (dot(path.direction, vertex.ng) > Wide(0.0f)).bits();
    alignas(64) float before[kMostLanes], pdf[kMostLanes];
    VectorLanes from, position;
    pdf_before.store(before);
    path.scatter_pdf.store(pdf);
    store3(position_before, from);
    store3(path.scatter_position, position);
    for (int i = 0; i < kLanes; ++i) {
      chain[i] = 0;
      if ((alive.bits() >> i & 1u) == 0 || !(before[i] > 0.0f)) continue;
      const std::size_t at = first + static_cast<std::size_t>(i);
      ChainId followed = paths_.chain[at];
      vec3 p = lane(from, i);
      if (!scene_.follow(hit_geometry_[at], hit_primitive_[at], (reflected >> i & 1u) != 0, followed, p)) continue;
      chain[i] = followed;
      pdf[i] = before[i];
      for (int c = 0; c < 3; ++c) position[c][i] = p[c];
    }
    path.scatter_pdf = Wide::load(pdf);
    path.scatter_position = load3(position);
  }

  void trace_shadow_rays(ShadowQueue& shadow, std::size_t count) {
    if (count == 0) return;
    scene_.accelerator.occluded_batch(rays(shadow, count), shadow.occluded);
    for (std::size_t i = 0; i < count; ++i) {
      if (shadow.occluded[i] != 0) continue;
      for (std::size_t c = 0; c < 3; ++c) radiance_[c].data()[shadow.slot[i]] += shadow.radiance[c][i];
    }
  }

  const ShadingScene& scene_;
  LightSampler lights_;
  SamplerKind sampler_kind_;
  RayOffset offset_;
  BatchRadiance& radiance_;
  std::size_t count_ = 0, kept_ = 0, shadows_ = 0, mirrored_ = 0, over_spheres_ = 0;
  PathQueue paths_;
  ShadowQueue shadow_;
  MirrorQueue mirror_;
  SphereQueue sphere_;
  alignas(64) Floats hit_t_, hit_u_, hit_v_;
  UInts hit_geometry_, hit_primitive_;
  SurfaceLanes surfaces_{};
};

void trace(const ShadingScene& scene, const PathBatch& paths, BatchRadiance& radiance, RayCounts& counts) {
  Wavefront(scene, paths, radiance).run(counts);
}

}  // namespace
}  // namespace raylab
