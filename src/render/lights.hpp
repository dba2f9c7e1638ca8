#pragma once
#include <span>
#include <vector>

#include "light_tree.hpp"
#include "raylab/core/numeric.hpp"
#include "raylab/scene/environment.hpp"
#include "raylab/scene/needs.hpp"
#include "raylab/scene/scene.hpp"

namespace raylab {

/// A point or direction that light comes from.
struct LightSample {
  vec3 wi;           ///< unit, from the shaded point
  vec3 position;     ///< on the emitter; unused if infinite
  vec3 ng;           ///< unit normal of the emitter there; unused if infinite
  float end = 0.0f;  ///< where the shadow ray ends, as a share of the way to the position; infinity if infinite
  Rgb radiance;      ///< that arrives when nothing is in between
  float pdf = 0.0f;  ///< per steradian at the shaded point, choice of the emitter included; 0: nothing to see
  bool infinite = false;
};

/// Light samples of some lanes. A lane with a triangle of constant radiance has only its index, and sample_triangle()
/// is to choose the point; lanes with other emitters have complete samples.
struct LightLanes {
  static constexpr int kMost = 16;
  alignas(64) std::uint32_t emitter[kMost];  ///< index into Lights::emitting_triangles()
  alignas(64) float u[kMost];                ///< with v it gives the point of that triangle
  alignas(64) float radiance[3][kMost];
  alignas(64) float wi[3][kMost];
  alignas(64) float position[3][kMost];
  alignas(64) float ng[3][kMost];
  alignas(64) float end[kMost];
  alignas(64) float pdf[kMost];
  std::uint32_t triangles;  ///< bit i: lane i is an emitting triangle of constant radiance
  std::uint32_t infinite;   ///< bit i: light from outside the scene; no target
  // Of emitters of a tree, in place of the index: what sampling reads of them.
  alignas(64) float probability[kMost];
  alignas(64) float corner[9][kMost];  ///< of triangles x, y, z of the three corners; of spheres centre and radius
  std::uint32_t spheres = 0;           ///< bit i: lane i is a sphere of constant radiance, seen from outside
};

/// An emitting triangle of a scene.
struct TriangleEmitter {
  vec3 p0, e1, e2;  ///< a corner, and the edges to the others
  vec3 ng;
  float offset;    ///< see SurfacePoint::offset
  float pdf_area;  ///< choice included
  Rgb radiance;    ///< where it does not vary
  std::uint32_t mesh, triangle, material;
  bool varies;
};

/// All emitters of a scene, for lookup by lanes, if they are few triangles of constant radiance with probabilities that
/// 24 bits resolve. There is one column for each number that sampling reads.
struct LightTable {
  static constexpr int kMost = 16;
  static constexpr int kColumns = 17;  ///< TriangleEmitter as far as the radiance
  int count = 0;                       ///< 0: the scene is not of this kind
  alignas(64) float first[kMost];      ///< [i]: least number that chooses emitter i
  alignas(64) float scale[kMost];      ///< 1 / probability
  alignas(64) float columns[kColumns][kMost];
};

/// All emitters of a scene: triangles, spheres and, where SceneNeeds asks for it, the environment. Few are chosen with
/// probability in proportion to their power; more than kFew triangles and spheres, by a tree, in proportion to what
/// they may give at a point. Views the scene, which must outlive it.
class Lights {
 public:
  Lights(const Scene& scene, const SceneNeeds& needs);

  static constexpr std::size_t kFew = LightTable::kMost;

  bool empty() const { return count() == 0; }
  std::size_t count() const { return tree_.empty() ? first_.size() : tree_.emitters().size() + (view_.end != 0); }

  /// A point of an emitter as seen from p. `select`, a number in units of 2^-64, chooses the emitter, and where it lies
  /// among those that choose it, together with v, the point: so points are as well spread over all emitters as the
  /// numbers are over the unit square. With fewer bits the weak emitters of many would be chosen with probabilities
  /// that have little to do with their densities.
  ///
  /// Where there are many, the choice also looks at the normal of the surface that receives, on its lit side; 0 for
  /// none. All densities below have to be asked for with that of the sample.
  LightSample sample(const vec3& p, std::uint64_t select, float v, const vec3& receiver_ng = vec3(0.0f)) const;

  /// The same for the lanes of a mask, by the upper and the lower halves of numbers, as seen from positions given
  /// as arrays of x, y and z.
  void sample(std::uint32_t lanes, const std::uint32_t* select_high, const std::uint32_t* select_low, const float* v,
              const float* const (&p)[3], LightLanes& out) const;

  /// The same with emitters that a tree has chosen: `out` has their choices, and is given what sampling reads of
  /// triangles and spheres; other lanes are complete then.
  void fetch(std::uint32_t lanes, const float* v, const float* const (&p)[3], LightLanes& out) const;

  /// Density per steradian at p with which sample() gives the point `hit_position` of an emitter that a ray of unit
  /// direction wi has hit: a triangle of a mesh, with unit normal ng and of the material, or a sphere.
  float triangle_pdf(std::uint32_t mesh, std::uint32_t triangle, std::uint32_t material, const vec3& p,
                     const vec3& hit_position, const vec3& ng, const vec3& wi,
                     const vec3& receiver_ng = vec3(0.0f)) const;
  float sphere_pdf(std::uint32_t sphere, std::uint32_t material, const vec3& p, const vec3& hit_position,
                   const vec3& wi, const vec3& receiver_ng = vec3(0.0f)) const;
  /// The density of a sphere's points apart from the probability of the sphere.
  float sphere_direction_pdf(std::uint32_t sphere, const vec3& p, const vec3& hit_position, const vec3& wi) const;
  /// Density per area of a triangle of the material, for raylab::triangle_pdf(). Choosing by power makes it the same
  /// everywhere on a material; a tree does not, and then it means nothing.
  float triangle_pdf_area(std::uint32_t material) const;
  /// The same for light from unit direction wi from outside the scene; 0 where the environment is not sampled.
  float environment_pdf(const vec3& wi) const;

  std::span<const TriangleEmitter> emitting_triangles() const { return triangles_; }
  const LightTable& table() const { return table_; }
  /// No emitters where there are few.
  const LightTree& tree() const { return tree_; }
  const LightTreeView& tree_view() const { return view_; }

  std::size_t bytes() const;

 private:
  void add_triangle(const TreeEmitter& emitter);
  void fill_tree(std::vector<TreeEmitter> emitters, const std::vector<double>& powers);
  void fill_choice(const std::vector<double>& powers);
  void fill_table();
  /// An emitter, and what is left of the number that chose it, in [0, 1).
  struct Choice {
    std::size_t emitter;
    float u;
  };
  Choice choose(std::uint64_t select) const;
  LightSample sample_emitter(std::size_t chosen, const vec3& p, const vec2& u) const;
  LightSample sample_tree_emitter(std::uint32_t chosen, float probability, const vec3& p, const vec2& u) const;
  LightSample sample_environment(const vec2& u) const;
  LightSample sample_mesh(const TriangleEmitter& emitter, const vec3& p, const vec2& u) const;
  LightSample sample_sphere(std::uint32_t sphere, float probability, const vec3& p, const vec2& u) const;
  float sphere_probability(std::uint32_t sphere, std::uint32_t material) const;

  const Scene& scene_;
  std::vector<TriangleEmitter> triangles_;
  std::vector<std::uint32_t> spheres_;  ///< ids of those that emit
  /// The least number that chooses each emitter: triangles, spheres, and the environment if sampled.
  std::vector<std::uint64_t> first_;
  std::vector<float> material_luminance_;  ///< of each material; empty where area lights are not sampled
  double inv_total_power_ = 0.0;
  float environment_probability_ = 0.0f;
  EnvironmentSampler environment_;
  LightTable table_;
  LightTree tree_;
  LightTreeView view_;
};

}  // namespace raylab
