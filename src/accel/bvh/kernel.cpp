// What the traversal calls back, compiled for all instruction sets alike.
#include "kernel.hpp"

#include "raylab/core/numeric.hpp"

namespace raylab::bvh {

namespace {

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

template bool hit_triangle_again(const SharedBlock&, int, const KernelRay&, float, KernelHit&) noexcept;
template bool hit_triangle_again(const SeparateBlock&, int, const KernelRay&, float, KernelHit&) noexcept;
template float plane_distance(const SharedBlock&, int, const KernelRay&, float) noexcept;
template float plane_distance(const SeparateBlock&, int, const KernelRay&, float) noexcept;

bool id_precedes(const void* context, std::uint32_t a, std::uint32_t b) noexcept {
  const PrimitiveId* const ids = as_context(context).ids;
  return ids[a] < ids[b];
}

}  // namespace raylab::bvh
