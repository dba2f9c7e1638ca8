// `bvh`: Raylab's own tree. See layout.hpp for what it is made of, traverse.hpp for how it is traversed.
#include <algorithm>
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

/// What the functions that the traversal calls back need.
struct Context {
  const Geometry* geometry;
  const PrimitiveId* ids;
};

const Context& as_context(const void* context) { return *static_cast<const Context*>(context); }

Ray as_ray(const KernelRay& ray, float limit) {
  return {{ray.origin[0], ray.origin[1], ray.origin[2]},
          {ray.direction[0], ray.direction[1], ray.direction[2]},
          ray.t_min,
          next_float_up(limit)};
}

}  // namespace

template <Intersector kind>
bool hit_sphere(const void* context, std::uint32_t place, const KernelRay& ray, float limit, float& t) noexcept {
  const Sphere& sphere = as_context(context).geometry->spheres[as_context(context).ids[place].primitive];
  const Ray own = as_ray(ray, limit);
  const auto hit = kind == Intersector::book ? intersect_sphere_book(own, sphere, own.t_min, own.t_max)
                                             : intersect_sphere(own, sphere, own.t_min, own.t_max);
  if (!hit) return false;
  t = *hit;
  return true;
}
template bool hit_sphere<Intersector::book>(const void*, std::uint32_t, const KernelRay&, float, float&) noexcept;
template bool hit_sphere<Intersector::fast>(const void*, std::uint32_t, const KernelRay&, float, float&) noexcept;
template bool hit_sphere<Intersector::watertight>(const void*, std::uint32_t, const KernelRay&, float,
                                                  float&) noexcept;

namespace {

template <class Block>
Triangle triangle_of(const Block& block, int lane) {
  Triangle triangle;
  for (int axis = 0; axis < 3; ++axis) {
    triangle.p0[axis] = block.position[axis][corner_of(block, 0, lane)];
    triangle.p1[axis] = block.position[axis][corner_of(block, 1, lane)];
    triangle.p2[axis] = block.position[axis][corner_of(block, 2, lane)];
  }
  return triangle;
}

}  // namespace

template <class Block>
bool hit_triangle_again(const Block& block, int lane, const KernelRay& ray, float limit, KernelHit& hit) noexcept {
  const Ray own = as_ray(ray, limit);
  const auto found = intersect_watertight(WatertightRay(own), triangle_of(block, lane), own.t_min, own.t_max);
  if (!found) return false;
  hit = {found->t, found->u, found->v, block.first + static_cast<std::uint32_t>(lane)};
  return true;
}

template <class Block>
float plane_distance(const Block& block, int lane, const KernelRay& ray, float otherwise) noexcept {
  return detail::watertight_plane_distance({ray.origin[0], ray.origin[1], ray.origin[2]},
                                           {ray.direction[0], ray.direction[1], ray.direction[2]},
                                           triangle_of(block, lane), otherwise);
}

template <class Block>
void block_normal(const Block& block, int lane, double (&normal)[3]) noexcept {
  const dvec3 n = detail::triangle_normal(triangle_of(block, lane));
  normal[0] = n.x;
  normal[1] = n.y;
  normal[2] = n.z;
}

template bool hit_triangle_again(const SharedBlock&, int, const KernelRay&, float, KernelHit&) noexcept;
template bool hit_triangle_again(const SeparateBlock&, int, const KernelRay&, float, KernelHit&) noexcept;
template float plane_distance(const SharedBlock&, int, const KernelRay&, float) noexcept;
template float plane_distance(const SeparateBlock&, int, const KernelRay&, float) noexcept;
template void block_normal(const SharedBlock&, int, double (&)[3]) noexcept;
template void block_normal(const SeparateBlock&, int, double (&)[3]) noexcept;

void sphere_at(const void* context, std::uint32_t place, float (&sphere)[4]) noexcept {
  const Sphere& s = as_context(context).geometry->spheres[as_context(context).ids[place].primitive];
  sphere[0] = s.center.x;
  sphere[1] = s.center.y;
  sphere[2] = s.center.z;
  sphere[3] = s.radius;
}

bool id_precedes(const void* context, std::uint32_t a, std::uint32_t b) noexcept {
  const PrimitiveId& x = as_context(context).ids[a];
  const PrimitiveId& y = as_context(context).ids[b];
  return x.geometry != y.geometry ? x.geometry < y.geometry : x.primitive < y.primitive;
}

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
      const std::optional<ThreadLimit> limit =
          options.threads > 0 ? std::optional<ThreadLimit>(std::in_place, options.threads) : std::nullopt;
      const FlushDenormals flush;
      tree_ = build_wide_tree(geometry, options.quality.value_or(BvhQuality::balanced));
    }
    context_.ids = tree_.ids.data();
    view_ = {tree_.lines.data(), tree_.root, &context_};
    report_.seconds = watch.seconds();
    report_.bytes = sizeof(*this) + tree_.bytes();
    report_.primitives = tree_.ids.size();
    report_.invalid_primitives = geometry.primitive_count() - tree_.ids.size();
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
    for_each_packet(rays, [&](std::size_t first, std::size_t count, const PacketRays& packet) {
      PacketHits found;
      const std::uint32_t left_out = kernel_.intersect_packet(view_, packet, found);
      for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t place = found.place[i];
        hits.geometry[first + i] = HitBatch::kNoHit;
        if (place == kNoPrimitive) continue;
        hits.t[first + i] = found.t[i];
        hits.u[first + i] = found.u[i];
        hits.v[first + i] = found.v[i];
        hits.geometry[first + i] = tree_.ids[place].geometry;
        hits.primitive[first + i] = tree_.ids[place].primitive;
      }
      for (std::uint32_t left = left_out; left != 0; left &= left - 1) {
        const std::size_t i = first + static_cast<std::size_t>(__builtin_ctz(left));
        hits.set(i, intersect(rays.ray(i)));
      }
    });
  }

  void occluded_batch(const RayBatch& rays, std::uint8_t* occluded_rays) const noexcept override {
    if (!traces_packets_) return Accelerator::occluded_batch(rays, occluded_rays);
    for_each_packet(rays, [&](std::size_t first, std::size_t count, const PacketRays& packet) {
      std::uint32_t found;
      const std::uint32_t left_out = kernel_.occluded_packet(view_, packet, found);
      for (std::size_t i = 0; i < count; ++i) {
        occluded_rays[first + i] =
            (left_out >> i & 1u) != 0 ? occluded(rays.ray(first + i)) : static_cast<std::uint8_t>(found >> i & 1u);
      }
    });
  }

  const BuildReport& build_report() const noexcept override { return report_; }

 private:
  /// Calls body(first, count, packet) for the rays [first, first + count) of the batch.
  template <class Body>
  void for_each_packet(const RayBatch& rays, const Body& body) const {
    const auto width = static_cast<std::size_t>(kernel_.packet);
    for (std::size_t first = 0; first < rays.count; first += width) {
      const std::size_t count = std::min(width, rays.count - first);
      PacketRays packet{{rays.origin[0] + first, rays.origin[1] + first, rays.origin[2] + first},
                        {rays.direction[0] + first, rays.direction[1] + first, rays.direction[2] + first},
                        rays.t_min + first,
                        rays.t_max + first,
                        (1u << count) - 1u};
      alignas(64) float padded[8][kLargestPacket];
      if (count < width) {  // whole vectors are read
        const auto pad = [&](const float*& from, float* to) {
          std::fill_n(std::copy_n(from, count, to), width - count, 0.0f);
          from = to;
        };
        for (int axis = 0; axis < 3; ++axis) {
          pad(packet.origin[axis], padded[axis]);
          pad(packet.direction[axis], padded[3 + axis]);
        }
        pad(packet.t_min, padded[6]);
        pad(packet.t_max, padded[7]);
      }
      body(first, count, packet);
    }
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
      scale = std::ldexp(1.0f, std::clamp(-std::ilogb(largest), -126, 126));
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
  BuildReport report_;
};

}  // namespace

}  // namespace bvh

std::unique_ptr<Accelerator> make_bvh(const Geometry& geometry, const AcceleratorOptions& options) {
  return std::make_unique<bvh::Bvh>(geometry, options);
}

}  // namespace raylab
