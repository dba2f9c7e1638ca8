#pragma once
// Light that comes over plane mirrors. A point sees a light in a mirror as if it stood at the light's mirror image, or
// as if the point's own image looked at the light: unfolded at its mirrors, a path is a straight line, and lengths and
// angles stay what they are. So a light is sampled as seen from the image of the point, with the density that it has
// there, and the path is folded back, mirror by mirror (for the idea in rendering see Wallace, Cohen and Greenberg
// 1987, "A two-pass solution to the rendering equation").
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "lights.hpp"
#include "raylab/core/bounds.hpp"
#include "raylab/core/ray.hpp"
#include "raylab/render/integrator.hpp"

namespace raylab {

/// A light sample as seen over the mirrors of a chain.
struct MirroredLight {
  std::uint32_t chain = 0;
  vec3 light;        ///< the point of the emitter
  float gap = 0.0f;  ///< how long before it the last ray ends
  vec3 image;        ///< the point of its image
  vec3 wi;           ///< unit, from the shaded point to the image
  Rgb radiance;      ///< that leaves the light
  float pdf = 0.0f;  ///< per steradian at the shaded point, choice of the chain included; 0: nothing to see
};

/// A ray on its way to a light over the mirrors of a chain.
struct MirroredRay {
  Ray ray;
  vec3 light;
  float gap;
  Rgb radiance;         ///< that arrives if nothing is in between
  std::uint32_t chain;  ///< its mirrors
  std::uint32_t met;    ///< how many of them it has met
};

/// Chains of plane mirrors: triangles of smooth metal without normals of their own that lie in one plane. A chain is
/// named by an index: 0 is that of no mirror, kLost that of all that there is no chain for.
class MirrorImages {
 public:
  static constexpr std::uint32_t kLost = 0xffffu;

  MirrorImages() = default;
  /// Views the scene and the lights. Chains are no longer than paths of max_depth segments can use.
  MirrorImages(const Scene& scene, const Lights& lights, int max_depth);

  /// Whether there is nothing to sample.
  bool empty() const { return chains_.size() < 2; }
  std::size_t count() const { return chains_.empty() ? 0 : chains_.size() - 1; }

  /// Past a mirror a path goes on as from the image of where it came from. Returns whether the primitive is of a
  /// mirror, and then has `chain` go on by it and moves `from` to its image.
  bool follow(std::uint32_t geometry, std::uint32_t primitive, std::uint32_t& chain, vec3& from) const {
    const std::uint8_t plane = plane_of(geometry, primitive);
    if (plane == kNoPlane) return false;
    chain = chain == kLost ? kLost : chains_[chain].next[plane];
    from = vec3(planes_[plane].image(dvec3(from)));
    return true;
  }
  /// Density of sampling over the chain over that of sampling the light as seen from the point's image.
  float share(std::uint32_t chain) const { return chain == kLost ? 0.0f : chains_[chain].share; }

  /// A light as seen from p over at most `most` mirrors. `choice` chooses the chain; select and v as for
  /// Lights::sample().
  MirroredLight sample(const vec3& p, float choice, std::uint64_t select, float v, int most) const;

  /// From the mirror that the ray has hit on to the next, or past the last one to the light. False where it has hit
  /// something else.
  bool reflect(MirroredRay& ray, const std::optional<Hit>& hit, RayOffset offset) const;
  /// Whether the light is next.
  bool is_last(const MirroredRay& ray) const { return ray.met == chains_[ray.chain].mirrors.size(); }

 private:
  static constexpr std::size_t kMostPlanes = 8;
  static constexpr std::uint8_t kNoPlane = 0xff;
  struct Plane {
    dvec3 normal;  ///< unit
    double distance = 0.0;
    Bounds bounds{};  ///< of its triangles
    double area = 0.0;
    double reflectance = 0.0;  ///< area times luminance while they are gathered
    dvec3 image(const dvec3& p) const { return p - 2.0 * (glm::dot(normal, p) - distance) * normal; }
    dvec3 reflected(const dvec3& w) const { return w - 2.0 * glm::dot(normal, w) * normal; }
  };
  struct Chain {
    std::vector<std::uint8_t> mirrors;  ///< planes, the shaded point's first
    double weight;
    float share, first;  ///< probability, and the least number that chooses it
    std::array<std::uint16_t, kMostPlanes> next;
  };

  void find_planes();
  std::uint8_t add_to_plane(const Triangle& triangle, double luminance);
  void make_chains(int longest);
  std::uint8_t plane_of(std::uint32_t geometry, std::uint32_t primitive) const {
    return geometry >= planes_of_.size() || planes_of_[geometry].empty() ? kNoPlane : planes_of_[geometry][primitive];
  }
  dvec3 image_of_light(const Chain& chain, std::size_t met, const vec3& light) const;
  bool may_pass(const Chain& chain, const vec3& p, const vec3& light) const;

  const Scene* scene_ = nullptr;
  const Lights* lights_ = nullptr;
  std::vector<Plane> planes_;
  std::vector<std::vector<std::uint8_t>> planes_of_;  ///< of each mesh, if it has some, its triangles' planes
  std::vector<Chain> chains_;
};

}  // namespace raylab
