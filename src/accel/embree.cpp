// `embree` and `embree-robust`: Intel Embree 3 or 4, the same source for both.
// Triangles are Embree's own. Spheres are ours, by callback: Embree's have no stable roots and miss the ground
// sphere of radius 1e6 by 13% of the distance.
#include <algorithm>
#include <atomic>
#include <cfloat>
#include <cmath>
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

/// The ray as Embree takes it, and the power of two its direction was multiplied by.
/// Embree's modes differ at the ends of the interval: robust includes t_min, fast excludes it, both include
/// t_max. So the ends are moved inward by one float; and off zero, since a denormal t_min counts as zero.
float to_embree(const Ray& ray, RTCRay& out) {
  const vec3 size = glm::abs(ray.direction);
  const float largest = max_component(size);
  float scale = 1.0f;
  if (largest > 0.0f && !(largest <= kLargestDirection && largest >= kSmallestDirection)) {
    scale = std::ldexp(1.0f, -std::clamp(std::ilogb(largest), -126, 126));
  }
  out.org_x = ray.origin.x;
  out.org_y = ray.origin.y;
  out.org_z = ray.origin.z;
  out.dir_x = ray.direction.x * scale;
  out.dir_y = ray.direction.y * scale;
  out.dir_z = ray.direction.z * scale;
  out.tnear = std::max(next_float_up(ray.t_min) / scale, FLT_MIN);
  out.tfar = next_float_down(ray.t_max) / scale;
  out.time = 0.0f;
  out.mask = ~0u;  // the default differs between Embree 3 and 4
  out.id = 0;
  out.flags = 0;
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
  out.time[i] = 0.0f;
  out.mask[i] = ~0u;
  out.id[i] = 0;
  out.flags[i] = 0;
  return scale;
}

bool hit_sphere(void* user, unsigned primitive, const RTCRay& ray, float& t) {
  const Ray own{{ray.org_x, ray.org_y, ray.org_z}, {ray.dir_x, ray.dir_y, ray.dir_z}};
  const Sphere& sphere = static_cast<const Geometry*>(user)->spheres[primitive];
  // Embree's interval is closed, ours is open.
  const auto hit = PrimitiveTest<Intersector::fast>(own).sphere(sphere, next_float_down(ray.tnear),
                                                               next_float_up(ray.tfar));
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
    return to_hit(query.ray.tfar, tnear, tfar, scale, query.hit.u, query.hit.v, query.hit.geomID,
                  query.hit.primID);
  }

  bool occluded(const Ray& ray) const noexcept override {
    RTCRay query;
    to_embree(ray, query);
    if (!(query.tnear <= query.tfar)) return false;
    embree_query(scene_.get(), query);
    return query.tfar < 0.0f;
  }

  void intersect_batch(const RayBatch& rays, const HitBatch& hits) const noexcept override {
    in_packets([&](auto size) { intersect_packets<decltype(size)::value>(rays, hits); });
  }

  void occluded_batch(const RayBatch& rays, std::uint8_t* occluded_rays) const noexcept override {
    in_packets([&](auto size) { occluded_packets<decltype(size)::value>(rays, occluded_rays); });
  }

  const BuildReport& build_report() const noexcept override { return report_; }

 private:
  std::optional<Hit> to_hit(float t, float tnear, float tfar, float scale, float u, float v, unsigned geometry,
                            unsigned primitive) const {
    if (geometry == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    // Embree compares t times a determinant, so the quotient it reports can be a float outside the interval.
    // Clamped, the answer stays the one that occluded() gives.
    const auto& original = original_[geometry];
    return Hit{std::clamp(t, tnear, tfar) * scale, u, v, geometry,
               original.empty() ? primitive : original[primitive]};
  }

  /// Calls body with the packet size that this Embree traces natively.
  template <class Body>
  void in_packets(const Body& body) const {
    if (packet_size_ == 16) return body(std::integral_constant<int, 16>());
    if (packet_size_ == 8) return body(std::integral_constant<int, 8>());
    body(std::integral_constant<int, 4>());
  }

  template <int n>
  void intersect_packets(const RayBatch& rays, const HitBatch& hits) const noexcept {
    for (std::size_t first = 0; first < rays.count; first += n) {
      const int count = static_cast<int>(std::min<std::size_t>(n, rays.count - first));
      typename PacketTypes<n>::RayHit query;
      alignas(64) int valid[n] = {};
      float tnear[n], tfar[n], scale[n];
      for (int i = 0; i < count; ++i) {
        scale[i] = to_embree(rays.ray(first + static_cast<std::size_t>(i)), query.ray, i);
        tnear[i] = query.ray.tnear[i];
        tfar[i] = query.ray.tfar[i];
        valid[i] = tnear[i] <= tfar[i] ? -1 : 0;
        query.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      }
      embree_query(valid, scene_.get(), query);
      for (int i = 0; i < count; ++i) {
        hits.set(first + static_cast<std::size_t>(i),
                 to_hit(query.ray.tfar[i], tnear[i], tfar[i], scale[i], query.hit.u[i], query.hit.v[i],
                        query.hit.geomID[i], query.hit.primID[i]));
      }
    }
  }

  template <int n>
  void occluded_packets(const RayBatch& rays, std::uint8_t* occluded_rays) const noexcept {
    for (std::size_t first = 0; first < rays.count; first += n) {
      const int count = static_cast<int>(std::min<std::size_t>(n, rays.count - first));
      typename PacketTypes<n>::Ray query;
      alignas(64) int valid[n] = {};
      for (int i = 0; i < count; ++i) {
        to_embree(rays.ray(first + static_cast<std::size_t>(i)), query, i);
        valid[i] = query.tnear[i] <= query.tfar[i] ? -1 : 0;
      }
      embree_query(valid, scene_.get(), query);
      for (int i = 0; i < count; ++i) occluded_rays[first + i] = valid[i] != 0 && query.tfar[i] < 0.0f ? 1 : 0;
    }
  }

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
      rtcSetSharedGeometryBuffer(triangles.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                 mesh.positions.data(), 0, sizeof(vec3), vertices);
    } else {  // not padded: Embree would read past the end
      void* copy = new_buffer(triangles.get(), RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, sizeof(vec3), vertices);
      std::copy(mesh.positions.begin(), mesh.positions.end(), static_cast<vec3*>(copy));
    }
    if (valid.size() == count) {
      rtcSetSharedGeometryBuffer(triangles.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                 mesh.triangles.data(), 0, sizeof(uvec3), count);
    } else {
      auto* copy = static_cast<uvec3*>(
          new_buffer(triangles.get(), RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, sizeof(uvec3), valid.size()));
      for (const std::uint32_t i : valid) *copy++ = mesh.triangles[i];
      original_[id] = std::move(valid);
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

  void* new_buffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format, std::size_t stride,
                   std::size_t count) {
    void* buffer = rtcSetNewGeometryBuffer(geometry, type, 0, format, stride, count);
    if (!buffer) check_device();
    return buffer;
  }

  RTCBuildQuality quality_;
  int packet_size_ = 4;
  std::atomic<std::ptrdiff_t> bytes_{0};  // outlives the device, which counts into it
  Device device_;
  EmbreeScene scene_;
  /// For each geometry the ids of the primitives given to Embree; empty where those are all it has.
  std::vector<std::vector<std::uint32_t>> original_;
  BuildReport report_;
};

}  // namespace

std::unique_ptr<Accelerator> make_embree(const Geometry& geometry, const AcceleratorOptions& options) {
  return std::make_unique<Embree>(geometry, options, false);
}

std::unique_ptr<Accelerator> make_embree_robust(const Geometry& geometry, const AcceleratorOptions& options) {
  return std::make_unique<Embree>(geometry, options, true);
}

}  // namespace raylab
