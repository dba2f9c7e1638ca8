#pragma once
// Embree 3 and 4 under one name: owners of its handles, and queries of one ray and of packets. Local to the
// including file.
#if RAYLAB_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <memory>
#include <type_traits>

#include "raylab/accel/accelerator.hpp"

namespace raylab {

/// The scene that an accelerator of make_embree or make_embree_robust traces, for measurements. It lives as long.
RTCScene embree_scene(const Accelerator& accelerator);

namespace {

struct DeviceRelease {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneRelease {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
struct GeometryRelease {
  void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
using Device = std::unique_ptr<std::remove_pointer_t<RTCDevice>, DeviceRelease>;
using EmbreeScene = std::unique_ptr<std::remove_pointer_t<RTCScene>, SceneRelease>;
using EmbreeGeometry = std::unique_ptr<std::remove_pointer_t<RTCGeometry>, GeometryRelease>;

// The last argument that Embree 4 takes and the context that Embree 3 takes, for queries of one ray and of
// packets. `coherent` says that the rays of a packet start and run alike.
#if RAYLAB_EMBREE_MAJOR >= 4
#define RAYLAB_EMBREE_QUERY(name, Query) \
  inline void embree_query(RTCScene scene, Query& query) { rtc##name##1(scene, &query, nullptr); }
#define RAYLAB_EMBREE_PACKET(name, N, Query)                                                \
  inline void embree_query(const int* valid, RTCScene scene, Query& query, bool coherent) { \
    RTC##name##Arguments arguments;                                                         \
    rtcInit##name##Arguments(&arguments);                                                   \
    if (coherent) arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;                            \
    rtc##name##N(valid, scene, &query, &arguments);                                         \
  }
#else
#define RAYLAB_EMBREE_QUERY(name, Query)                   \
  inline void embree_query(RTCScene scene, Query& query) { \
    RTCIntersectContext context;                           \
    rtcInitIntersectContext(&context);                     \
    rtc##name##1(scene, &context, &query);                 \
  }
#define RAYLAB_EMBREE_PACKET(name, N, Query)                                                \
  inline void embree_query(const int* valid, RTCScene scene, Query& query, bool coherent) { \
    RTCIntersectContext context;                                                            \
    rtcInitIntersectContext(&context);                                                      \
    if (coherent) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;                      \
    rtc##name##N(valid, scene, &context, &query);                                           \
  }
#endif
RAYLAB_EMBREE_QUERY(Intersect, RTCRayHit)
RAYLAB_EMBREE_QUERY(Occluded, RTCRay)
RAYLAB_EMBREE_PACKET(Intersect, 4, RTCRayHit4)
RAYLAB_EMBREE_PACKET(Occluded, 4, RTCRay4)
RAYLAB_EMBREE_PACKET(Intersect, 8, RTCRayHit8)
RAYLAB_EMBREE_PACKET(Occluded, 8, RTCRay8)
RAYLAB_EMBREE_PACKET(Intersect, 16, RTCRayHit16)
RAYLAB_EMBREE_PACKET(Occluded, 16, RTCRay16)
#undef RAYLAB_EMBREE_QUERY
#undef RAYLAB_EMBREE_PACKET

template <int n>
struct PacketTypes;
template <>
struct PacketTypes<4> {
  using Ray = RTCRay4;
  using RayHit = RTCRayHit4;
};
template <>
struct PacketTypes<8> {
  using Ray = RTCRay8;
  using RayHit = RTCRayHit8;
};
template <>
struct PacketTypes<16> {
  using Ray = RTCRay16;
  using RayHit = RTCRayHit16;
};

}  // namespace
}  // namespace raylab
