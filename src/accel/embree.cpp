// `embree` and `embree-robust`: Intel Embree 3 or 4, the same source for both.
// Triangles are Embree's own. Spheres are ours, by callback: Embree's have no stable roots and miss the ground
// sphere of radius 1e6 by 13% of the distance.
#include <algorithm>
#include <atomic>
#include <bit>
#include <cfloat>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <optional>

#include "backends.hpp"
#include "embree_api.hpp"
#include "geometry/primitive_test.hpp"
#include "raylab/core/error.hpp"
#include "raylab/core/parallel.hpp"
#include "raylab/core/timing.hpp"

namespace raylab {

namespace {

/// Largest and smallest length (of the largest component) that a direction may have without being rescaled:
/// Embree takes components below 1e-18 for 1e-18 in its box tests.
constexpr float kLargestDirection = 0x1p30f;
constexpr float kSmallestDirection = 0x1p-30f;

// How batches are traced; Mrays/s of 131,072 rays in bare loops over Embree 3.13.5 on an AMD EPYC with AVX-512, fast
// mode / robust mode, c with the coherent flag:
//                              1            8           8c           16          16c
//   dragon, primary      7.6/ 6.7     7.9/ 6.9     7.5/ 8.2     7.8/ 6.8     7.3/ 7.3
//   dragon, diffuse      2.5/ 1.9     2.5/ 1.9     1.3/ 1.4     2.3/ 1.9     1.1/ 1.1
//   dragon, random       5.6/ 4.8     5.9/ 5.2     2.6/ 2.6     5.7/ 5.1     2.0/ 1.8
//   bunny, primary        14/  11      15/  12      21/  18      15/  12      26/  21
//   bunny, diffuse       6.9/ 5.6     7.4/ 5.9     4.1/ 4.4     7.3/ 5.9     4.1/ 4.0
//   bunny, shadow         20/  13      36/  26      35/  27      49/  32      47/  33
//   cornell, primary      19/  14      30/  18      49/  36      33/  19      59/  45
//   cornell, shadow       20/  14      32/  27      12/ 9.3      49/  35      13/ 9.4
// So single rays are never the fastest, nor are streams, which cut the same packets and gain a little only where
// all else is slow. Packets are as wide as can be, but for closest hits in large scenes. The flag is for closest hits
// of packets whose rays start and run alike, and never for occlusion.
/// Primitives from which on closest hits are asked for in packets of 8.
constexpr std::size_t kLargeScene = std::size_t{1} << 18;
/// How far the directions of coherent rays may lie from the first one, in its largest component; and less where there
/// are so many primitives that such a packet would see more of them side by side than the second says.
constexpr float kCoherentSpread = 0.1f;
constexpr float kCoherentPrimitives = 16.0f;
/// How far apart they may start, of the largest extent of the scene.
constexpr float kCoherentReach = 0.1f;

// Floats that are not negative are ordered as their bits are. As integers they need no care for NaN, and compilers
// make vectors of the comparisons.
constexpr std::int32_t bits_of(float x) { return std::bit_cast<std::int32_t>(x); }

/// Whether Embree can take the ray as it is, its interval made one float narrower at either end: see to_embree.
/// No lane branches here, so that a packet is looked at as a whole.
inline bool is_plain(float dir_x, float dir_y, float dir_z, float t_min, float t_max) {
  const std::int32_t x = bits_of(std::abs(dir_x));
  const std::int32_t y = bits_of(std::abs(dir_y));
  const std::int32_t z = bits_of(std::abs(dir_z));
  constexpr std::int32_t least = bits_of(kSmallestDirection);
  constexpr std::int32_t most = bits_of(kLargestDirection);
  return bool((x <= most) & (y <= most) & (z <= most) & ((x >= least) | (y >= least) | (z >= least)) &
              (bits_of(t_min) >= 0) & (bits_of(t_min) < bits_of(kInfinity)) & (bits_of(t_max) > 0) &
              (bits_of(t_max) <= bits_of(kInfinity)));
}

/// The ends of the interval of such a ray, as Embree takes them: off zero, since a denormal t_min counts as zero.
/// Of other rays, which pass here in packets, it is any float.
inline float plain_near(float t_min) {
  const auto next = static_cast<std::int32_t>(std::bit_cast<std::uint32_t>(t_min) + 1u);
  return std::bit_cast<float>(std::max(next, bits_of(FLT_MIN)));
}
inline float plain_far(float t_max) { return std::bit_cast<float>(std::bit_cast<std::uint32_t>(t_max) - 1u); }

/// The ray as Embree takes it, and the power of two its direction was multiplied by.
/// Embree's modes differ at the ends of the interval: robust includes t_min, fast excludes it, both include
/// t_max. So the ends are moved inward by one float.
float to_embree(const Ray& ray, RTCRay& out) {
  vec3 direction = ray.direction;
  float scale = 1.0f;
  float near, far;
  if (is_plain(direction.x, direction.y, direction.z, ray.t_min, ray.t_max)) [[likely]] {
    near = plain_near(ray.t_min);
    far = plain_far(ray.t_max);
  } else {
    const float largest = max_component(glm::abs(direction));
    if (largest > 0.0f && !(largest <= kLargestDirection && largest >= kSmallestDirection)) {
      scale = std::ldexp(1.0f, -std::clamp(std::ilogb(largest), -126, 126));
    }
    direction *= scale;
    near = std::max(next_float_up(ray.t_min) / scale, FLT_MIN);
    far = next_float_down(ray.t_max) / scale;
  }
  // Written by fours, as Embree reads them: a load cannot be served from several stores under way.
  using Four = float __attribute__((vector_size(16)));
  const float all_bits = std::bit_cast<float>(~0u);  // the mask, whose default differs between Embree 3 and 4
  const Four rows[3] = {{ray.origin.x, ray.origin.y, ray.origin.z, near},
                        {direction.x, direction.y, direction.z, 0.0f},
                        {far, all_bits, 0.0f, 0.0f}};
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

bool hit_sphere(void* user, unsigned primitive, const RTCRay& ray, float& t) {
  const Ray own{{ray.org_x, ray.org_y, ray.org_z}, {ray.dir_x, ray.dir_y, ray.dir_z}};
  const Sphere& sphere = static_cast<const Geometry*>(user)->spheres[primitive];
  // Embree's interval is closed, ours is open.
  const auto hit =
      PrimitiveTest<Intersector::fast>(own).sphere(sphere, next_float_down(ray.tnear), next_float_up(ray.tfar));
  if (hit) t = *hit;
  return hit.has_value();
}

void sphere_bounds_callback(const RTCBoundsFunctionArguments* args) {
  const Sphere& sphere = static_cast<const Geometry*>(args->geometryUserPtr)->spheres[args->primID];
  const Bounds b = is_valid_sphere(sphere) ? sphere_bounds(sphere) : Bounds();  // Embree drops empty ones
  *args->bounds_o = {b.lower.x, b.lower.y, b.lower.z, 0.0f, b.upper.x, b.upper.y, b.upper.z, 0.0f};
}

void sphere_intersect_callback(const RTCIntersectFunctionNArguments* args) {
  RTCRayN* const rays = RTCRayHitN_RayN(args->rayhit, args->N);
  RTCHitN* const hits = RTCRayHitN_HitN(args->rayhit, args->N);
  for (unsigned i = 0; i < args->N; ++i) {
    if (args->valid[i] == 0) continue;
    float& t = RTCRayN_tfar(rays, args->N, i);
    const bool hit = hit_sphere(args->geometryUserPtr, args->primID, rtcGetRayFromRayN(rays, args->N, i), t);
    if (hit) {
      RTCHitN_u(hits, args->N, i) = 0.0f;
      RTCHitN_v(hits, args->N, i) = 0.0f;
      RTCHitN_geomID(hits, args->N, i) = args->geomID;
      RTCHitN_primID(hits, args->N, i) = args->primID;
    }
    args->valid[i] = hit ? -1 : 0;
  }
}

void sphere_occluded_callback(const RTCOccludedFunctionNArguments* args) {
  for (unsigned i = 0; i < args->N; ++i) {
    if (args->valid[i] == 0) continue;
    float t;
    const bool hit = hit_sphere(args->geometryUserPtr, args->primID, rtcGetRayFromRayN(args->ray, args->N, i), t);
    if (hit) RTCRayN_tfar(args->ray, args->N, i) = -kInfinity;
    args->valid[i] = hit ? -1 : 0;
  }
}

bool count_bytes(void* total, ssize_t bytes, bool) {
  static_cast<std::atomic<std::ptrdiff_t>*>(total)->fetch_add(bytes, std::memory_order_relaxed);
  return true;
}

/// The instruction set that the device's traversal uses. Embree tells it in words on the process's standard output
/// alone, but also which widths of packets are traced natively. AVX and AVX2 have the same, and an Embree that is
/// compiled for the first and not for the second is taken for one that has both.
std::string isa_of(int packet_size) {
#if defined(__x86_64__)
  if (packet_size == 16) return "avx512";
  if (packet_size == 8) return __builtin_cpu_supports("avx2") != 0 ? "avx2" : "avx";
  return __builtin_cpu_supports("sse4.2") != 0 ? "sse4.2" : "sse2";
#else
  static_cast<void>(packet_size);
  return "neon";
#endif
}

/// Scenes with the robust or the compact flag are built by the surface area heuristic at high quality too: only
/// others have their space split.
RTCBuildQuality embree_quality(BuildQuality quality) {
  switch (quality) {
    case BuildQuality::fast:
      return RTC_BUILD_QUALITY_LOW;
    case BuildQuality::best:
      return RTC_BUILD_QUALITY_HIGH;
    case BuildQuality::balanced:
      break;
  }
  return RTC_BUILD_QUALITY_MEDIUM;
}

class Embree final : public Accelerator {
 public:
  Embree(const Geometry& geometry, const AcceleratorOptions& options, bool robust)
      : quality_(embree_quality(options.quality.value_or(BuildQuality::balanced))) {
    const Stopwatch watch;
    // A device that is told of threads would keep all of TBB to that number as long as it lives.
    const ThreadLimit limit(options.threads);
    device_.reset(rtcNewDevice(""));
    check_device();
    if (rtcGetDeviceProperty(device_.get(), RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) != 0) packet_size_ = 8;
    if (rtcGetDeviceProperty(device_.get(), RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED) != 0) packet_size_ = 16;
    report_.isa = isa_of(packet_size_);
    rtcSetDeviceMemoryMonitorFunction(device_.get(), count_bytes, &bytes_);
    scene_.reset(rtcNewScene(device_.get()));
    check_device();
    const int flags = (robust ? RTC_SCENE_FLAG_ROBUST : 0) | (options.compact ? RTC_SCENE_FLAG_COMPACT : 0);
    rtcSetSceneFlags(scene_.get(), static_cast<RTCSceneFlags>(flags));
    rtcSetSceneBuildQuality(scene_.get(), quality_);

    original_.resize(geometry.meshes.size() + 1);
    for (std::uint32_t m = 0; m < geometry.meshes.size(); ++m) add_mesh(geometry.meshes[m], m);
    add_spheres(geometry);
    rtcCommitScene(scene_.get());
    check_device();
    RTCBounds box;
    rtcGetSceneBounds(scene_.get(), &box);
    coherent_reach_ =
        kCoherentReach * std::max({box.upper_x - box.lower_x, box.upper_y - box.lower_y, box.upper_z - box.lower_z});
    coherent_spread_ =
        std::min(kCoherentSpread, kCoherentPrimitives / std::sqrt(static_cast<float>(report_.primitives)));
    closest_packet_size_ = report_.primitives < kLargeScene ? packet_size_ : std::min(packet_size_, 8);

    for (const auto& triangles : original_) report_.bytes += triangles.capacity() * sizeof(std::uint32_t);
    report_.bytes += sizeof(*this) + static_cast<std::size_t>(std::max<std::ptrdiff_t>(bytes_, 0));
    report_.invalid_primitives = geometry.primitive_count() - report_.primitives;
    report_.seconds = watch.seconds();
  }

  std::optional<Hit> intersect(const Ray& ray) const noexcept override {
    RTCRayHit query;
    const float scale = to_embree(ray, query.ray);
    const float tnear = query.ray.tnear;
    const float tfar = query.ray.tfar;
    if (!(tnear <= tfar)) return std::nullopt;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    embree_query(scene_.get(), query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    return to_hit(query.ray.tfar, tnear, tfar, scale, query.hit.u, query.hit.v, query.hit.geomID, query.hit.primID);
  }

  bool occluded(const Ray& ray) const noexcept override {
    RTCRay query;
    to_embree(ray, query);
    if (!(query.tnear <= query.tfar)) return false;
    embree_query(scene_.get(), query);
    return query.tfar < 0.0f;
  }

  void intersect_batch(const RayBatch& rays, const HitBatch& hits) const noexcept override {
    if (closest_packet_size_ == 16) return intersect_by_16(rays, hits);
    if (closest_packet_size_ == 8) return intersect_by_8(rays, hits);
    intersect_packets<4>(rays, hits);
  }

  void occluded_batch(const RayBatch& rays, std::uint8_t* occluded_rays) const noexcept override {
    if (packet_size_ == 16) return occluded_by_16(rays, occluded_rays);
    if (packet_size_ == 8) return occluded_by_8(rays, occluded_rays);
    occluded_packets<4>(rays, occluded_rays);
  }

  RTCScene scene() const { return scene_.get(); }

  const BuildReport& build_report() const noexcept override { return report_; }

 private:
  std::optional<Hit> to_hit(float t, float tnear, float tfar, float scale, float u, float v, unsigned geometry,
                            unsigned primitive) const {
    if (geometry == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    // Embree compares t times a determinant, so the quotient it reports can be a float outside the interval.
    // Clamped, the answer stays the one that occluded() gives.
    return Hit{std::clamp(t, tnear, tfar) * scale, u, v, geometry,
               renumbered_ ? original_primitive(geometry, primitive) : primitive};
  }

  std::uint32_t original_primitive(std::uint32_t geometry, std::uint32_t primitive) const {
    const auto& original = original_[geometry];
    return original.empty() ? primitive : original[primitive];
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

  /// What is the same in all packets, which Embree leaves as it is.
  template <class Rays>
  static void prepare(Rays& out) {
    std::memset(&out, 0, sizeof(out));
    std::memset(out.mask, 0xff, sizeof(out.mask));
  }

  /// Fills a packet with rays [first, first + count) of the batch.
  template <int n, class Rays>
  void fill(const RayBatch& rays, std::size_t first, int count, Rays& out, Packet<n>& packet) const {
    packet.whole = count == n && fill_whole(rays, first, out, packet);
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

  /// The same for a packet without empty lanes. Says whether all rays are plain; otherwise it leaves no packet.
  template <int n, class Rays>
  bool fill_whole(const RayBatch& rays, std::size_t first, Rays& out, Packet<n>& packet) const {
    const float* const org_x = rays.origin[0] + first;
    const float* const org_y = rays.origin[1] + first;
    const float* const org_z = rays.origin[2] + first;
    const float* const dir_x = rays.direction[0] + first;
    const float* const dir_y = rays.direction[1] + first;
    const float* const dir_z = rays.direction[2] + first;
    const float* const t_min = rays.t_min + first;
    const float* const t_max = rays.t_max + first;
    const Ray one = rays.ray(first);
    const float reach = coherent_reach_;
    const float spread = coherent_spread_ * max_component(glm::abs(one.direction));
    int plain = -1;
    int apart = 0;
    // One loop over all arrays becomes one pass of vector instructions; several would be unrolled before.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC ivdep
#endif
    for (int i = 0; i < n; ++i) {
      const float x = dir_x[i], y = dir_y[i], z = dir_z[i];
      const float near = plain_near(t_min[i]);
      const float far = plain_far(t_max[i]);
      plain &= -int(is_plain(x, y, z, t_min[i], t_max[i]));
      apart |= -int((std::abs(x - one.direction.x) > spread) | (std::abs(y - one.direction.y) > spread) |
                    (std::abs(z - one.direction.z) > spread) | (std::abs(org_x[i] - one.origin.x) > reach) |
                    (std::abs(org_y[i] - one.origin.y) > reach) | (std::abs(org_z[i] - one.origin.z) > reach));
      out.org_x[i] = org_x[i];
      out.org_y[i] = org_y[i];
      out.org_z[i] = org_z[i];
      out.dir_x[i] = x;
      out.dir_y[i] = y;
      out.dir_z[i] = z;
      out.tnear[i] = near;
      out.tfar[i] = far;
      packet.far[i] = far;
      packet.valid[i] = -int(bits_of(near) <= bits_of(far));
    }
    packet.coherent = apart == 0;
    return plain != 0;
  }

  template <int n>
  void intersect_packets(const RayBatch& rays, const HitBatch& hits) const noexcept {
    typename PacketTypes<n>::RayHit query;
    Packet<n> packet;
    prepare(query.ray);
    for (std::size_t first = 0; first < rays.count; first += n) {
      const int count = static_cast<int>(std::min<std::size_t>(n, rays.count - first));
      fill(rays, first, count, query.ray, packet);
      std::memset(query.hit.geomID, 0xff, sizeof(query.hit.geomID));
      embree_query(packet.valid, scene_.get(), query, packet.coherent);
      if (packet.whole && !renumbered_) {
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC ivdep
#endif
        for (int i = 0; i < n; ++i) {  // as to_hit
          const float above = query.ray.tfar[i] < query.ray.tnear[i] ? query.ray.tnear[i] : query.ray.tfar[i];
          (hits.t + first)[i] = packet.far[i] < above ? packet.far[i] : above;
          (hits.u + first)[i] = query.hit.u[i];
          (hits.v + first)[i] = query.hit.v[i];
          (hits.geometry + first)[i] = query.hit.geomID[i];
          (hits.primitive + first)[i] = query.hit.primID[i];
        }
        continue;
      }
      for (int i = 0; i < count; ++i) {
        hits.set(first + static_cast<std::size_t>(i),
                 to_hit(query.ray.tfar[i], query.ray.tnear[i], packet.far[i], packet.whole ? 1.0f : packet.scale[i],
                        query.hit.u[i], query.hit.v[i], query.hit.geomID[i], query.hit.primID[i]));
      }
    }
  }

  template <int n>
  void occluded_packets(const RayBatch& rays, std::uint8_t* occluded_rays) const noexcept {
    typename PacketTypes<n>::Ray query;
    Packet<n> packet;
    prepare(query);
    for (std::size_t first = 0; first < rays.count; first += n) {
      const int count = static_cast<int>(std::min<std::size_t>(n, rays.count - first));
      fill(rays, first, count, query, packet);
      embree_query(packet.valid, scene_.get(), query, false);
      std::uint8_t found[n];
      for (int i = 0; i < n; ++i) found[i] = query.tfar[i] < 0.0f;
      if (count == n) {
        std::memcpy(occluded_rays + first, found, n);
      } else {
        std::copy_n(found, count, occluded_rays + first);
      }
    }
  }

  // Where Embree traces packets of 16 natively the processor has AVX-512, and AVX for those of 8: they are filled
  // by the same instructions, each array at once. Embree could not read it from several stores under way.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define RAYLAB_FILLED_BY(target) __attribute__((flatten, __target__(target)))
#else
#define RAYLAB_FILLED_BY(target)
#endif
  RAYLAB_FILLED_BY("avx512f,avx512bw,avx512dq,avx512vl,prefer-vector-width=512")
  void intersect_by_16(const RayBatch& rays, const HitBatch& hits) const noexcept { intersect_packets<16>(rays, hits); }
  RAYLAB_FILLED_BY("avx512f,avx512bw,avx512dq,avx512vl,prefer-vector-width=512")
  void occluded_by_16(const RayBatch& rays, std::uint8_t* out) const noexcept { occluded_packets<16>(rays, out); }
  RAYLAB_FILLED_BY("avx")
  void intersect_by_8(const RayBatch& rays, const HitBatch& hits) const noexcept { intersect_packets<8>(rays, hits); }
  RAYLAB_FILLED_BY("avx")
  void occluded_by_8(const RayBatch& rays, std::uint8_t* out) const noexcept { occluded_packets<8>(rays, out); }
#undef RAYLAB_FILLED_BY

  void check_device() const {
    const RTCError error = rtcGetDeviceError(device_.get());
    if (error == RTC_ERROR_NONE) return;
    throw Error(ErrorKind::failure, "embree", "error " + std::to_string(error) + " while building");
  }

  void attach(RTCGeometry geometry, std::uint32_t id) {
    rtcSetGeometryBuildQuality(geometry, quality_);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene_.get(), geometry, id);
  }

  /// Views the arrays of the mesh. Only where triangles are invalid Embree gets a list of its own, without
  /// them: it does not check indices.
  void add_mesh(const TriangleMesh& mesh, std::uint32_t id) {
    const std::size_t count = mesh.triangles.size();
    std::vector<std::uint32_t> valid;
    for (std::uint32_t i = 0; i < count; ++i) {
      if (is_valid_triangle(mesh, i)) valid.push_back(i);
    }
    report_.primitives += valid.size();
    if (valid.empty()) return;

    const EmbreeGeometry triangles(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
    const std::size_t vertices = mesh.positions.size();
    if (mesh.positions.capacity() > vertices) {
      rtcSetSharedGeometryBuffer(triangles.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh.positions.data(),
                                 0, sizeof(vec3), vertices);
    } else {  // not padded: Embree would read past the end
      void* copy = new_buffer(triangles.get(), RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, sizeof(vec3), vertices);
      std::copy(mesh.positions.begin(), mesh.positions.end(), static_cast<vec3*>(copy));
    }
    if (valid.size() == count) {
      rtcSetSharedGeometryBuffer(triangles.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0,
                                 sizeof(uvec3), count);
    } else {
      auto* copy = static_cast<uvec3*>(
          new_buffer(triangles.get(), RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, sizeof(uvec3), valid.size()));
      for (const std::uint32_t i : valid) *copy++ = mesh.triangles[i];
      original_[id] = std::move(valid);
      renumbered_ = true;
    }
    attach(triangles.get(), id);
  }

  void add_spheres(const Geometry& geometry) {
    const auto valid = std::count_if(geometry.spheres.begin(), geometry.spheres.end(), is_valid_sphere);
    report_.primitives += static_cast<std::size_t>(valid);
    if (valid == 0) return;
    const EmbreeGeometry spheres(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_USER));
    rtcSetGeometryUserPrimitiveCount(spheres.get(), static_cast<unsigned>(geometry.spheres.size()));
    rtcSetGeometryUserData(spheres.get(), const_cast<Geometry*>(&geometry));
    rtcSetGeometryBoundsFunction(spheres.get(), sphere_bounds_callback, nullptr);
    rtcSetGeometryIntersectFunction(spheres.get(), sphere_intersect_callback);
    rtcSetGeometryOccludedFunction(spheres.get(), sphere_occluded_callback);
    attach(spheres.get(), geometry.sphere_geometry());
  }

  void* new_buffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format, std::size_t stride, std::size_t count) {
    void* buffer = rtcSetNewGeometryBuffer(geometry, type, 0, format, stride, count);
    if (!buffer) check_device();
    return buffer;
  }

  RTCBuildQuality quality_;
  int packet_size_ = 4;  ///< the most that Embree traces natively
  int closest_packet_size_ = 4;
  float coherent_spread_ = 0.0f;
  float coherent_reach_ = 0.0f;
  std::atomic<std::ptrdiff_t> bytes_{0};  // outlives the device, which counts into it
  Device device_;
  EmbreeScene scene_;
  /// For each geometry the ids of the primitives given to Embree; empty where those are all it has.
  std::vector<std::vector<std::uint32_t>> original_;
  bool renumbered_ = false;  ///< whether any has such a list
  BuildReport report_;
};

}  // namespace

std::unique_ptr<Accelerator> make_embree(const Geometry& geometry, const AcceleratorOptions& options) {
  return std::make_unique<Embree>(geometry, options, false);
}

RTCScene embree_scene(const Accelerator& accelerator) { return static_cast<const Embree&>(accelerator).scene(); }

std::unique_ptr<Accelerator> make_embree_robust(const Geometry& geometry, const AcceleratorOptions& options) {
  return std::make_unique<Embree>(geometry, options, true);
}

}  // namespace raylab
