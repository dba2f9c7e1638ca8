#pragma once
// What the wavefront reads of a scene. Its functions are compiled once for all instruction sets: they gather what the
// lanes of a vector need from the scene's arrays, and do lane by lane what few lanes need.
#include "bsdf.hpp"
#include "lights.hpp"
#include "mirror_images.hpp"
#include "raylab/render/integrator.hpp"
#include "raylab/scene/surface_point.hpp"
#include "sphere_chains.hpp"

namespace raylab {

/// Most lanes of any instruction set's vectors.
inline constexpr int kMostLanes = 16;

/// MaterialLanes::kind of a ray that has hit nothing.
inline constexpr float kMissKind = 15.0f;

/// What is known of some hits before their positions are. Masks have bit i for lane i.
struct SurfaceLanes {
  alignas(64) float corner[9][kMostLanes];         ///< x, y, z of the three corners; of spheres centre and radius
  alignas(64) float normal_sum[3][kMostLanes];     ///< see shading_normal(); 0 without one
  alignas(64) std::uint32_t material[kMostLanes];  ///< row of ShadingScene::materials
  alignas(64) float color[3][kMostLanes];          ///< of lanes where it varies
  std::uint32_t spheres = 0;
  std::uint32_t varying = 0;  ///< colour to be looked up
};

/// Hits of the lanes.
struct HitLanes {
  const float* u;
  const float* v;
  const std::uint32_t* geometry;
  const std::uint32_t* primitive;
};

/// What shading reads of a material: a row of floats.
struct MaterialRow {
  float parameters[kMaterialParameters];  ///< its MaterialLanes
  float light_pdf_area;                   ///< Lights::triangle_pdf_area of triangles that emit, else 0
  Rgb color;                              ///< where it does not vary
  bool varies;
};
inline constexpr int kLightPdfColumn = kMaterialParameters;
inline constexpr int kColorColumn = kLightPdfColumn + 1;
inline constexpr std::uint32_t kMaterialColumns = sizeof(MaterialRow) / sizeof(float);

/// Points or directions of the lanes: arrays of x, y and z.
using VectorLanes = float[3][kMostLanes];

struct ShadingScene {
  ShadingScene(const Scene& scene, const Camera& camera, const Accelerator& accelerator, const SceneNeeds& needs,
               const IntegratorSettings& settings);

  void fetch_surfaces(const HitLanes& hits, int count, SurfaceLanes& surfaces) const;
  /// Colours of the `varying` lanes, by position and, on spheres, normal.
  void look_up_colors(const HitLanes& hits, const VectorLanes& position, const VectorLanes& ng,
                      SurfaceLanes& surfaces) const;
  /// Lights::sphere_pdf for some lanes, or, with a tree, sphere_direction_pdf.
  void sphere_light_pdfs(std::uint32_t lanes, const HitLanes& hits, const VectorLanes& p, const VectorLanes& position,
                         const VectorLanes& wi, float* pdf) const;
  /// Radiance from outside the scene for some lanes, and Lights::environment_pdf.
  void environment(std::uint32_t lanes, const VectorLanes& direction, VectorLanes& radiance, float* pdf) const;

  /// Whether lights are sampled over specular surfaces.
  bool has_chains() const { return !mirrors.empty() || !spheres.empty(); }
  /// Whether a path that a surface has turned, `reflected` or refracted, follows a chain over which lights are sampled;
  /// then has `chain` go on by the surface, and moves the point `from`, which the path comes from, to its image.
  bool follow(std::uint32_t geometry, std::uint32_t primitive, bool reflected, ChainId& chain, vec3& from) const;
  /// For a path that has come from p over a chain and now meets, along `direction`, a light, or if `infinite` leaves
  /// the scene: where the light is sampled from, in p, in what direction from there, in `direction`, and the density
  /// over that which the light has from there.
  float chain_share(ChainId chain, vec3& p, const vec3& origin, vec3& direction, const vec3& light, const vec3& ng,
                    bool infinite) const;

  const Scene& scene;
  const Camera& camera;
  const Accelerator& accelerator;
  SceneNeeds needs;
  IntegratorSettings settings;
  Lights lights;
  bool sample_lights;
  MirrorImages mirrors;                ///< empty where lights are not sampled over them
  SphereChains spheres;                ///< likewise
  std::vector<MaterialRow> materials;  ///< the last is that of rays that have hit nothing
  // For the lanes of vectors: the same by rows, or of few materials by columns, and those of emitting triangles.
  const float* material_rows;
  bool few_materials;
  alignas(64) float material_columns[kMaterialColumns][kMostLanes];
  const float* emitters;
  const LightTable& light_table;
  LightTreeView light_tree;
};

#if defined(__x86_64__)
extern const TraceKernel kTraceSse42;
extern const TraceKernel kTraceAvx2;
extern const TraceKernel kTraceAvx512;
#else
extern const TraceKernel kTraceNeon;
#endif

}  // namespace raylab
