// `bvh`: Raylab's own tree. See layout.hpp for what it is made of, traverse.hpp for how it is traversed.
#include <algorithm>
#include <bit>
#include <cmath>
#include <string>

#include "../backends.hpp"
#include "kernel.hpp"
#include "raylab/core/error.hpp"
#include "raylab/core/parallel.hpp"
#include "raylab/core/timing.hpp"
#include "wide_tree.hpp"

namespace raylab {

namespace bvh {

namespace {

const Kernel& kernel_of(Isa isa) {
  switch (isa) {
    case Isa::avx512:
      return kKernelAvx512;
    case Isa::avx2:
      return kKernelAvx2;
    case Isa::sse42:
      break;
  }
  return kKernelSse42;
}

const Kernel& choose_kernel(std::optional<Isa> forced) {
  if (forced && !isa_supported(*forced)) {
    throw Error(ErrorKind::usage, "--isa", "this processor has no " + std::string(isa_name(*forced)));
  }
  return kernel_of(forced.value_or(newest_isa()));
}

/// Rays whose directions are not of one octant are better traced alone where in a packet each of them would visit
/// more nodes and blocks alone than this: one in a tree larger than the caches of a core, since rays that
/// take turns wait for memory together. Measured on diffuse rays of the dragon (5 visits: 1.2 times as fast
/// alone), the bunny (2.5: 0.85) and synthetic geometry of 10^3 to 10^6 primitives.
constexpr std::size_t kMostVisitsAlone = 4;
constexpr std::size_t kLargeTree = std::size_t{4} << 20;  // bytes

/// kDirectionRange for the book's triangle test. Its faults depend on the scale, so they are let be as far as the
/// box test can.
constexpr float kBookDirectionRange = 0x1p120f;

class Bvh final : public Accelerator {
 public:
  Bvh(const Geometry& geometry, const AcceleratorOptions& options)
      : context_{&geometry, nullptr}, kernel_(choose_kernel(options.isa)) {
    const Intersector intersector = options.intersector.value_or(Intersector::watertight);
    intersect_ = kernel_.intersect[static_cast<std::size_t>(intersector)];
    occluded_ = kernel_.occluded[static_cast<std::size_t>(intersector)];
    traces_packets_ = intersector == Intersector::watertight;
    if (intersector == Intersector::book) direction_range_ = kBookDirectionRange;
    const Stopwatch watch;
    {
      const ThreadLimit limit(options.threads);
      const FlushDenormals flush;
      tree_ = build_wide_tree(geometry, options.quality.value_or(BvhQuality::balanced));
    }
    context_.ids = tree_.ids.data();
    view_ = {tree_.lines.data(), tree_.root, tree_.ids.data(), &context_};
    report_.seconds = watch.seconds();
    report_.bytes = sizeof(*this) + tree_.bytes();
    if (report_.bytes > kLargeTree) most_visits_alone_ = 1;
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
    KernelRay query;
    float scale;
    if (!make_query(ray, query, scale)) return std::nullopt;
    const KernelHit hit = intersect_(view_, query);
    if (hit.place == kNoPrimitive) return std::nullopt;
    const PrimitiveId& id = tree_.ids[hit.place];
    return Hit{hit.t * scale, hit.u, hit.v, id.geometry, id.primitive};
  }

  bool occluded(const Ray& ray) const noexcept override {
    KernelRay query;
    float scale;
    return make_query(ray, query, scale) && occluded_(view_, query);
  }

  void intersect_batch(const RayBatch& rays, const HitBatch& hits) const noexcept override {
    if (!traces_packets_) return Accelerator::intersect_batch(rays, hits);
    trace(rays, kernel_.intersect_packet, kernel_.intersect_rays,
          [&](std::size_t i, float t, float u, float v, std::uint32_t place) {
            hits.geometry[i] = HitBatch::kNoHit;
            if (place == kNoPrimitive) return;
            hits.t[i] = t;
            hits.u[i] = u;
            hits.v[i] = v;
            hits.geometry[i] = tree_.ids[place].geometry;
            hits.primitive[i] = tree_.ids[place].primitive;
          });
  }

  void occluded_batch(const RayBatch& rays, std::uint8_t* occluded_rays) const noexcept override {
    if (!traces_packets_) return Accelerator::occluded_batch(rays, occluded_rays);
    trace(rays, kernel_.occluded_packet, kernel_.occluded_rays,
          [&](std::size_t i, float, float, float, std::uint32_t place) {
            occluded_rays[i] = place != kNoPrimitive;
          });
  }

  const BuildReport& build_report() const noexcept override { return report_; }

 private:
  /// Rays of a batch that are to be answered one by one.
  struct RayList {
    static constexpr int kMost = 128;
    KernelRay queries[kMost];
    KernelHit hits[kMost];
    float scale[kMost];
    std::size_t ray[kMost];
    int count = 0;
  };

  /// Answers a batch: packet by packet, as long as the rays of a packet stay together on most of their way; once
  /// they turn out not to, ray by ray, but for packets of one octant. take(i, t, u, v, place) is given each
  /// answer.
  template <class TracePacket, class TraceRays, class Take>
  void trace(const RayBatch& rays, TracePacket trace_packet, TraceRays trace_rays, const Take& take) const {
    RayList list;
    const auto trace_list = [&] {
      trace_rays(view_, list.queries, list.count, list.hits);
      for (int i = 0; i < list.count; ++i) {
        const KernelHit& hit = list.hits[i];
        take(list.ray[i], hit.t * list.scale[i], hit.u, hit.v, hit.place);
      }
      list.count = 0;
    };
    const auto width = static_cast<std::size_t>(kernel_.packet);
    std::size_t in_packets = 0, visits_alone = 0;
    for (std::size_t first = 0; first < rays.count; first += width) {
      const std::size_t count = std::min(width, rays.count - first);
      std::uint32_t left_out = (1u << count) - 1u;
      if (visits_alone <= most_visits_alone_ * in_packets || is_coherent(rays, first, count)) {
        Padded padded;
        PacketHits found{};
        left_out = trace_packet(view_, packet_of(rays, first, count, padded), found);
        in_packets += count;
        visits_alone += static_cast<std::size_t>(found.turns);
        for (std::size_t i = 0; i < count; ++i)
          take(first + i, found.t[i], found.u[i], found.v[i], found.place[i]);
      }
      for (; left_out != 0; left_out &= left_out - 1) {
        const std::size_t i = first + static_cast<std::size_t>(__builtin_ctz(left_out));
        list.ray[list.count] = i;
        if (make_query(rays.ray(i), list.queries[list.count], list.scale[list.count]))
          ++list.count;
        else
          take(i, 0.0f, 0.0f, 0.0f, kNoPrimitive);
      }
      if (list.count + kLargestPacket > RayList::kMost) trace_list();
    }
    trace_list();
  }

  /// Whether all directions are of one octant.
  static bool is_coherent(const RayBatch& rays, std::size_t first, std::size_t count) {
    std::uint32_t differ = 0;
    for (const float* direction : rays.direction) {
      const auto bits = [&](std::size_t i) { return std::bit_cast<std::uint32_t>(direction[first + i]); };
      for (std::size_t i = 1; i < count; ++i) differ |= bits(i) ^ bits(0);
    }
    return differ >> 31 == 0;
  }

  struct Padded {
    alignas(64) float values[8][kLargestPacket];
  };
  PacketRays packet_of(const RayBatch& rays, std::size_t first, std::size_t count, Padded& padded) const {
    PacketRays packet{{rays.origin[0] + first, rays.origin[1] + first, rays.origin[2] + first},
                      {rays.direction[0] + first, rays.direction[1] + first, rays.direction[2] + first},
                      rays.t_min + first,
                      rays.t_max + first,
                      (1u << count) - 1u};
    const auto width = static_cast<std::size_t>(kernel_.packet);
    if (count < width) {  // whole vectors are read
      const auto pad = [&](const float*& from, float* to) {
        std::fill_n(std::copy_n(from, count, to), width - count, 0.0f);
        from = to;
      };
      for (int axis = 0; axis < 3; ++axis) {
        pad(packet.origin[axis], padded.values[axis]);
        pad(packet.direction[axis], padded.values[3 + axis]);
      }
      pad(packet.t_min, padded.values[6]);
      pad(packet.t_max, padded.values[7]);
    }
    return packet;
  }

  /// False where nothing can be hit. Directions whose reciprocal is out of range are multiplied by a power of two,
  /// and so is the reciprocal of t: by `scale` it becomes what it should be.
  bool make_query(const Ray& ray, KernelRay& query, float& scale) const {
    if (!(ray.t_min < ray.t_max)) return false;
    scale = 1.0f;
    const vec3 size = glm::abs(ray.direction);
    const float largest = max_component(size);
    query = {{ray.origin.x, ray.origin.y, ray.origin.z},
             {ray.direction.x, ray.direction.y, ray.direction.z},
             ray.t_min,
             ray.t_max < kInfinity ? next_float_down(ray.t_max) : std::numeric_limits<float>::max()};
    if (!(largest <= direction_range_ && largest * direction_range_ >= 1.0f)) [[unlikely]] {
      if (!(largest > 0.0f)) return false;
      scale = std::ldexp(1.0f, -std::clamp(std::ilogb(largest), -126, 126));
      for (float& d : query.direction) d *= scale;
      query.t_min /= scale;
      // What would be a denormal counts as 0, as it would without scaling.
      constexpr float smallest = std::numeric_limits<float>::min();
      if (scale < 1.0f) query.t_min = std::max(query.t_min, next_float_down(smallest / scale));
      query.limit = std::min(query.limit / scale, std::numeric_limits<float>::max());
    }
    return true;
  }

  bvh::WideTree tree_;
  Context context_;
  const Kernel& kernel_;
  TreeView view_{};
  KernelHit (*intersect_)(const TreeView&, const KernelRay&) noexcept;
  bool (*occluded_)(const TreeView&, const KernelRay&) noexcept;
  float direction_range_ = kDirectionRange;
  bool traces_packets_;
  std::size_t most_visits_alone_ = kMostVisitsAlone;
  BuildReport report_;
};

}  // namespace

}  // namespace bvh

std::unique_ptr<Accelerator> make_bvh(const Geometry& geometry, const AcceleratorOptions& options) {
  return std::make_unique<bvh::Bvh>(geometry, options);
}

}  // namespace raylab
