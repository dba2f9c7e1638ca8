#pragma once
// Light that comes over one mirror or glass sphere: off it, or through it. A point of a light is sampled as seen from
// the sphere's centre, and the way to it over the sphere is found by solving one equation (sphere_chain_lanes.hpp).
#include <cstdint>
#include <optional>
#include <vector>

#include "lights.hpp"
#include "raylab/render/integrator.hpp"

namespace raylab {

/// Turns of a path over specular surfaces since the last vertex from which lights were sampled: 0 is none, values below
/// kSphereChains name a chain of MirrorImages, those from there on one of SphereChains.
using ChainId = std::uint32_t;
inline constexpr ChainId kSphereChains = 0x10000u;
inline bool is_over_sphere(ChainId chain) { return chain >= kSphereChains; }

/// What sampling over spheres reads, for lookup by lanes: a row for each sphere and way. There is one column for each
/// number.
struct SphereChainTable {
  static constexpr int kMost = 16;
  /// Centre, radius, index (1 of a mirror), how often the way crosses the sphere, weight at distance 1, colour.
  static constexpr int kColumns = 10;
  int count = 0;
  alignas(64) float columns[kColumns][kMost];
};

/// The spheres of smooth metal of one colour and of glass, and the ways over them: off them, and through those of glass
/// that have nothing else inside.
class SphereChains {
 public:
  SphereChains() = default;
  explicit SphereChains(const Scene& scene);

  bool empty() const { return table_.count == 0; }
  std::size_t count() const { return static_cast<std::size_t>(table_.count); }
  const SphereChainTable& table() const { return table_; }

  /// Whether a path that is turned at a sphere still follows a chain, which then goes on by it.
  bool follow(std::uint32_t sphere, bool reflected, ChainId& chain) const;

  /// The density of sampling a point of a light over the sphere, as a multiple of that of sampling it as seen from the
  /// sphere's centre; times what the turns leave of scattering's own density.
  struct Share {
    vec3 center;
    float factor;
  };
  /// From p along the ray with that unit direction, which has left the sphere, to the point of a light with unit normal
  /// ng, or if `infinite` to outside the scene.
  Share share(ChainId chain, const vec3& p, const vec3& origin, const vec3& direction, const vec3& light,
              const vec3& ng, bool infinite) const;

 private:
  // A chain's id is kSphereChains and, in bits from the lowest: whether it is inside, how often it has crossed or,
  // inside, begun to cross, and the first row of the sphere.
  static ChainId id(std::uint32_t first_row, std::uint32_t crossings, bool inside) {
    return kSphereChains | first_row << 3 | crossings << 1 | (inside ? 1u : 0u);
  }
  static bool is_inside(ChainId chain) { return (chain & 1u) != 0; }
  static std::uint32_t crossings_of(ChainId chain) { return chain >> 1 & 3u; }
  static std::uint32_t first_row_of(ChainId chain) { return (chain & ~kSphereChains) >> 3; }
  std::uint32_t sphere_of(ChainId chain) const { return spheres_[first_row_of(chain)]; }
  std::optional<std::uint32_t> row_of(std::uint32_t sphere, std::uint32_t crossings) const;

  SphereChainTable table_{};
  std::vector<std::uint32_t> spheres_;  ///< of each row
};

}  // namespace raylab
