#pragma once
// Rays as keys of hash tables: equal to the bit, but for the sign of zero.
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "raylab/core/random.hpp"
#include "raylab/core/ray.hpp"

namespace raylab {

inline std::array<float, 8> components_of(const Ray& r) {
  return {r.origin.x, r.origin.y, r.origin.z, r.direction.x, r.direction.y, r.direction.z, r.t_min, r.t_max};
}

struct RayEqual {
  bool operator()(const Ray& a, const Ray& b) const { return components_of(a) == components_of(b); }
};

struct RayHash {
  std::size_t operator()(const Ray& ray) const {
    std::uint64_t h = 0;
    for (const float x : components_of(ray)) h = mix_bits(h ^ std::bit_cast<std::uint32_t>(x == 0.0f ? 0.0f : x));
    return h;
  }
};

}  // namespace raylab
