#include "raylab/accel/accelerator.hpp"

namespace raylab {

void Accelerator::intersect_batch(const RayBatch& rays, const HitBatch& hits) const noexcept {
  for (std::size_t i = 0; i < rays.count; ++i) hits.set(i, intersect(rays.ray(i)));
}

void Accelerator::occluded_batch(const RayBatch& rays, std::uint8_t* occluded_rays) const noexcept {
  for (std::size_t i = 0; i < rays.count; ++i) occluded_rays[i] = occluded(rays.ray(i)) ? 1 : 0;
}

}  // namespace raylab
