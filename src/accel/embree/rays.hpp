#pragma once
// Rays as Embree takes them, one by one and in packets that are filled from a batch's arrays. Local to the including
// file.
#include <algorithm>
#include <array>
#include <bit>
#include <cfloat>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "api.hpp"

namespace raylab {

namespace {

/// Largest and smallest length (of the largest component) that a direction may have without being rescaled:
/// Embree takes components below 1e-18 for 1e-18 in its box tests.
constexpr float kLargestDirection = 0x1p30f;
constexpr float kSmallestDirection = 0x1p-30f;

/// The farthest that an origin may lie from zero: Embree gives up, in some builds with the whole process, from 1.8e18
/// on.
constexpr float kFarthestOrigin = 0x1p60f;

// Floats that are not negative are ordered as their bits are. As integers they need no care for NaN, and compilers
// make vectors of the comparisons.
constexpr std::int32_t bits_of(float x) { return std::bit_cast<std::int32_t>(x); }

constexpr std::int32_t size_bits(float x) { return bits_of(x) & 0x7fffffff; }

/// Whether Embree can take the ray as it is, its interval made one float narrower at either end: see to_embree.
/// No lane branches here, so that a packet is looked at as a whole.
inline bool is_plain(float org_x, float org_y, float org_z, float dir_x, float dir_y, float dir_z, float t_min,
                     float t_max) {
  const std::int32_t far = std::max(std::max(size_bits(org_x), size_bits(org_y)), size_bits(org_z));
  const std::int32_t length = std::max(std::max(size_bits(dir_x), size_bits(dir_y)), size_bits(dir_z));
  const int plain = int(far <= bits_of(kFarthestOrigin)) & int(length >= bits_of(kSmallestDirection)) &
                    int(length <= bits_of(kLargestDirection)) & int(bits_of(t_min) >= 0) &
                    int(bits_of(t_min) < bits_of(kInfinity)) & int(bits_of(t_max) > 0) &
                    int(bits_of(t_max) <= bits_of(kInfinity));
  return plain != 0;
}

/// Whether Embree can take the ray once its direction is rescaled.
inline bool is_embree_ray(const Ray& ray) {
  const float largest = max_component(glm::abs(ray.direction));
  const vec3 far = glm::abs(ray.origin);
  return is_finite(ray.direction) && largest > 0.0f && far.x <= kFarthestOrigin && far.y <= kFarthestOrigin &&
         far.z <= kFarthestOrigin;
}

/// The ends of the interval of such a ray, as Embree takes them: off zero, since a denormal t_min counts as zero.
/// Of other rays, which pass here in packets, it is any float.
inline float plain_near(float t_min) {
  const auto next = static_cast<std::int32_t>(std::bit_cast<std::uint32_t>(t_min) + 1u);
  return std::bit_cast<float>(std::max(next, bits_of(FLT_MIN)));
}
inline float plain_far(float t_max) { return std::bit_cast<float>(std::bit_cast<std::uint32_t>(t_max) - 1u); }

/// The ray as Embree takes it, and the power of two its direction was multiplied by; 0, and an interval that is empty,
/// for a ray that Embree cannot take.
/// Embree's modes differ at the ends of the interval: robust includes t_min, fast excludes it, both include
/// t_max. So the ends are moved inward by one float, of which fast could do without that at t_min.
inline float to_embree(const Ray& ray, RTCRay& out) {
  vec3 origin = ray.origin;
  vec3 direction = ray.direction;
  float scale = 1.0f;
  float near, far;
  if (is_plain(origin.x, origin.y, origin.z, direction.x, direction.y, direction.z, ray.t_min, ray.t_max)) [[likely]] {
    near = plain_near(ray.t_min);
    far = plain_far(ray.t_max);
  } else if (is_embree_ray(ray)) {
    const float largest = max_component(glm::abs(direction));
    if (!(largest <= kLargestDirection && largest >= kSmallestDirection)) {
      scale = std::ldexp(1.0f, -std::clamp(std::ilogb(largest), -126, 126));
    }
    direction *= scale;
    // So that the hit's t, which is multiplied by the scale, is no denormal.
    near = std::max(next_float_up(ray.t_min) / scale, FLT_MIN / std::min(scale, 1.0f));
    far = next_float_down(ray.t_max) / scale;
    if (!(near <= far)) near = 0.0f, far = -1.0f;  // NaN would be asserted against
  } else {
    origin = direction = vec3(0.0f);
    scale = near = 0.0f;
    far = -1.0f;
  }
  // Written by fours, as Embree reads them: a load cannot be served from several stores under way.
  using Four = float __attribute__((vector_size(16)));
  const float all_bits = std::bit_cast<float>(~0u);  // the mask, whose default differs between Embree 3 and 4
  const Four rows[3] = {
      {origin.x, origin.y, origin.z, near}, {direction.x, direction.y, direction.z, 0.0f}, {far, all_bits, 0.0f, 0.0f}};
  static_assert(offsetof(RTCRay, flags) + sizeof(out.flags) == sizeof(rows));
  std::memcpy(&out, rows, sizeof(rows));
  return scale;
}

/// The same for lane i of a packet.
template <class Packet>
float to_embree(const Ray& ray, Packet& out, int i) {
  RTCRay one;
  const float scale = to_embree(ray, one);
  out.org_x[i] = one.org_x;
  out.org_y[i] = one.org_y;
  out.org_z[i] = one.org_z;
  out.dir_x[i] = one.dir_x;
  out.dir_y[i] = one.dir_y;
  out.dir_z[i] = one.dir_z;
  out.tnear[i] = one.tnear;
  out.tfar[i] = one.tfar;
  return scale;
}

/// What a packet of Embree's was filled with.
template <int n>
struct Packet {
  alignas(64) int valid[n];
  float far[n];    ///< where the rays ended before they were traced
  float scale[n];  ///< see to_embree; unset in whole packets of plain rays
  bool whole;      ///< all lanes hold a ray, and all rays are plain
  bool coherent;
};

/// How far rays may be from the first of their packet for it to count as coherent.
struct Coherence {
  float spread = 0.0f;  ///< of directions, of the first one's largest component
  float reach = 0.0f;   ///< of origins
};

/// What is the same in all packets, which Embree leaves as it is.
template <class Rays>
void prepare(Rays& out) {
  std::memset(&out, 0, sizeof(out));
  std::memset(out.mask, 0xff, sizeof(out.mask));
}

// What is found of some ray of a packet.
constexpr int kNotPlain = 1, kApart = 2;

/// Fills a packet without empty lanes. Says whether all rays are plain; otherwise it leaves no packet. For `closest`
/// hits it also gives their ends, and says whether they are coherent.
template <bool closest, int n, class Rays>
bool fill_whole(const RayBatch& rays, std::size_t first, const Coherence& coherence, Rays& out, Packet<n>& packet) {
  const float* const org_x = rays.origin[0] + first;
  const float* const org_y = rays.origin[1] + first;
  const float* const org_z = rays.origin[2] + first;
  const float* const dir_x = rays.direction[0] + first;
  const float* const dir_y = rays.direction[1] + first;
  const float* const dir_z = rays.direction[2] + first;
  const float* const t_min = rays.t_min + first;
  const float* const t_max = rays.t_max + first;
  const Ray one = rays.ray(first);
  const float reach = coherence.reach;
  const float spread = coherence.spread * max_component(glm::abs(one.direction));
  int found = 0;
  // One loop over all arrays becomes one pass of vector instructions; several would be unrolled before.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC ivdep
#endif
  for (int i = 0; i < n; ++i) {
    const float x = dir_x[i], y = dir_y[i], z = dir_z[i];
    const float near = plain_near(t_min[i]);
    const float far = plain_far(t_max[i]);
    found |= is_plain(org_x[i], org_y[i], org_z[i], x, y, z, t_min[i], t_max[i]) ? 0 : kNotPlain;
    if constexpr (closest) {
      const std::int32_t turned = std::max(std::max(size_bits(x - one.direction.x), size_bits(y - one.direction.y)),
                                           size_bits(z - one.direction.z));
      const std::int32_t moved =
          std::max(std::max(size_bits(org_x[i] - one.origin.x), size_bits(org_y[i] - one.origin.y)),
                   size_bits(org_z[i] - one.origin.z));
      found |= (int(turned > bits_of(spread)) | int(moved > bits_of(reach))) != 0 ? kApart : 0;
      packet.far[i] = far;
    }
    out.org_x[i] = org_x[i];
    out.org_y[i] = org_y[i];
    out.org_z[i] = org_z[i];
    out.dir_x[i] = x;
    out.dir_y[i] = y;
    out.dir_z[i] = z;
    out.tnear[i] = near;
    out.tfar[i] = far;
    packet.valid[i] = -int(bits_of(near) <= bits_of(far));
  }
  packet.coherent = closest && found == 0;
  return (found & kNotPlain) == 0;
}

/// Fills a packet with rays [first, first + count) of the batch.
template <bool closest, int n, class Rays>
void fill(const RayBatch& rays, std::size_t first, int count, const Coherence& coherence, Rays& out,
          Packet<n>& packet) {
  packet.whole = count == n && fill_whole<closest>(rays, first, coherence, out, packet);
  if (packet.whole) return;
  packet.coherent = false;
  for (int i = 0; i < n; ++i) {
    packet.valid[i] = 0;
    if (i >= count) continue;
    packet.scale[i] = to_embree(rays.ray(first + static_cast<std::size_t>(i)), out, i);
    packet.valid[i] = out.tnear[i] <= out.tfar[i] ? -1 : 0;
    packet.far[i] = out.tfar[i];
    if (packet.valid[i] == 0) out.tfar[i] = 0.0f;  // a negative end would read as occluded
  }
}

#if RAYLAB_EMBREE_MAJOR < 4
/// What a stream of rays holds beside a batch's own arrays.
struct Stream {
  static constexpr std::size_t kMost = 512;
  float near[kMost], far[kMost];

  /// Says whether all rays are plain, with intervals that are not empty; otherwise it leaves no stream.
  bool fill(const RayBatch& rays) {
    int plain = 1;
    for (std::size_t i = 0; i < rays.count; ++i) {
      near[i] = plain_near(rays.t_min[i]);
      far[i] = plain_far(rays.t_max[i]);
      plain &= int(is_plain(rays.origin[0][i], rays.origin[1][i], rays.origin[2][i], rays.direction[0][i],
                            rays.direction[1][i], rays.direction[2][i], rays.t_min[i], rays.t_max[i])) &
               int(bits_of(near[i]) <= bits_of(far[i]));
    }
    return plain != 0;
  }

  /// Afterwards `far` is negative where a ray is occluded.
  void query_occluded(RTCScene scene, const RayBatch& rays) {
    // Embree reads these arrays and writes `far` alone.
    static float times[kMost];
    static unsigned zeros[kMost];
    static const std::array<unsigned, kMost> ones = [] {
      std::array<unsigned, kMost> all;
      all.fill(~0u);
      return all;
    }();
    const auto own = [](const float* array) { return const_cast<float*>(array); };
    RTCRayNp query{own(rays.origin[0]),
                   own(rays.origin[1]),
                   own(rays.origin[2]),
                   near,
                   own(rays.direction[0]),
                   own(rays.direction[1]),
                   own(rays.direction[2]),
                   times,
                   far,
                   const_cast<unsigned*>(ones.data()),
                   zeros,
                   zeros};
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccludedNp(scene, &context, &query, static_cast<unsigned>(rays.count));
  }
};
#endif

}  // namespace
}  // namespace raylab
