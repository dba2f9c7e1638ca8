// raylab-bench embree: what our backends leave of Embree's speed. Beside them bare loops ask the same scenes, of rays
// that lie in Embree's own structures already.
#include <algorithm>
#include <cstring>

#include "accel/embree/api.hpp"
#include "raylab/core/parallel.hpp"
#include "raylab/measure/batch_queries.hpp"
#include "raylab/measure/path_rays.hpp"
#include "raylab/measure/ray_sets.hpp"
#include "suite.hpp"

namespace raylab::bench {

namespace {

struct Rays {
  std::string kind;
  Query query;
  std::vector<Ray> rays;
};

/// Rays of whole packets alone, so that no bare loop has lanes to mask.
constexpr std::size_t kPacket = 16;

std::vector<Rays> rays_of(const LoadedScene& loaded, const RaysOptions& options) {
  const Scene& scene = loaded.scene;
  const auto walker = make_accelerator(kDefaultAccelerator, scene.geometry);
  IntegratorSettings settings;
  settings.max_depth = scene.render.max_depth;
  std::vector<Rays> all;
  for (RaySet& set : path_ray_sets(scene, loaded.camera, *walker, settings, options.rays, options.seed)) {
    all.push_back({std::string(ray_kind_name(set.kind)),
                   set.kind == RayKind::shadow ? Query::occluded : Query::intersect, std::move(set.rays)});
  }
  all.push_back({"random", Query::intersect, random_rays(scene.geometry.bounds(), options.rays, options.seed)});
  for (Rays& set : all) set.rays.resize(set.rays.size() / kPacket * kPacket);
  return all;
}

/// A way to ask for all the rays.
struct Way {
  std::string name;
  std::function<void()> pass;
};

/// Writes the ray to one place of each array, or to the variables of a single ray.
template <class Embree, class Select>
void write(const Ray& ray, Embree& out, const Select& select) {
  select(out.org_x) = ray.origin.x;
  select(out.org_y) = ray.origin.y;
  select(out.org_z) = ray.origin.z;
  select(out.dir_x) = ray.direction.x;
  select(out.dir_y) = ray.direction.y;
  select(out.dir_z) = ray.direction.z;
  select(out.tnear) = ray.t_min;
  select(out.tfar) = ray.t_max;
  select(out.time) = 0.0f;
  select(out.mask) = ~0u;
  select(out.id) = 0;
  select(out.flags) = 0;
}

// Embree answers in place: before it is asked again, all that a bare loop does is to set back the ends of the rays
// and what they hit.

std::vector<Way> singles(RTCScene scene, const Rays& set) {
  const auto same = [](auto& value) -> auto& { return value; };
  if (set.query == Query::occluded) {
    std::vector<RTCRay> all(set.rays.size());
    for (std::size_t i = 0; i < all.size(); ++i) write(set.rays[i], all[i], same);
    return {{"1", [scene, &set, all]() mutable {
               for (std::size_t i = 0; i < all.size(); ++i) {
                 all[i].tfar = set.rays[i].t_max;
                 embree_query(scene, all[i]);
               }
             }}};
  }
  std::vector<RTCRayHit> all(set.rays.size());
  for (std::size_t i = 0; i < all.size(); ++i) write(set.rays[i], all[i].ray, same);
  return {{"1", [scene, &set, all]() mutable {
             for (std::size_t i = 0; i < all.size(); ++i) {
               all[i].ray.tfar = set.rays[i].t_max;
               all[i].hit.geomID = RTC_INVALID_GEOMETRY_ID;
               embree_query(scene, all[i]);
             }
           }}};
}

template <class Packet>
auto& rays_in(Packet& packet) {
  if constexpr (requires { packet.ray; }) {
    return packet.ray;
  } else {
    return packet;
  }
}

template <int n, class Packet>
std::vector<Way> packets(RTCScene scene, const Rays& set) {
  std::vector<Packet> all(set.rays.size() / n);
  std::vector<float> ends;
  for (std::size_t i = 0; i < set.rays.size(); ++i) {
    write(
        set.rays[i], rays_in(all[i / n]), [&](auto& array) -> auto& { return array[i % n]; });
    ends.push_back(set.rays[i].t_max);
  }
  std::vector<Way> ways;
  for (const bool coherent : {false, true}) {
    ways.push_back({std::to_string(n) + (coherent ? "c" : ""), [scene, coherent, all, ends]() mutable {
                      alignas(64) int valid[n];
                      std::fill_n(valid, n, -1);
                      const float* end = ends.data();
                      for (Packet& packet : all) {
                        std::memcpy(rays_in(packet).tfar, end, sizeof(valid));
                        if constexpr (requires { packet.hit; }) std::memset(packet.hit.geomID, 0xff, sizeof(valid));
                        embree_query(valid, scene, packet, coherent);
                        end += n;
                      }
                    }});
  }
  return ways;
}

template <int n>
std::vector<Way> packets(RTCScene scene, const Rays& set) {
  if (set.query == Query::occluded) return packets<n, typename PacketTypes<n>::Ray>(scene, set);
  return packets<n, typename PacketTypes<n>::RayHit>(scene, set);
}

#if RAYLAB_EMBREE_MAJOR < 4
/// Streams of as many rays as the renderer sends at once.
std::vector<Way> streams(RTCScene scene, const Rays& set) {
  static constexpr std::size_t kMost = BatchedRays::kMost;
  using Stream = RTCRayHitNt<kMost>;
  std::vector<Stream> all((set.rays.size() + kMost - 1) / kMost);
  std::vector<float> ends;
  for (std::size_t i = 0; i < set.rays.size(); ++i) {
    write(
        set.rays[i], all[i / kMost].ray, [&](auto& array) -> auto& { return array[i % kMost]; });
    ends.push_back(set.rays[i].t_max);
  }
  std::vector<Way> ways;
  for (const bool coherent : {false, true}) {
    ways.push_back({coherent ? "Npc" : "Np", [scene, coherent, all, ends, query = set.query]() mutable {
                      RTCIntersectContext context;
                      rtcInitIntersectContext(&context);
                      if (coherent) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
                      for (std::size_t first = 0; first < ends.size(); first += kMost) {
                        Stream& s = all[first / kMost];
                        const std::size_t count = std::min(kMost, ends.size() - first);
                        std::memcpy(s.ray.tfar, ends.data() + first, count * sizeof(float));
                        RTCRayNp ray{s.ray.org_x, s.ray.org_y, s.ray.org_z, s.ray.tnear, s.ray.dir_x, s.ray.dir_y,
                                     s.ray.dir_z, s.ray.time,  s.ray.tfar,  s.ray.mask,  s.ray.id,    s.ray.flags};
                        if (query == Query::occluded) {
                          rtcOccludedNp(scene, &context, &ray, static_cast<unsigned>(count));
                        } else {
                          std::memset(s.hit.geomID, 0xff, count * sizeof(unsigned));
                          RTCRayHitNp both{ray,
                                           {s.hit.Ng_x,
                                            s.hit.Ng_y,
                                            s.hit.Ng_z,
                                            s.hit.u,
                                            s.hit.v,
                                            s.hit.primID,
                                            s.hit.geomID,
                                            {s.hit.instID[0]}}};
                          rtcIntersectNp(scene, &context, &both, static_cast<unsigned>(count));
                        }
                      }
                    }});
  }
  return ways;
}
#endif

std::vector<Way> bare_ways(RTCScene scene, const Rays& set) {
  std::vector<Way> ways;
  const auto add = [&](std::vector<Way>&& more) { std::move(more.begin(), more.end(), std::back_inserter(ways)); };
  add(singles(scene, set));
  add(packets<8>(scene, set));
  add(packets<16>(scene, set));
#if RAYLAB_EMBREE_MAJOR < 4
  add(streams(scene, set));
#endif
  return ways;
}

/// Our backend, ray by ray and in batches.
std::vector<Way> own_ways(const Accelerator& accelerator, const Rays& set) {
  return {
      {"single",
       [&accelerator, &set] {
         for (const Ray& ray : set.rays) {
           if (set.query == Query::occluded) {
             (void)accelerator.occluded(ray);
           } else {
             (void)accelerator.intersect(ray);
           }
         }
       }},
      {"batch", [&accelerator, query = set.query, batches = BatchedRays(set.rays), hits = HitArrays(BatchedRays::kMost),
                 occluded = std::vector<std::uint8_t>(BatchedRays::kMost)]() mutable {
         for (std::size_t b = 0; b < batches.batches(); ++b) {
           if (query == Query::occluded) {
             accelerator.occluded_batch(batches.batch(b), occluded.data());
           } else {
             accelerator.intersect_batch(batches.batch(b), hits.batch());
           }
         }
       }}};
}

void measure(Suite& suite, const Scene& scene, const Built& built, const Accelerator& bvh, const Rays& set, int repeats,
             const std::string& part) {
  std::vector<Way> ways = own_ways(*built.accelerator, set);
  ways.push_back(own_ways(bvh, set).back());
  ways.back().name = "bvh batch";
  const std::size_t own = ways.size();
  for (Way& way : bare_ways(embree_scene(*built.accelerator), set)) ways.push_back(std::move(way));
  const auto times = time_interleaved(
      ways.size(), Repeats{repeats}, [&](std::size_t i) { ways[i].pass(); },
      [&] {
        suite.check();
        return false;
      });
  Row row{{"suite", "embree"}, {"scene", scene.name}, {"rays", set.kind}, {"threads", 1}};
  add_fields(row, built.variant, scene.geometry, built);
  std::string line = format("%-12s %-8s %-14s", scene.name.c_str(), set.kind.c_str(), built.variant.accel.c_str());
  double fastest = 0.0;
  double batch = 0.0;
  double bvh_batch = 0.0;
  for (std::size_t i = 0; i < ways.size(); ++i) {
    std::vector<double> speeds;
    for (const double s : times[i].cpu) speeds.push_back(1e-6 * static_cast<double>(set.rays.size()) / s);
    const Spread speed = spread_of(speeds);
    line += format(" %s %.2f", ways[i].name.c_str(), speed.median);
    if (i == 0) {
      row["mrays_per_second"] = to_row(speed);
    } else if (i == 1) {
      row["mrays_per_second_batch"] = to_row(speed);
      batch = speed.median;
    } else if (i < own) {
      bvh_batch = speed.median;
    } else {
      if (speed.median > fastest) row["fastest_bare"] = ways[i].name;
      fastest = std::max(fastest, speed.median);
    }
    if (i + 1 == own) line += "; bare";
  }
  row["mrays_per_second_bare"] = fastest;
  row["rays_timed"] = set.rays.size();
  row["batch_of_fastest_bare"] = batch / fastest;
  row["bvh_of_fastest_bare"] = bvh_batch / fastest;
  suite.add({row}, {line + format("; batch of the fastest bare %.2f, bvh %.2f", batch / fastest, bvh_batch / fastest)},
            part);
}

}  // namespace

int embree(const RaysOptions& options) {
  Suite suite(options, "embree");
  const InterruptGuard guard;
  constexpr double kKinds = 4.0;
  suite.expect(2.0 * kKinds * static_cast<double>(options.scenes.size()));
  const ThreadLimit one_thread(1);
  for (const std::string& file : options.scenes) {
    const LoadedScene loaded = load(suite, file);
    const Scene& scene = loaded.scene;
    const std::vector<Rays> sets = rays_of(loaded, options);
    const auto bvh = make_accelerator(kDefaultAccelerator, scene.geometry);
    for (const char* name : {"embree", "embree-robust"}) {
      const Built built = build({name, "", BuildQuality::balanced, false}, scene.geometry, 1);
      for (const Rays& set : sets) {
        const std::string part = file + " " + set.kind + " " + name;
        if (!set.rays.empty() && !suite.measured(part)) measure(suite, scene, built, *bvh, set, options.repeats, part);
        suite.advance(1.0);
      }
    }
  }
  suite.finish();
  return 0;
}

}  // namespace raylab::bench
