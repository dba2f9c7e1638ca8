#include "raylab/measure/made_scenes.hpp"

#include <bit>
#include <cmath>

#include "raylab/accel/accelerator.hpp"
#include "raylab/measure/shapes.hpp"

namespace raylab::made {

namespace {

std::uint32_t add_material(Scene& scene, const Material& material) {
  scene.materials.push_back(material);
  return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

void add_mesh(Scene& scene, TriangleMesh mesh, const Material& material) {
  mesh.pad_positions();
  scene.geometry.meshes.push_back(std::move(mesh));
  scene.mesh_materials.push_back({add_material(scene, material), {}});
  scene.mesh_names.push_back("mesh " + std::to_string(scene.mesh_names.size()));
}

TextureImage make_image(int width, int height, const std::function<Rgb(int, int)>& texel) {
  TextureImage image;
  image.name = "in code";
  image.width = width;
  image.height = height;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      image.texels.push_back(texel(x, y));
      image.mean += image.texels.back() / static_cast<float>(width * height);
    }
  }
  return image;
}

Material make(Material::Kind kind, const Texture& color) {
  Material m;
  m.kind = kind;
  m.color = color;
  return m;
}

}  // namespace

Texture color(float r, float g, float b) { return Texture::solid_color(Rgb(r, g, b)); }

Texture grey(float value) { return Texture::solid_color(Rgb(value)); }

Texture checker(float size, const Rgb& even, const Rgb& odd) {
  Texture t;
  t.kind = Texture::Kind::checker;
  t.size = size;
  t.a = even;
  t.b = odd;
  return t;
}

Texture picture(Scene& scene, int width, int height, const std::function<Rgb(int, int)>& texel) {
  Texture t;
  t.kind = Texture::Kind::image;
  t.image = static_cast<std::uint32_t>(scene.textures.size());
  scene.textures.push_back(make_image(width, height, texel));
  return t;
}

Material lambertian(const Texture& albedo) { return make(Material::Kind::lambertian, albedo); }

Material metal(const Texture& color, float fuzz) {
  Material m = make(Material::Kind::metal, color);
  m.fuzz = fuzz;
  return m;
}

Material glass(float index) {
  Material m = make(Material::Kind::dielectric, grey(1.0f));
  m.index = index;
  return m;
}

Material light(const Texture& radiance) { return make(Material::Kind::diffuse_light, radiance); }

void add_triangle(Scene& scene, const Triangle& t, const Material& material) {
  TriangleMesh mesh;
  mesh.positions = {t.p0, t.p1, t.p2};
  mesh.texcoords = {vec2(0.0f, 0.0f), vec2(1.0f, 0.0f), vec2(0.0f, 1.0f)};
  mesh.triangles = {uvec3(0, 1, 2)};
  add_mesh(scene, std::move(mesh), material);
}

void add_quad(Scene& scene, const vec3& corner, const vec3& e1, const vec3& e2, const Material& material) {
  TriangleMesh mesh;
  mesh.positions = {corner, corner + e1, corner + e1 + e2, corner + e2};
  mesh.texcoords = {vec2(0.0f, 0.0f), vec2(1.0f, 0.0f), vec2(1.0f, 1.0f), vec2(0.0f, 1.0f)};
  mesh.triangles = {uvec3(0, 1, 2), uvec3(0, 2, 3)};
  add_mesh(scene, std::move(mesh), material);
}

void add_box(Scene& scene, const vec3& lower, const vec3& upper, const Material& material) {
  TriangleMesh mesh = box_mesh(lower, upper);
  for (std::uint32_t i = 0; i < 8; ++i) mesh.texcoords.emplace_back((i & 1u) ? 1.0f : 0.0f, (i & 2u) ? 1.0f : 0.0f);
  add_mesh(scene, std::move(mesh), material);
}

void add_sphere(Scene& scene, const vec3& center, float radius, const Material& material) {
  scene.geometry.spheres.push_back({center, radius});
  scene.sphere_materials.push_back(add_material(scene, material));
}

void add_smooth_sphere(Scene& scene, const vec3& center, float radius, int rings, const Material& material) {
  TriangleMesh mesh;
  const int around = 2 * rings;
  for (int i = 0; i <= rings; ++i) {
    for (int k = 0; k < around; ++k) {
      const float theta = kPi * static_cast<float>(i) / static_cast<float>(rings);
      const float phi = 2.0f * kPi * static_cast<float>(k) / static_cast<float>(around);
      const vec3 n(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
      mesh.normals.push_back(n);
      mesh.positions.push_back(center + radius * n);
      mesh.texcoords.emplace_back(static_cast<float>(k) / static_cast<float>(around),
                                  static_cast<float>(i) / static_cast<float>(rings));
    }
  }
  const auto corner = [&](int i, int k) { return static_cast<std::uint32_t>(i * around + k % around); };
  for (int i = 0; i < rings; ++i) {
    for (int k = 0; k < around; ++k) {
      if (i > 0) mesh.triangles.emplace_back(corner(i, k), corner(i + 1, k), corner(i, k + 1));
      if (i < rings - 1) mesh.triangles.emplace_back(corner(i, k + 1), corner(i + 1, k), corner(i + 1, k + 1));
    }
  }
  add_mesh(scene, std::move(mesh), material);
}

void set_sky(Scene& scene, const Rgb& everywhere) {
  scene.environment = {};
  scene.environment.bottom = everywhere;
}

void set_sky(Scene& scene, const Rgb& below, const Rgb& above) {
  scene.environment = {};
  scene.environment.kind = Environment::Kind::gradient;
  scene.environment.bottom = below;
  scene.environment.top = above;
}

void set_sky(Scene& scene, int width, int height, const std::function<Rgb(int, int)>& texel) {
  scene.environment = {};
  scene.environment.kind = Environment::Kind::image;
  scene.environment.picture = make_image(width, height, texel);
}

void look(SeenScene& scene, const vec3& from, const vec3& at, float vfov) {
  scene.camera.look_from = from;
  scene.camera.look_at = at;
  scene.camera.up = std::abs(glm::normalize(at - from).y) > 0.9f ? vec3(0.0f, 0.0f, 1.0f) : vec3(0.0f, 1.0f, 0.0f);
  scene.camera.vfov = vfov;
  scene.camera.focus_distance = glm::length(at - from);
}

SeenScene lit_room(float scale) {
  SeenScene scene;
  const Material white = lambertian(grey(0.73f));
  add_quad(scene, {-1, -1, -1}, {0, 0, 2}, {2, 0, 0}, white);
  add_quad(scene, {-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, white);
  add_quad(scene, {-1, -1, -1}, {2, 0, 0}, {0, 2, 0}, white);
  add_quad(scene, {-1, -1, 1}, {0, 2, 0}, {2, 0, 0}, white);
  add_quad(scene, {-1, -1, -1}, {0, 2, 0}, {0, 0, 2}, lambertian(color(0.65f, 0.05f, 0.05f)));
  add_quad(scene, {1, -1, -1}, {0, 0, 2}, {0, 2, 0}, lambertian(color(0.12f, 0.45f, 0.15f)));
  add_quad(scene, {-0.35f, 0.98f, -0.35f}, {0.7f, 0, 0}, {0, 0, 0.7f}, light(grey(8.0f)));
  add_sphere(scene, {-0.45f, -0.62f, 0.1f}, 0.38f, glass());
  add_sphere(scene, {0.5f, -0.7f, 0.25f}, 0.3f, metal(color(0.9f, 0.8f, 0.6f), 0.25f));
  add_quad(scene, {-0.3f, -0.8f, -0.9f}, {1.0f, 0, -0.05f}, {0, 1.2f, 0.1f}, metal(grey(0.95f), 0.0f));
  look(scene, {0.0f, 0.0f, 0.95f}, {0.0f, -0.1f, 0.0f}, 80.0f);
  scale_scene(scene, scale);
  return scene;
}

SeenScene hidden_light() {
  SeenScene scene;
  add_quad(scene, {-5, -5, -1}, {10, 0, 0}, {0, 10, 0}, light(grey(100.0f)));
  add_quad(scene, {-20, -20, 0}, {40, 0, 0}, {0, 40, 0}, lambertian(grey(0.8f)));
  look(scene, {0.3f, 0.2f, 6}, vec3(0.0f), 40.0f);
  return scene;
}

LampOverFloor lamp_over_floor() {
  // A rectangle of half sides x and y at height h, parallel to the floor, above the point seen.
  const double x = 0.5, y = 0.3, height = 1.5, radiance = 7.0, albedo = 0.6;
  const double a = x / height, b = y / height;
  const double quarter = (a / std::sqrt(1 + a * a) * std::atan(b / std::sqrt(1 + a * a)) +
                          b / std::sqrt(1 + b * b) * std::atan(a / std::sqrt(1 + b * b))) /
                         (2.0 * 3.14159265358979323846);
  LampOverFloor made;
  add_quad(made.scene, {-2, 0, -2}, {0, 0, 4}, {4, 0, 0}, lambertian(grey(static_cast<float>(albedo))));
  add_quad(made.scene, vec3(dvec3(-x, height, -y)), vec3(dvec3(2 * x, 0, 0)), vec3(dvec3(0, 0, 2 * y)),
           light(grey(static_cast<float>(radiance))));
  look(made.scene, {1.5f, 0.7f, 1.0f}, vec3(0.0f), 0.02f);
  made.expected = 4.0 * quarter * albedo * radiance;
  return made;
}

void scale_scene(SeenScene& scene, float factor) {
  for (TriangleMesh& mesh : scene.geometry.meshes) {
    for (vec3& p : mesh.positions) p *= factor;
  }
  for (Sphere& s : scene.geometry.spheres) {
    s.center *= factor;
    s.radius *= factor;
  }
  for (Material& m : scene.materials) m.color.size *= factor;
  scene.camera.look_from *= factor;
  scene.camera.look_at *= factor;
  scene.camera.focus_distance *= factor;
}

RenderOptions render_options(int width, int height, std::uint32_t samples, int max_depth) {
  RenderOptions o;
  o.width = width;
  o.height = height;
  o.samples_per_pixel = samples;
  o.integrator.max_depth = max_depth;
  return o;
}

Film render(const SeenScene& scene, const RenderOptions& given, const std::string& accelerator) {
  RenderOptions options = given;
  options.camera = scene.camera;
  const auto made = make_accelerator(accelerator, scene.geometry);
  RenderSession session(scene, *made, options);
  session.run();
  return session.snapshot();
}

Estimate mean_luminance(const Film& film) {
  double sum = 0.0, variance = 0.0;
  int pixels = 0;
  for (int y = 0; y < film.height(); ++y) {
    for (int x = 0; x < film.width(); ++x) {
      if (film.samples(x, y) == 0) continue;
      sum += luminance(film.mean(x, y));
      // Channels taken as fully correlated, which overestimates.
      const dvec3 v = film.variance_of_mean(x, y);
      const double deviation = 0.2126 * std::sqrt(v.r) + 0.7152 * std::sqrt(v.g) + 0.0722 * std::sqrt(v.b);
      variance += deviation * deviation;
      ++pixels;
    }
  }
  return {sum / pixels, std::sqrt(variance) / pixels};
}

double difference_z(const Estimate& a, const Estimate& b) { return (a.mean - b.mean) / std::hypot(a.error, b.error); }

int different_pixels(const Film& a, const Film& b) {
  int different = 0;
  for (int y = 0; y < a.height(); ++y) {
    for (int x = 0; x < a.width(); ++x) {
      bool same = a.samples(x, y) == b.samples(x, y);
      for (int c = 0; c < 3; ++c) {
        same = same && std::bit_cast<std::uint32_t>(a.mean(x, y)[c]) == std::bit_cast<std::uint32_t>(b.mean(x, y)[c]);
        same = same && std::bit_cast<std::uint64_t>(a.variance_of_mean(x, y)[c]) ==
                           std::bit_cast<std::uint64_t>(b.variance_of_mean(x, y)[c]);
      }
      different += !same;
    }
  }
  return different;
}

}  // namespace raylab::made
