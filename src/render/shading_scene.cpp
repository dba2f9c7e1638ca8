#include "shading_scene.hpp"

#include <cstring>

namespace raylab {

namespace {

MaterialRow material_row(const MaterialLanes<float>& material, float light_pdf_area, const Texture& color) {
  MaterialRow row{{}, light_pdf_area, color.a, color.kind != Texture::Kind::solid};
  static_assert(sizeof(row.parameters) == sizeof(material));
  std::memcpy(row.parameters, &material, sizeof(material));
  return row;
}

}  // namespace

ShadingScene::ShadingScene(const Scene& scene_, const Camera& camera_, const Accelerator& accelerator_,
                           const SceneNeeds& needs_, const IntegratorSettings& settings_)
    : scene(scene_),
      camera(camera_),
      accelerator(accelerator_),
      needs(needs_),
      settings(settings_),
      lights(scene_, needs_),
      sample_lights(settings_.kind != IntegratorKind::book && settings_.strategies.light && !lights.empty()),
      mirrors(sample_lights && settings_.strategies.mirror && needs_.plane_mirrors
                  ? MirrorImages(scene_, lights, settings_.max_depth)
                  : MirrorImages()),
      spheres(sample_lights && settings_.strategies.sphere && needs_.specular_spheres ? SphereChains(scene_)
                                                                                      : SphereChains()),
      emitters(lights.emitting_triangles().empty() ? nullptr : &lights.emitting_triangles()[0].p0.x),
      light_table(lights.table()),
      light_tree(lights.tree_view()) {
  materials.reserve(scene.materials.size() + 1);
  for (std::uint32_t i = 0; i < scene.materials.size(); ++i) {
    const Material& m = scene.materials[i];
    materials.push_back(material_row(material_lanes(m), lights.triangle_pdf_area(i), m.color));
  }
  MaterialLanes<float> miss{};
  miss.kind = kMissKind;
  materials.push_back(material_row(miss, 0.0f, {}));
  material_rows = materials[0].parameters;
  few_materials = materials.size() <= kMostLanes;
  for (std::size_t i = 0; few_materials && i < materials.size(); ++i) {
    for (std::size_t k = 0; k < kColorColumn + 3; ++k) material_columns[k][i] = material_rows[i * kMaterialColumns + k];
  }
}

void ShadingScene::fetch_surfaces(const HitLanes& hits, int count, SurfaceLanes& out) const {
  const Geometry& geometry = scene.geometry;
  // In values of their own, since what is stored in `out` might be what they are read from, for all a compiler knows.
  const auto miss = static_cast<std::uint32_t>(materials.size() - 1);
  const std::uint32_t sphere_geometry = needs.spheres ? geometry.sphere_geometry() : HitBatch::kNoHit;
  const bool shading_normals = needs.shading_normals;
  std::uint32_t spheres = 0, varying = 0;
  for (int i = 0; i < count; ++i) {
    const std::uint32_t id = hits.geometry[i];
    if (id == HitBatch::kNoHit) {
      out.material[i] = miss;
      continue;
    }
    const std::uint32_t primitive = hits.primitive[i];
    std::uint32_t material_id;
    if (id == sphere_geometry) {
      const Sphere& sphere = geometry.spheres[primitive];
      const float* const row = &sphere.center.x;
      static_assert(sizeof(Sphere) == 4 * sizeof(float));
      for (int k = 0; k < 4; ++k) out.corner[k][i] = row[k];
      if (shading_normals) {
        for (int k = 0; k < 3; ++k) out.normal_sum[k][i] = 0.0f;
      }
      material_id = scene.sphere_materials[primitive];
      spheres |= 1u << i;
    } else {
      const TriangleMesh& mesh = geometry.meshes[id];
      const uvec3& corners = mesh.triangles[primitive];
      const float* const p0 = &mesh.positions[corners.x].x;
      const float* const p1 = &mesh.positions[corners.y].x;
      const float* const p2 = &mesh.positions[corners.z].x;
      for (int k = 0; k < 3; ++k) {
        out.corner[k][i] = p0[k];
        out.corner[3 + k][i] = p1[k];
        out.corner[6 + k][i] = p2[k];
      }
      if (shading_normals) {
        const vec3 sum = mesh.normals.empty() ? vec3(0.0f) : interpolated_normal(mesh, primitive, hits.u[i], hits.v[i]);
        for (int k = 0; k < 3; ++k) out.normal_sum[k][i] = (&sum.x)[k];
      }
      material_id = scene.mesh_materials[id].of(primitive);
    }
    out.material[i] = material_id;
    varying |= static_cast<std::uint32_t>(materials[material_id].varies) << i;
  }
  out.spheres = spheres;
  out.varying = varying;
}

bool ShadingScene::follow(std::uint32_t geometry, std::uint32_t primitive, bool reflected, ChainId& chain,
                          vec3& from) const {
  if (needs.spheres && scene.geometry.is_sphere(geometry)) {
    return !spheres.empty() && spheres.follow(primitive, reflected, chain);
  }
  return !mirrors.empty() && !is_over_sphere(chain) && mirrors.follow(geometry, primitive, chain, from);
}

float ShadingScene::chain_share(ChainId chain, vec3& p, const vec3& origin, vec3& direction, const vec3& light,
                                const vec3& ng, bool infinite) const {
  if (chain == 0) return 1.0f;
  if (!is_over_sphere(chain)) return infinite ? 0.0f : mirrors.share(chain);
  const SphereChains::Share share = spheres.share(chain, p, origin, direction, light, ng, infinite);
  p = share.center;
  if (!infinite) direction = glm::normalize(light - share.center);
  return share.factor;
}

void ShadingScene::look_up_colors(const HitLanes& hits, const VectorLanes& position, const VectorLanes& ng,
                                  SurfaceLanes& out) const {
  for (std::uint32_t lanes = out.varying; lanes != 0; lanes &= lanes - 1) {
    const int i = __builtin_ctz(lanes);
    const Texture& texture = scene.materials[scene.material_of(hits.geometry[i], hits.primitive[i])].color;
    const bool on_sphere = (out.spheres >> i & 1u) != 0;
    vec2 uv(0.0f);
    if (texture.kind == Texture::Kind::image) {
      uv = on_sphere ? sphere_texcoords({ng[0][i], ng[1][i], ng[2][i]})
                     : interpolated_texcoords(scene.geometry.meshes[hits.geometry[i]], hits.primitive[i], hits.u[i],
                                              hits.v[i]);
    }
    const Rgb color = texture_color(texture, scene.textures, {position[0][i], position[1][i], position[2][i]}, uv,
                                    address_mode_of_v(on_sphere));
    for (int k = 0; k < 3; ++k) out.color[k][i] = (&color.x)[k];
  }
}

void ShadingScene::sphere_light_pdfs(std::uint32_t lanes, const HitLanes& hits, const VectorLanes& p,
                                     const VectorLanes& position, const VectorLanes& wi, float* pdf) const {
  for (; lanes != 0; lanes &= lanes - 1) {
    const int i = __builtin_ctz(lanes);
    const std::uint32_t sphere = hits.primitive[i];
    const vec3 from(p[0][i], p[1][i], p[2][i]), at(position[0][i], position[1][i], position[2][i]);
    const vec3 direction(wi[0][i], wi[1][i], wi[2][i]);
    pdf[i] = light_tree.nodes != nullptr
                 ? lights.sphere_direction_pdf(sphere, from, at, direction)
                 : lights.sphere_pdf(sphere, scene.sphere_materials[sphere], from, at, direction);
  }
}

void ShadingScene::environment(std::uint32_t lanes, const VectorLanes& direction, VectorLanes& radiance,
                               float* pdf) const {
  for (; lanes != 0; lanes &= lanes - 1) {
    const int i = __builtin_ctz(lanes);
    const vec3 d(direction[0][i], direction[1][i], direction[2][i]);
    const Rgb arriving = scene.environment.radiance(d);
    for (int k = 0; k < 3; ++k) radiance[k][i] = (&arriving.x)[k];
    pdf[i] = lights.environment_pdf(d);
  }
}

}  // namespace raylab
