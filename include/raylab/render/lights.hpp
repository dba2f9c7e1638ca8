#pragma once
#include <vector>

#include "raylab/scene/environment.hpp"
#include "raylab/scene/needs.hpp"
#include "raylab/scene/scene.hpp"

namespace raylab {

/// A point or direction that light comes from.
struct LightSample {
  vec3 wi;          ///< unit, from the shaded point
  vec3 target;      ///< where the shadow ray ends: off the emitter's surface on the near side; unused if infinite
  Rgb radiance;     ///< that arrives when nothing is in between
  float pdf = 0.0f;  ///< per steradian at the shaded point, choice of the emitter included; 0: nothing to see
  bool infinite = false;
};

/// All emitters of a scene, chosen with probability in proportion to their power: triangles, spheres and, where
/// SceneNeeds asks for it, the environment. Views the scene, which must outlive it.
class Lights {
 public:
  Lights(const Scene& scene, const SceneNeeds& needs);

  bool empty() const { return cdf_.empty(); }
  std::size_t count() const { return cdf_.size(); }

  /// Chooses an emitter by `select` and a point of it by `u`, as seen from p.
  LightSample sample(const vec3& p, float select, const vec2& u) const;

  /// Density per steradian at p with which sample() gives the point `hit_position` of an emitter that a ray of unit
  /// direction wi has hit: a triangle with unit normal ng and the material's mean luminance, or a sphere.
  float triangle_pdf(std::uint32_t material, const vec3& p, const vec3& hit_position, const vec3& ng,
                     const vec3& wi) const;
  float sphere_pdf(std::uint32_t sphere, std::uint32_t material, const vec3& p, const vec3& hit_position,
                   const vec3& wi) const;
  /// The same for light from unit direction wi from outside the scene; 0 where the environment is not sampled.
  float environment_pdf(const vec3& wi) const;

  std::size_t bytes() const;

 private:
  /// What sampling reads of an emitting triangle, side by side: one that emits is sampled at every vertex of every
  /// path.
  struct TriangleEmitter {
    vec3 p0, e1, e2;
    vec3 ng;
    float offset;    ///< see SurfacePoint::offset
    float pdf_area;  ///< choice included
    Rgb radiance;    ///< where it does not vary
    std::uint32_t mesh, triangle, material;
    bool varies;
  };

  void add_triangle(std::uint32_t mesh, std::uint32_t triangle, std::vector<double>& powers);
  float triangle_pdf_area(std::uint32_t material) const;
  LightSample sample_triangle(const TriangleEmitter& emitter, const vec3& p, const vec2& u) const;
  LightSample sample_sphere(std::uint32_t sphere, const vec3& p, const vec2& u) const;
  float sphere_direction_pdf(const Sphere& sphere, const vec3& p, const vec3& hit_position, const vec3& wi) const;

  const Scene& scene_;
  std::vector<TriangleEmitter> triangles_;
  std::vector<std::uint32_t> spheres_;  ///< ids of those that emit
  /// Cumulated probability up to and including each emitter: triangles, spheres, and the environment if sampled.
  std::vector<float> cdf_;
  std::vector<float> material_luminance_;
  double inv_total_power_ = 0.0;
  float environment_probability_ = 0.0f;
  EnvironmentSampler environment_;
};

}  // namespace raylab
