// `bvh`: Raylab's own tree. See layout/ for what it is made of, build/ for how it is made, traverse/ for how it is
// traversed.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "../backends.hpp"
#include "build/collapse.hpp"
#include "raylab/core/parallel.hpp"
#include "raylab/core/timing.hpp"
#include "traverse/kernel.hpp"

namespace raylab {

namespace bvh {

namespace {

const Kernel& kernel_of([[maybe_unused]] Isa isa) {
#if defined(__x86_64__)
  if (isa == Isa::avx512) return kKernelAvx512;
  if (isa == Isa::avx2) return kKernelAvx2;
  return kKernelSse42;
#else
  return kKernelNeon;
#endif
}

/// kDirectionRange for the book's triangle test. Its faults depend on the scale, so they are let be as far as the
/// box test can.
constexpr float kBookDirectionRange = 0x1p120f;

class Bvh final : public Accelerator {
 public:
  Bvh(const Geometry& geometry, const AcceleratorOptions& options) : kernel_(kernel_of(choose_isa(options.isa))) {
    const Intersector intersector = options.intersector.value_or(Intersector::watertight);
    intersect_ = kernel_.intersect[static_cast<std::size_t>(intersector)];
    occluded_ = kernel_.occluded[static_cast<std::size_t>(intersector)];
    traces_groups_ = intersector == Intersector::watertight;
    if (intersector == Intersector::book) direction_range_ = kBookDirectionRange;
    const Stopwatch watch;
    {
      const ThreadLimit limit(options.threads);
      const FlushDenormals flush;
      tree_ = build_wide_tree(geometry, options.quality.value_or(BuildQuality::balanced));
    }
    const bool has_blocks =
        std::ranges::any_of(geometry.meshes, [](const TriangleMesh& mesh) { return !mesh.triangles.empty(); });
    view_ = {tree_.lines.data(), tree_.root, tree_.ids.data(), geometry.spheres.data(), has_blocks, tree_.nodes > 1};
    report_.seconds = watch.seconds();
    report_.bytes = sizeof(*this) + tree_.bytes();
    report_.primitives = tree_.primitives;
    report_.invalid_primitives = geometry.primitive_count() - tree_.primitives;
    report_.nodes = tree_.nodes;
    report_.depth = tree_.depth;
    report_.sah_cost = tree_.sah_cost;
    report_.isa = kernel_.isa;
  }
  Bvh(const Bvh&) = delete;
  Bvh& operator=(const Bvh&) = delete;

  std::optional<Hit> intersect(const Ray& ray) const noexcept override {
    TraversalRay query;
    float scale;
    if (!make_query(ray, query, scale)) return std::nullopt;
    const TraversalHit hit = intersect_(view_, query);
    if (hit.primitive_slot == kNoPrimitive) return std::nullopt;
    const PrimitiveId& id = tree_.ids[hit.primitive_slot];
    return Hit{hit.t * scale, hit.u, hit.v, id.geometry, id.primitive};
  }

  bool occluded(const Ray& ray) const noexcept override {
    TraversalRay query;
    float scale;
    return make_query(ray, query, scale) && occluded_(view_, query);
  }

  void intersect_batch(const RayBatch& rays, const HitBatch& hits) const noexcept override {
    if (!traces_groups_) return Accelerator::intersect_batch(rays, hits);
    for_groups(rays, kernel_.intersect_group, [&](std::size_t first, std::size_t count, const GroupHits& found) {
      std::copy_n(found.t, count, hits.t + first);
      std::copy_n(found.u, count, hits.u + first);
      std::copy_n(found.v, count, hits.v + first);
      // A value that is no slot reads the last entry, which holds kNoHit: there is no branch to mispredict.
      const PrimitiveId* const ids = tree_.ids.data();
      const auto no_slot = static_cast<std::uint32_t>(tree_.ids.size() - 1);
      for (std::size_t k = 0; k < count; ++k) {
        const PrimitiveId id = ids[std::min(found.primitive_slot[k], no_slot)];
        hits.geometry[first + k] = id.geometry;
        hits.primitive[first + k] = id.primitive;
      }
      for_left_out(found, count, [&](std::size_t k) { hits.set(first + k, intersect(rays.ray(first + k))); });
    });
  }

  void occluded_batch(const RayBatch& rays, std::uint8_t* occluded_rays) const noexcept override {
    if (!traces_groups_) return Accelerator::occluded_batch(rays, occluded_rays);
    for_groups(rays, kernel_.occluded_group, [&](std::size_t first, std::size_t count, const GroupHits& found) {
      for (std::size_t k = 0; k < count; ++k) occluded_rays[first + k] = found.primitive_slot[k] != kNoPrimitive;
      for_left_out(found, count, [&](std::size_t k) { occluded_rays[first + k] = occluded(rays.ray(first + k)); });
    });
  }

  const BuildReport& build_report() const noexcept override { return report_; }

 private:
  /// take(first, count, hits): the answers for the rays [first, first + count).
  template <class Trace, class Take>
  void for_groups(const RayBatch& rays, Trace trace, const Take& take) const {
    GroupHits hits;
    for (std::size_t first = 0; first < rays.count; first += kGroup) {
      const std::size_t count = std::min<std::size_t>(kGroup, rays.count - first);
      const RayBatch group{count,
                           {rays.origin[0] + first, rays.origin[1] + first, rays.origin[2] + first},
                           {rays.direction[0] + first, rays.direction[1] + first, rays.direction[2] + first},
                           rays.t_min + first,
                           rays.t_max + first};
      trace(view_, group, hits);
      take(first, count, hits);
    }
  }

  /// Does something for the rays that the kernel has left out, which are few.
  template <class Do>
  static void for_left_out(const GroupHits& hits, std::size_t count, const Do& do_it) {
    if (std::find(hits.primitive_slot, hits.primitive_slot + count, kLeftOut) == hits.primitive_slot + count) return;
    for (std::size_t k = 0; k < count; ++k) {
      if (hits.primitive_slot[k] == kLeftOut) do_it(k);
    }
  }

  static void store4(float (&to)[4], const vec3& v, float last) {
    using Four = float __attribute__((vector_size(16)));
    const Four four = {v.x, v.y, v.z, last};
    std::memcpy(to, &four, sizeof four);
  }

  /// Returns false where nothing can be hit. A direction whose reciprocal is out of range is multiplied by `scale`, a
  /// power of two; the ray's t is then the t found times `scale`.
  bool make_query(const Ray& ray, TraversalRay& query, float& scale) const {
    if (!(ray.t_min < ray.t_max)) return false;
    scale = 1.0f;
    const vec3 size = glm::abs(ray.direction);
    const float largest = max_component(size);
    // Written as whole vectors, as the kernel reads it: else it would have to wait for them.
    const float limit = ray.t_max < kInfinity ? next_float_down(ray.t_max) : std::numeric_limits<float>::max();
    store4(query.origin, ray.origin, ray.t_min);
    store4(query.direction, ray.direction, limit);
    if (!(largest <= direction_range_ && largest * direction_range_ >= 1.0f)) [[unlikely]] {
      if (!(largest > 0.0f)) return false;
      scale = std::ldexp(1.0f, -std::clamp(std::ilogb(largest), -126, 126));
      float t_min = ray.t_min / scale;
      // What would be a denormal counts as 0, as it would without scaling.
      constexpr float smallest = std::numeric_limits<float>::min();
      if (scale < 1.0f) t_min = std::max(t_min, next_float_down(smallest / scale));
      store4(query.origin, ray.origin, t_min);
      store4(query.direction, ray.direction * scale, std::min(limit / scale, std::numeric_limits<float>::max()));
    }
    return true;
  }

  WideTree tree_;
  const Kernel& kernel_;
  TreeView view_{};
  TraversalHit (*intersect_)(const TreeView&, const TraversalRay&) noexcept;
  bool (*occluded_)(const TreeView&, const TraversalRay&) noexcept;
  float direction_range_ = kDirectionRange;
  bool traces_groups_;
  BuildReport report_;
};

}  // namespace

}  // namespace bvh

std::unique_ptr<Accelerator> make_bvh(const Geometry& geometry, const AcceleratorOptions& options) {
  return std::make_unique<bvh::Bvh>(geometry, options);
}

}  // namespace raylab
