#pragma once
// Sets of rays to compare accelerators on. The same seed gives the same rays on every machine.
#include <cstdint>
#include <optional>
#include <random>
#include <span>
#include <vector>

#include "raylab/accel/accelerator.hpp"
#include "raylab/core/bounds.hpp"
#include "raylab/core/ray.hpp"
#include "raylab/geometry/geometry.hpp"

namespace raylab {

/// Uniform floats from a seed, alike with every standard library.
class UniformFloats {
 public:
  explicit UniformFloats(std::uint64_t seed) : engine_(seed) {}
  /// In [0, 1), a multiple of 2^-24.
  float operator()() { return static_cast<float>(engine_() >> 40) * 0x1p-24f; }
  /// In [lower, upper].
  float operator()(float lower, float upper) { return lower + (upper - lower) * (*this)(); }
  vec3 in_box(const vec3& lower, const vec3& upper) {
    const float x = (*this)(lower.x, upper.x);
    const float y = (*this)(lower.y, upper.y);
    return {x, y, (*this)(lower.z, upper.z)};
  }
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(engine_() % n); }

 private:
  std::mt19937_64 engine_;
};

/// Rays side by side, for the batch queries of accelerators.
class RayArrays {
 public:
  explicit RayArrays(std::span<const Ray> rays);
  /// `count` rays from `first` on.
  RayBatch batch(std::size_t first, std::size_t count) const;
  RayBatch batch() const { return batch(0, components_[0].size()); }

 private:
  std::vector<float> components_[8];  ///< origin, direction, t_min, t_max
};

/// Hits side by side.
class HitArrays {
 public:
  explicit HitArrays(std::size_t count) : t_(count), u_(count), v_(count), geometry_(count), primitive_(count) {}
  HitBatch batch() { return {t_.data(), u_.data(), v_.data(), geometry_.data(), primitive_.data()}; }
  std::optional<Hit> operator[](std::size_t i) const {
    if (geometry_[i] == HitBatch::kNoHit) return std::nullopt;
    return Hit{t_[i], u_[i], v_[i], geometry_[i], primitive_[i]};
  }

 private:
  std::vector<float> t_, u_, v_;
  std::vector<std::uint32_t> geometry_, primitive_;
};

/// Rays from points of the box three times the size of `bounds` through points of `bounds`, which they reach at
/// t between 0.5 and 2.
std::vector<Ray> random_rays(const Bounds& bounds, std::size_t count, std::uint64_t seed);

/// Rays along the axes through points of `bounds`, from outside; the two other components are 0 or -0 at random.
std::vector<Ray> axis_aligned_rays(const Bounds& bounds, std::size_t count, std::uint64_t seed);

/// What is no ray, each for one reason: a component that is NaN or infinite, no direction, an interval without numbers.
std::vector<Ray> faulty_rays();

/// Rays from within a closed mesh to its vertices. Their origins are uniform in the cube of half side `spread`
/// around `inside`, all of which must lie inside. Each of the rays must hit.
std::vector<Ray> rays_at_vertices(const TriangleMesh& mesh, const vec3& inside, float spread, std::size_t count,
                                  std::uint64_t seed);

/// The same to points of edges.
std::vector<Ray> rays_at_edges(const TriangleMesh& mesh, const vec3& inside, float spread, std::size_t count,
                               std::uint64_t seed);

}  // namespace raylab
