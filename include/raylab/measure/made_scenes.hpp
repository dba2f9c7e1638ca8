#pragma once
// Small scenes made in code, and what is measured of their pictures.
#include <cstdint>
#include <functional>
#include <string>

#include "raylab/render/render_session.hpp"
#include "raylab/scene/scene.hpp"

namespace raylab::made {

Texture color(float r, float g, float b);
Texture grey(float value);
/// Cubes of edge `size`, checkered.
Texture checker(float size, const Rgb& even, const Rgb& odd);
/// Adds a picture whose texel (x, y), y from the top, is texel(x, y), and gives the texture that shows it.
Texture picture(Scene& scene, int width, int height, const std::function<Rgb(int, int)>& texel);

Material lambertian(const Texture& albedo);
Material metal(const Texture& color, float fuzz);
Material glass(float index = 1.5f);
Material light(const Texture& radiance);

/// Adds one object of that material; each mesh has one material and texture coordinates.
void add_triangle(Scene& scene, const Triangle& triangle, const Material& material);
/// The parallelogram corner, corner + e1, corner + e1 + e2, corner + e2; its normal is e1 x e2. Texture
/// coordinates run from (0,0) to (1,1).
void add_quad(Scene& scene, const vec3& corner, const vec3& e1, const vec3& e2, const Material& material);
/// A closed box with its normals outwards.
void add_box(Scene& scene, const vec3& lower, const vec3& upper, const Material& material);
void add_sphere(Scene& scene, const vec3& center, float radius, const Material& material);
/// A sphere of triangles, `rings` from pole to pole and twice as many around, with the sphere's normals at its
/// corners.
void add_smooth_sphere(Scene& scene, const vec3& center, float radius, int rings, const Material& material);

void set_sky(Scene& scene, const Rgb& everywhere);
void set_sky(Scene& scene, const Rgb& below, const Rgb& above);
void set_sky(Scene& scene, int width, int height, const std::function<Rgb(int, int)>& texel);

/// A scene and what is to be seen of it.
struct SeenScene : Scene {
  CameraSettings camera;
};

void look(SeenScene& scene, const vec3& from, const vec3& at, float vfov);

/// A closed room of 2 x 2 x 2 around the origin, seen from inside its open front: white walls, a red and a green
/// one, a lamp below the ceiling, a glass sphere, a fuzzy metal sphere and a mirror on the floor.
SeenScene lit_room(float scale = 1.0f);

/// Everything black but a light behind an opaque wall, the plane z = 0, seen from in front of the wall.
SeenScene hidden_light();

/// A diffuse floor, y = 0, seen at the origin from the side, and a rectangular lamp parallel to it.
struct LampOverFloor {
  SeenScene scene;
  double expected;  ///< radiance seen at the origin after one reflection, by the form factor
};
LampOverFloor lamp_over_floor();

/// Moves and scales everything in the scene, its camera too, keeping what it looks like.
void scale_scene(SeenScene& scene, float factor);

RenderOptions render_options(int width, int height, std::uint32_t samples, int max_depth = 7);

/// Renders all of it with its own camera and waits.
Film render(const SeenScene& scene, const RenderOptions& options, const std::string& accelerator = "list");

/// Mean luminance of a picture, and its standard error as the variances of the pixels give it.
struct Estimate {
  double mean = 0.0;
  double error = 0.0;
};
Estimate mean_luminance(const Film& film);

/// Difference of two independent estimates in standard errors.
double difference_z(const Estimate& a, const Estimate& b);

/// Pixels whose sample counts, sums or squares are not equal to the bit.
int different_pixels(const Film& a, const Film& b);

}  // namespace raylab::made
