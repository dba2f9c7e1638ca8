#pragma once
// Where the wavefront keeps its rays from one stage to the next, side by side: paths, shadow rays, and rays on their
// way to lights over mirrors.
#include <cstddef>

#include "core/simd/permutation.hpp"
#include "path_vertex.hpp"
#include "shading_scene.hpp"
#include "sphere_chain_lanes.hpp"

namespace raylab {
namespace {

/// Vectors are stored whole, so every array has room for one more.
constexpr std::size_t kRoom = PathBatch::kMost + kLanes;
using Floats = float[kRoom];
using UInts = std::uint32_t[kRoom];

WideVec3 load3(const Floats (&a)[3], std::size_t i) { return load3(a[0] + i, a[1] + i, a[2] + i); }
WideVec3 load3(const VectorLanes& a) { return load3(a[0], a[1], a[2]); }
void store3(const WideVec3& v, VectorLanes& a) {
  v.x.store(a[0]);
  v.y.store(a[1]);
  v.z.store(a[2]);
}
void compress3(const WideVec3& v, WideMask m, Floats (&a)[3], std::size_t i) {
  compress(v.x, m, a[0] + i);
  compress(v.y, m, a[1] + i);
  compress(v.z, m, a[2] + i);
}

/// The paths of a batch that still go on, side by side: PathState, and where their numbers come from.
struct alignas(64) PathQueue {
  Floats origin[3], direction[3], t_min, t_max;
  Floats throughput[3];
  Floats power_scale, scatter_pdf;
  Floats scatter_position[3];
  UInts seed_low, seed_high, sample;
  UInts slot;            ///< in the batch
  Floats scatter_ng[3];  ///< normal at the scatter position, 0 past chains; of scenes whose lights a tree chooses
  UInts chain;  ///< of specular surfaces since the last vertex from which lights were sampled; of scenes that have some

  PathState<Wide> load(std::size_t i) const {
    return {load3(origin, i),
            load3(direction, i),
            load3(throughput, i),
            Wide::load(power_scale + i),
            Wide::load(scatter_pdf + i),
            load3(scatter_position, i)};
  }
  void store(const PathState<Wide>& p, std::size_t i) {
    for_each(p, i, [](Wide x, float* to) { x.store(to); });
  }
  /// The lanes of the mask, side by side.
  void store(const PathState<Wide>& p, WideMask lanes, std::size_t i) {
    for_each(p, i, [&](Wide x, float* to) { compress(x, lanes, to); });
  }

 private:
  template <class Put>
  void for_each(const PathState<Wide>& p, std::size_t i, const Put& put) {
    const auto put3 = [&](const WideVec3& v, Floats(&to)[3]) {
      put(v.x, to[0] + i);
      put(v.y, to[1] + i);
      put(v.z, to[2] + i);
    };
    put3(p.origin, origin);
    put3(p.direction, direction);
    put3(p.throughput, throughput);
    put3(p.scatter_position, scatter_position);
    put(p.power_scale, power_scale + i);
    put(p.scatter_pdf, scatter_pdf + i);
  }
};

/// Shadow rays, and what arrives where nothing is in between.
struct alignas(64) ShadowQueue {
  Floats origin[3], direction[3], t_min, t_max;
  Floats radiance[3];
  UInts slot;
  std::uint8_t occluded[kRoom];

  /// Copies a ray to an earlier place.
  void move(std::size_t from, std::size_t to) {
    for (int c = 0; c < 3; ++c) {
      origin[c][to] = origin[c][from];
      direction[c][to] = direction[c][from];
      radiance[c][to] = radiance[c][from];
    }
    t_min[to] = t_min[from];
    t_max[to] = t_max[from];
    slot[to] = slot[from];
  }
};

/// Rays on their way to lights over mirrors: MirroredRay.
struct alignas(64) MirrorQueue {
  Floats origin[3], direction[3], t_min, t_max;
  Floats light[3], gap, radiance[3];
  UInts chain, met;
  UInts slot;

  void put(std::size_t i, const MirroredRay& r, std::uint32_t slot_) {
    for (int c = 0; c < 3; ++c) {
      origin[c][i] = r.ray.origin[c];
      direction[c][i] = r.ray.direction[c];
      light[c][i] = r.light[c];
      radiance[c][i] = r.radiance[c];
    }
    t_min[i] = r.ray.t_min;
    t_max[i] = r.ray.t_max;
    gap[i] = r.gap;
    chain[i] = r.chain;
    met[i] = r.met;
    slot[i] = slot_;
  }
  MirroredRay get(std::size_t i) const {
    const auto three = [i](const Floats(&a)[3]) { return vec3(a[0][i], a[1][i], a[2][i]); };
    return {
        {three(origin), three(direction), t_min[i], t_max[i]}, three(light), gap[i], three(radiance), chain[i], met[i]};
  }
};

/// Ways over spheres: rays to the spheres, the rays from there to the lights, and what arrives.
struct alignas(64) SphereQueue {
  ShadowQueue first, last;
};

}  // namespace
}  // namespace raylab
