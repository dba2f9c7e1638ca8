// `embree` and `embree-robust`: Intel Embree 3 or 4, the same source for both.
// Triangles are Embree's own.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <optional>

#include "accel/backends.hpp"
#include "api.hpp"
#include "raylab/core/error.hpp"
#include "raylab/core/parallel.hpp"
#include "raylab/core/timing.hpp"
#include "rays.hpp"
#include "spheres.hpp"

namespace raylab {

namespace {

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
// So single rays are never the fastest. Packets are as wide as can be, but for closest hits in large scenes. The flag
// is for closest hits of packets whose rays start and run alike, and never for occlusion. Streams, which Embree 4 has
// no more, sort their rays by octant: occlusion in large scenes gains 8 to 19% by it, all else nothing.
/// Primitives from which on closest hits are asked for in packets of 8, and occlusion in streams.
constexpr std::size_t kLargeScene = std::size_t{1} << 18;
/// How far the directions of coherent rays may lie from the first one, in its largest component; and less where there
/// are so many primitives that such a packet would see more of them side by side than the second says.
constexpr float kCoherentSpread = 0.1f;
constexpr float kCoherentPrimitives = 16.0f;
/// How far apart they may start, of the largest extent of the scene.
constexpr float kCoherentReach = 0.1f;

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
      : geometry_(geometry), quality_(embree_quality(options.quality.value_or(BuildQuality::balanced))) {
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
    coherence_.reach =
        kCoherentReach * std::max({box.upper_x - box.lower_x, box.upper_y - box.lower_y, box.upper_z - box.lower_z});
    coherence_.spread =
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
    if (!(tnear <= tfar)) return scale == 0.0f ? test_all(ray) : std::nullopt;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    embree_query(scene_.get(), query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    return to_hit(query.ray.tfar, tnear, tfar, scale, query.hit.u, query.hit.v, query.hit.geomID, query.hit.primID);
  }

  bool occluded(const Ray& ray) const noexcept override {
    RTCRay query;
    const float scale = to_embree(ray, query);
    if (!(query.tnear <= query.tfar)) return scale == 0.0f && test_all(ray);
    embree_query(scene_.get(), query);
    return query.tfar < 0.0f;
  }

  void intersect_batch(const RayBatch& rays, const HitBatch& hits) const noexcept override {
    if (closest_packet_size_ == 16) return intersect_by_16(rays, hits);
    if (closest_packet_size_ == 8) return intersect_by_8(rays, hits);
    intersect_packets<4>(rays, hits);
  }

  void occluded_batch(const RayBatch& rays, std::uint8_t* occluded_rays) const noexcept override {
#if RAYLAB_EMBREE_MAJOR < 4
    if (report_.primitives >= kLargeScene) return occluded_streams(rays, occluded_rays);
#endif
    occluded_packets(rays, occluded_rays);
  }

  RTCScene scene() const { return scene_.get(); }

  const BuildReport& build_report() const noexcept override { return report_; }

 private:
  /// The answer to a ray that Embree cannot take: every primitive is tested if the origin is too far off. A ray with a
  /// component that is no number or with no direction hits nothing, which need not be found by testing.
  std::optional<Hit> test_all(const Ray& ray) const {
    if (!is_finite(ray.origin) || !is_finite(ray.direction) || ray.direction == vec3(0.0f)) return std::nullopt;
    const PrimitiveTest<Intersector::watertight> test(ray);
    std::optional<Hit> closest;
    float t_max = ray.t_max;
    for_each_valid_primitive(geometry_, [&](const PrimitiveId& id) {
      if (const auto hit = test(geometry_, id, ray.t_min, t_max)) {
        closest = hit;
        t_max = hit->t;
      }
    });
    return closest;
  }

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

  // Some packets are filled before the first of them is traced: Embree would otherwise wait for stores under way.
  static constexpr std::size_t kAhead = 4;

  template <int n>
  void intersect_packets(const RayBatch& rays, const HitBatch& hits) const noexcept {
    typename PacketTypes<n>::RayHit queries[kAhead];
    Packet<n> packets[kAhead];
    for (auto& query : queries) prepare(query.ray);
    for (std::size_t first = 0; first < rays.count; first += kAhead * n) {
      const std::size_t end = std::min(rays.count, first + kAhead * n);
      for (std::size_t at = first, k = 0; at < end; at += n, ++k) {
        fill<true>(rays, at, packet_count<n>(end - at), coherence_, queries[k].ray, packets[k]);
        std::memset(queries[k].hit.geomID, 0xff, sizeof(queries[k].hit.geomID));
      }
      for (std::size_t at = first, k = 0; at < end; at += n, ++k) {
        embree_query(packets[k].valid, scene_.get(), queries[k], packets[k].coherent);
        take_hits(rays, at, packet_count<n>(end - at), queries[k], packets[k], hits);
      }
    }
  }

  template <int n>
  static int packet_count(std::size_t rays_left) {
    return static_cast<int>(std::min<std::size_t>(n, rays_left));
  }

  template <int n, class RayHits>
  void take_hits(const RayBatch& rays, std::size_t first, int count, const RayHits& query, const Packet<n>& packet,
                 const HitBatch& hits) const {
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
      return;
    }
    for (int i = 0; i < count; ++i) {
      const std::size_t ray = first + static_cast<std::size_t>(i);
      if (!packet.whole && packet.scale[i] == 0.0f) {
        hits.set(ray, test_all(rays.ray(ray)));
        continue;
      }
      hits.set(ray, to_hit(query.ray.tfar[i], query.ray.tnear[i], packet.far[i], packet.whole ? 1.0f : packet.scale[i],
                           query.hit.u[i], query.hit.v[i], query.hit.geomID[i], query.hit.primID[i]));
    }
  }

  template <int n>
  void occluded_packets(const RayBatch& rays, std::uint8_t* occluded_rays) const noexcept {
    typename PacketTypes<n>::Ray queries[kAhead];
    Packet<n> packets[kAhead];
    for (auto& query : queries) prepare(query);
    for (std::size_t first = 0; first < rays.count; first += kAhead * n) {
      const std::size_t end = std::min(rays.count, first + kAhead * n);
      for (std::size_t at = first, k = 0; at < end; at += n, ++k) {
        fill<false>(rays, at, packet_count<n>(end - at), coherence_, queries[k], packets[k]);
      }
      for (std::size_t at = first, k = 0; at < end; at += n, ++k) {
        embree_query(packets[k].valid, scene_.get(), queries[k], false);
        take_occluded(rays, at, packet_count<n>(end - at), queries[k], packets[k], occluded_rays);
      }
    }
  }

  template <int n, class Rays>
  void take_occluded(const RayBatch& rays, std::size_t first, int count, const Rays& query, const Packet<n>& packet,
                     std::uint8_t* occluded_rays) const {
    std::uint8_t found[n];
    for (int i = 0; i < n; ++i) found[i] = query.tfar[i] < 0.0f;
    if (!packet.whole) {
      for (int i = 0; i < count; ++i) {
        if (packet.scale[i] == 0.0f) found[i] = test_all(rays.ray(first + static_cast<std::size_t>(i))).has_value();
      }
    }
    if (count == n) {
      std::memcpy(occluded_rays + first, found, n);
    } else {
      std::copy_n(found, count, occluded_rays + first);
    }
  }

  /// In packets as wide as Embree has them.
  void occluded_packets(const RayBatch& rays, std::uint8_t* occluded_rays) const noexcept {
    if (packet_size_ == 16) return occluded_by_16(rays, occluded_rays);
    if (packet_size_ == 8) return occluded_by_8(rays, occluded_rays);
    occluded_packets<4>(rays, occluded_rays);
  }

#if RAYLAB_EMBREE_MAJOR < 4
  /// The batch's own arrays go to Embree, but for the ends of the intervals. A stream with a ray that is not plain is
  /// cut into packets.
  void occluded_streams(const RayBatch& rays, std::uint8_t* occluded_rays) const noexcept {
    Stream stream;
    for (std::size_t first = 0; first < rays.count; first += Stream::kMost) {
      RayBatch part{std::min(Stream::kMost, rays.count - first), {}, {}, rays.t_min + first, rays.t_max + first};
      for (int axis = 0; axis < 3; ++axis) {
        part.origin[axis] = rays.origin[axis] + first;
        part.direction[axis] = rays.direction[axis] + first;
      }
      if (!stream.fill(part)) {
        occluded_packets(part, occluded_rays + first);
        continue;
      }
      stream.query_occluded(scene_.get(), part);
      for (std::size_t i = 0; i < part.count; ++i) occluded_rays[first + i] = stream.far[i] < 0.0f;
    }
  }
#endif

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
    const auto valid = std::count_if(geometry.spheres.begin(), geometry.spheres.end(), is_embree_sphere);
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

  const Geometry& geometry_;
  RTCBuildQuality quality_;
  int packet_size_ = 4;  ///< the most that Embree traces natively
  int closest_packet_size_ = 4;
  Coherence coherence_;
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
