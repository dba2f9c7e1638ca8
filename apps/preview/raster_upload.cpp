// The part of RasterView that hands the scene to OpenGL.
#include <algorithm>
#include <cstddef>
#include <numeric>

#include "raster_view.hpp"
#include "shaders.hpp"

namespace raylab {

namespace {

// A software rasteriser draws about this many triangles in the time of a frame.
constexpr std::size_t kMovingTriangles = 60000;

void upload_picture(const GlTexture& texture, const TextureImage& image) {
  glBindTexture(GL_TEXTURE_2D, texture.id());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB16F, image.width, image.height, 0, GL_RGB, GL_FLOAT, image.texels.data());
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glGenerateMipmap(GL_TEXTURE_2D);
}

template <class T>
void upload(GLenum target, const GlBuffer& buffer, const std::vector<T>& values) {
  glBindBuffer(target, buffer.id());
  glBufferData(target, static_cast<GLsizeiptr>(values.size() * sizeof(T)), values.data(), GL_STATIC_DRAW);
}

const void* offset(std::size_t bytes) { return reinterpret_cast<const void*>(bytes); }

}  // namespace

RasterView::RasterView(const Scene& scene)
    : mesh_program_("mesh", shaders::kMeshVertex, std::string(shaders::kSurface) + shaders::kMeshFragment),
      sphere_program_("sphere", shaders::kSphereVertex, std::string(shaders::kSurface) + shaders::kSphereFragment),
      sky_program_("sky", shaders::kScreenVertex, std::string(shaders::kSurface) + shaders::kSkyFragment),
      plane_program_("plane", shaders::kPlaneVertex, std::string(shaders::kPlaneColor) + shaders::kPlaneFragment),
      sky_kind_(scene.environment.kind),
      sky_bottom_(scene.environment.bottom),
      sky_top_(scene.environment.top),
      bounds_(scene.geometry.bounds()),
      reversed_depth_(has_clip_control()) {
  upload_materials(scene);
  upload_meshes(scene);
  upload_spheres(scene);
}

void RasterView::upload_materials(const Scene& scene) {
  struct Texels {
    Rgb a;
    float kind;
    Rgb b;
    float texture_kind;
    float fuzz, index, size, unused;
  };
  std::vector<Texels> rows;
  const auto white = static_cast<std::uint32_t>(scene.textures.size());
  for (const Material& m : scene.materials) {
    rows.push_back({m.color.a, static_cast<float>(m.kind), m.color.b, static_cast<float>(m.color.kind), m.fuzz, m.index,
                    m.color.size, 0.0f});
    texture_of_.push_back(m.color.kind == Texture::Kind::image ? m.color.image : white);
    is_glass_.push_back(m.kind == Material::Kind::dielectric);
  }
  if (rows.empty()) rows.push_back({});
  upload(GL_TEXTURE_BUFFER, material_buffer_, rows);
  glBindTexture(GL_TEXTURE_BUFFER, material_texture_.id());
  glTexBuffer(GL_TEXTURE_BUFFER, GL_RGBA32F, material_buffer_.id());

  textures_ = std::vector<GlTexture>(scene.textures.size() + 2);
  for (std::size_t i = 0; i < scene.textures.size(); ++i) upload_picture(textures_[i], scene.textures[i]);
  const TextureImage one{"", 1, 1, {Rgb(1.0f)}, Rgb(1.0f)};
  upload_picture(textures_[white], one);
  upload_picture(textures_[white + 1], scene.environment.picture.texels.empty() ? one : scene.environment.picture);
}

void RasterView::upload_meshes(const Scene& scene) {
  RasterGeometry geometry = raster_geometry(scene, kMovingTriangles);
  full_ = std::move(geometry.full);
  coarse_ = std::move(geometry.coarse);
  glBindVertexArray(mesh_array_.id());
  upload(GL_ARRAY_BUFFER, vertex_buffer_, geometry.vertices);
  upload(GL_ELEMENT_ARRAY_BUFFER, index_buffer_, geometry.indices);
  constexpr GLsizei stride = sizeof(RasterVertex);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, stride, offset(offsetof(RasterVertex, position)));
  glVertexAttribPointer(1, 3, GL_FLOAT, GL_FALSE, stride, offset(offsetof(RasterVertex, normal)));
  glVertexAttribPointer(2, 2, GL_FLOAT, GL_FALSE, stride, offset(offsetof(RasterVertex, uv)));
  for (GLuint i = 0; i < 3; ++i) glEnableVertexAttribArray(i);
}

void RasterView::upload_spheres(const Scene& scene) {
  struct Instance {
    Sphere sphere;
    std::int32_t material;
  };
  std::vector<std::uint32_t> order;
  for (std::uint32_t i = 0; i < scene.geometry.spheres.size(); ++i) {
    if (is_valid_sphere(scene.geometry.spheres[i])) order.push_back(i);
  }
  // One draw for all that share a texture and are or are not glass.
  const auto group = [&](std::uint32_t i) {
    const std::uint32_t m = scene.sphere_materials[i];
    return std::pair(static_cast<bool>(is_glass_[m]), texture_of_[m]);
  };
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return group(a) < group(b); });
  std::vector<Instance> instances;
  for (const std::uint32_t i : order) {
    const auto [glass, texture] = group(i);
    if (sphere_draws_.empty() || sphere_draws_.back().glass != glass || sphere_draws_.back().texture != texture) {
      sphere_draws_.push_back({static_cast<std::uint32_t>(instances.size()), 0, texture, glass});
    }
    ++sphere_draws_.back().count;
    instances.push_back({scene.geometry.spheres[i], static_cast<std::int32_t>(scene.sphere_materials[i])});
  }
  glBindVertexArray(sphere_array_.id());
  upload(GL_ARRAY_BUFFER, sphere_buffer_, instances);
  for (GLuint i = 0; i < 2; ++i) {
    glEnableVertexAttribArray(i);
    glVertexAttribDivisor(i, 1);
  }
}

}  // namespace raylab
