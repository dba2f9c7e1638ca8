// Films, cameras, textures and normals: no rays are traced by an accelerator's choice.
#include <algorithm>
#include <map>

#include "raylab/core/parallel.hpp"
#include "raylab/scene/surface_point.hpp"
#include "stability_cases.hpp"

namespace raylab {

namespace {

using namespace made;

constexpr double kPiD = 3.14159265358979323846;

/// Where the ray of a picture position should go, in double, against where it goes, in pixels; far out and with a lens.
StabilityTrial camera_rays(double vfov, std::size_t count, std::uint64_t seed) {
  return [=](const StabilityMethod&) {
    constexpr int kSize = 1000;
    UniformFloats uniform(seed);
    StabilityCount found;
    for (const float focus : {1e-3f, 1.0f, 1e6f}) {
      CameraSettings s;
      s.look_from = vec3(1e5f, -7e4f, 3e4f);
      s.look_at = s.look_from + vec3(100.0f, 50.0f, -200.0f);
      s.vfov = static_cast<float>(vfov);
      s.focus_distance = focus;
      const Camera camera(s, kSize, kSize);
      const dvec3 forward = glm::normalize(dvec3(s.look_at) - dvec3(s.look_from));
      const dvec3 right = glm::normalize(glm::cross(forward, dvec3(0, 1, 0)));
      const dvec3 up = glm::cross(right, forward);
      const double half = std::tan(static_cast<double>(s.vfov) * kPiD / 360.0);
      for (std::size_t i = 0; i < count / 3; ++i) {
        const float x = uniform(0.0f, kSize), y = uniform(0.0f, kSize);
        const dvec3 d(camera.ray(x, y, vec2(0.5f)).direction);
        // Back to the position that it goes through.
        const double along = glm::dot(d, forward);
        const double px = (glm::dot(d, right) / along / half + 1.0) * 0.5 * kSize;
        const double py = (1.0 - glm::dot(d, up) / along / half) * 0.5 * kSize;
        ++found.trials;
        found.failures +=
            !(std::abs(px - static_cast<double>(x)) < 0.01 && std::abs(py - static_cast<double>(y)) < 0.01);
      }
    }
    return found;
  };
}

/// Mean of equal samples.
StabilityTrial radiance(double value, std::size_t, std::uint64_t) {
  return [=](const StabilityMethod&) {
    Film film(4, 4);
    StabilityCount found;
    for (int i = 0; i < 16; ++i) {
      const auto v = static_cast<float>(value * (1.0 + 0.05 * i));
      for (int sample = 0; sample < 3 * i + 1; ++sample) film.add(i % 4, i / 4, Rgb(v));
      const double error = static_cast<double>(film.mean(i % 4, i / 4).g) / static_cast<double>(v) - 1.0;
      ++found.trials;
      found.failures += !(std::abs(error) < 1e-6);
    }
    return found;
  };
}

/// A plane at a whole number of cells of a checker: within a cell across it, the colour is one.
StabilityTrial checker_plane(double cells, std::size_t count, std::uint64_t seed) {
  return [=](const StabilityMethod&) {
    const FlushDenormals flush;
    constexpr float kCell = 0.1f;
    const float height = static_cast<float>(cells) * kCell;
    SeenScene scene;
    add_quad(scene, {-1, height, -1}, {0.1f, 0, 2}, {2, 0, 0.1f}, lambertian(checker(kCell, Rgb(1.0f), Rgb(0.0f))));
    const auto accelerator = make_accelerator(kDefaultAccelerator, scene.geometry);
    UniformFloats uniform(seed);
    std::map<std::pair<int, int>, std::pair<std::size_t, std::size_t>> colours;  // of each cell: white, black
    StabilityCount found;
    for (std::size_t i = 0; i < count; ++i) {
      const vec3 eye(0.3f, height + 2.0f, 0.2f);
      const float x = uniform(-0.8f, 0.8f);
      const vec3 at(x, height, uniform(-0.8f, 0.8f));
      const Ray ray{eye, at - eye};
      const auto hit = accelerator->intersect(ray);
      if (!hit) continue;
      const SurfacePoint point = surface_point(scene.geometry, ray, *hit);
      const double cx = static_cast<double>(point.position.x) / kCell,
                   cz = static_cast<double>(point.position.z) / kCell;
      // Not at the borders of cells, where either is right.
      if (std::abs(cx - std::round(cx)) < 1e-3 || std::abs(cz - std::round(cz)) < 1e-3) continue;
      auto& [white, black] = colours[{static_cast<int>(std::floor(cx)), static_cast<int>(std::floor(cz))}];
      const bool is_white = texture_color(scene.materials[0].color, {}, point.position, point.uv).g > 0.5f;
      ++(is_white ? white : black);
      ++found.trials;
    }
    for (const auto& [cell, count_of] : colours) found.failures += std::min(count_of.first, count_of.second);
    return found;
  };
}

/// The normal of a unit sphere seen from a distance, against that of the exact hit.
StabilityTrial far_normal(double distance, std::size_t count, std::uint64_t seed) {
  return [=](const StabilityMethod&) {
    const FlushDenormals flush;
    const Geometry geometry{{}, {{vec3(0.0f), 1.0f}}};
    const auto accelerator = make_accelerator(kDefaultAccelerator, geometry);
    UniformFloats uniform(seed);
    StabilityCount found;
    while (found.trials < count) {
      const dvec3 axis = glm::normalize(dvec3(uniform.in_box(vec3(-1.0f), vec3(1.0f))));
      const dvec3 at = 0.9 * dvec3(uniform.in_box(vec3(-0.5f), vec3(0.5f)));
      const vec3 eye(distance * axis);
      const Ray ray{eye, vec3(at - dvec3(eye))};
      const auto hit = accelerator->intersect(ray);
      if (!hit) continue;
      const dvec3 o(ray.origin), d = glm::normalize(dvec3(ray.direction));
      const dvec3 nearest = o - glm::dot(o, d) * d;
      const double root = 1.0 - glm::dot(nearest, nearest);
      if (!(root > 0.01)) continue;
      const dvec3 normal = nearest - std::sqrt(root) * d;
      const dvec3 given(surface_point(geometry, ray, *hit).ng);
      ++found.trials;
      found.failures += !(glm::length(given - normal) < 1e-3);
    }
    return found;
  };
}

}  // namespace

std::vector<StabilityCase> stability_film_cases() {
  using enum StabilityMethods;
  return {
      // A direction of three floats is good to a hundredth of a pixel at 1 degree.
      {57, "camera", "Camera rays, the eye 130,000 from the origin, in focus at 1e-3 to 1e6",
       "off by a hundredth of a pixel", "vertical view in degrees", ours, values(0.01, 0.1, 1, 10, 90, 170, 179), 1,
       179, "", camera_rays},
      // Sums are multiples of 2^-55, of terms up to 2^40.
      {59, "radiance", "The mean of equal samples", "off by 1e-6 of it", "radiance", ours, powers_of_ten(-30, 30, 3),
       1e-9, 1e9, "", radiance},
      {63, "checker-plane", "A plane at the boundary of a checker's cells", "a colour unlike the rest of its cell",
       "height in cells", ours, values(0, 1, 3, 7, 10, 100, 1000, 10000), 0, 10000, "", checker_plane},
      // At 1e7 a unit sphere is one step of the ray's floats.
      {64, "far-normal", "The normal of a unit sphere seen from far away", "off by 1e-3", "distance", ours,
       powers_of_ten(1, 7), 10, 1e6, "", far_normal},
  };
}

}  // namespace raylab
