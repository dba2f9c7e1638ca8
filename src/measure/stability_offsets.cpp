// Rays that leave a surface: where they start, and how they and their shadow rays end.
#include <algorithm>

#include "raylab/core/parallel.hpp"
#include "raylab/scene/surface_point.hpp"
#include "stability_cases.hpp"

namespace raylab {

namespace {

using namespace made;

/// The ray that leaves the point, as the integrators start it.
Ray leaving(const SurfacePoint& point, const vec3& direction, const StabilityMethod& method) {
  if (method.ray_offset == RayOffset::book) return {point.position, direction, 0.001f};
  return {offset_origin(point, direction), direction};
}

/// Every accelerator but those whose faults are kept.
std::vector<std::unique_ptr<Accelerator>> sound_accelerators(const Geometry& geometry) {
  std::vector<std::unique_ptr<Accelerator>> all;
  for (const AcceleratorEntry& entry : accelerators()) {
    if (entry.name != "rtiow" && !entry.capabilities.is_exact) all.push_back(entry.make(geometry, {}));
  }
  return all;
}

/// A ray that starts on a triangle meets it no more, nor does one that leaves a sphere.
StabilityTrial spawn(double scale, std::size_t count, std::uint64_t seed) {
  return [=](const StabilityMethod& method) {
    const FlushDenormals flush;
    const auto s = static_cast<float>(scale);
    UniformFloats uniform(seed);
    StabilityCount found;
    constexpr std::size_t kRays = 50;  // of each primitive
    while (found.trials < count) {
      const vec3 place = 3.0f * s * uniform.in_box(vec3(-1.0f), vec3(1.0f));
      const auto corner = [&] { return place + s * uniform.in_box(vec3(-1.0f), vec3(1.0f)); };
      const bool is_sphere = uniform.below(2) == 1;
      const Geometry geometry = is_sphere ? Geometry{{}, {{place, s}}}
                                          : Geometry{{make_mesh({corner(), corner(), corner()}, {{0, 1, 2}})}, {}};
      const auto all = sound_accelerators(geometry);
      for (std::size_t i = 0; i < kRays; ++i) {
        const vec3 eye = place + 8.0f * s * glm::normalize(uniform.in_box(vec3(-1.0f), vec3(1.0f)));
        vec3 at = place + 0.9f * s * uniform.in_box(vec3(-0.5f), vec3(0.5f));
        if (!is_sphere) {
          const float u = uniform(0.05f, 0.9f), v = (0.95f - u) * uniform();
          const Triangle t = triangle_corners(geometry.meshes[0], 0);
          at = t.p0 + u * (t.p1 - t.p0) + v * (t.p2 - t.p0);
        }
        const Ray ray{eye, at - eye};
        const auto hit = all[0]->intersect(ray);
        if (!hit) continue;
        const SurfacePoint point = surface_point(geometry, ray, *hit);
        vec3 direction = glm::normalize(uniform.in_box(vec3(-1.0f), vec3(1.0f)));
        if (is_sphere && glm::dot(direction, point.ng) < 0.0f) direction = -direction;
        const Ray next = leaving(point, direction, method);
        ++found.trials;
        found.failures += std::any_of(all.begin(), all.end(), [&](const auto& a) { return a->occluded(next); });
      }
    }
    return found;
  };
}

/// A ray that enters a sphere of radius 1 and a gap meets the unit sphere within it.
StabilityTrial shells(double gap, std::size_t count, std::uint64_t seed) {
  return [=](const StabilityMethod& method) {
    const FlushDenormals flush;
    const Geometry geometry{{}, {{vec3(0.0f), 1.0f}, {vec3(0.0f), static_cast<float>(1.0 + gap)}}};
    const auto all = sound_accelerators(geometry);
    UniformFloats uniform(seed);
    StabilityCount found;
    while (found.trials < count) {
      const vec3 eye = 5.0f * glm::normalize(uniform.in_box(vec3(-1.0f), vec3(1.0f)));
      const vec3 at = 0.7f * glm::normalize(uniform.in_box(vec3(-1.0f), vec3(1.0f)));
      const Ray ray{eye, glm::normalize(at - eye)};
      const auto outer = all[0]->intersect(ray);
      if (!outer || outer->primitive != 1) continue;
      const Ray next = leaving(surface_point(geometry, ray, *outer), ray.direction, method);
      ++found.trials;
      found.failures += std::any_of(all.begin(), all.end(), [&](const auto& a) {
        const auto inner = a->intersect(next);
        return !inner || inner->primitive != 0 || inner->t > 0.5f;  // the far side of it is beyond
      });
    }
    return found;
  };
}

StabilityTrial room(const std::function<SeenScene()>& changed, std::size_t count, std::uint64_t seed) {
  return [=](const StabilityMethod& method) {
    StabilityMethod sound = method;
    sound.ray_offset = RayOffset::bounds;
    const Film usual = stability_render(lit_room(), stability_render_options(sound, 4 * count, 64, seed + 1), sound);
    // As wide as the other, so that rows can be compared.
    const Film film = stability_render(changed(), stability_render_options(method, 4 * count, 64, seed), method);
    return rows_off(film, usual, 2e-3);
  };
}

StabilityTrial room_scale(double scale, std::size_t count, std::uint64_t seed) {
  return room([=] { return lit_room(static_cast<float>(scale)); }, count, seed);
}

StabilityTrial room_offset(double offset, std::size_t count, std::uint64_t seed) {
  return room(
      [=] {
        SeenScene scene = lit_room();
        const vec3 by = static_cast<float>(offset) * vec3(1.0f, -1.0f, 1.0f);
        for (TriangleMesh& mesh : scene.geometry.meshes) {
          for (vec3& p : mesh.positions) p += by;
        }
        for (Sphere& s : scene.geometry.spheres) s.center += by;
        scene.camera.look_from += by;
        scene.camera.look_at += by;
        return scene;
      },
      count, seed);
}

/// Trials in which a single path must find no light.
StabilityTrial dark(SeenScene scene, std::size_t count, std::uint64_t seed, int max_depth = 12) {
  return [scene = std::move(scene), count, seed, max_depth](const StabilityMethod& method) {
    return lit_pixels(stability_render(scene, stability_render_options(method, count, 1, seed, max_depth), method));
  };
}

StabilityTrial plates(double gap, std::size_t count, std::uint64_t seed) {
  SeenScene scene = hidden_light();
  add_quad(scene, {-20, -20, static_cast<float>(gap)}, {40, 0, 0}, {0, 40, 0}, glass(1.5f));
  add_sphere(scene, {0, 0, 3}, 0.5f, lambertian(grey(0.9f)));
  return dark(std::move(scene), count, seed);
}

/// A lamp with a cover so far below it, and the floor below both.
StabilityTrial cover(double gap, std::size_t count, std::uint64_t seed) {
  SeenScene scene;
  add_quad(scene, {-3, 0, -3}, {0, 0, 6}, {6, 0, 0}, lambertian(grey(0.8f)));
  add_quad(scene, {-0.5f, 1, -0.5f}, {1, 0, 0}, {0, 0, 1}, light(grey(100.0f)));
  add_quad(scene, {-1, static_cast<float>(1.0 - gap), -1}, {2, 0, 0}, {0, 0, 2}, lambertian(grey(0.8f)));
  look(scene, {2.0f, 0.6f, 2.0f}, vec3(0.0f), 30.0f);
  return dark(std::move(scene), count, seed);
}

/// What light finds through the corner of a closed box so far from the origin.
StabilityTrial box_corners(double offset, std::size_t count, std::uint64_t seed) {
  SeenScene scene;
  const vec3 center = static_cast<float>(offset) * vec3(1.0f, -1.0f, 1.0f);
  add_box(scene, center - vec3(1.0f), center + vec3(1.0f), lambertian(grey(0.9f)));
  set_sky(scene, Rgb(1000.0f));
  look(scene, center + vec3(0.5f, 0.4f, 0.3f), center + vec3(1.0f), 1.0f);
  return dark(std::move(scene), count, seed);
}

StabilityTrial bent_normals(double degrees, std::size_t count, std::uint64_t seed) {
  SeenScene scene = hidden_light();
  const auto angle = static_cast<float>(degrees * 3.14159265358979323846 / 180.0);
  const float across = std::sin(angle), up = std::cos(angle);
  scene.geometry.meshes[1].normals = {{across, 0, up}, {0, across, up}, {-across, 0, up}, {0, -across, up}};
  return dark(std::move(scene), count, seed, 8);
}

/// A ground sphere, or a floor of its size, with a roof that hides the lamp: dark; and without the roof: lit as by the
/// form factor.
StabilityTrial ground_shadow(double radius, std::size_t count, std::uint64_t seed) {
  const auto r = static_cast<float>(radius);
  struct Scenes {
    std::vector<SeenScene> dark, lit;
    double expected = 0.0;
  };
  auto scenes = std::make_shared<Scenes>();
  for (const bool sphere : {true, false}) {
    LampOverFloor lamp = lamp_over_floor();
    scenes->expected = lamp.expected;
    SeenScene scene = std::move(lamp.scene);
    if (sphere) {
      scene.geometry.meshes.erase(scene.geometry.meshes.begin());
      scene.mesh_materials.erase(scene.mesh_materials.begin());
      scene.mesh_names.erase(scene.mesh_names.begin());
      add_sphere(scene, {0, -r, 0}, r, lambertian(grey(0.6f)));
    } else {
      scene.geometry.meshes[0].positions = {{-r, 0, -r}, {-r, 0, r}, {r, 0, r}, {r, 0, -r}};
      scene.geometry.meshes[0].pad_positions();
    }
    scenes->lit.push_back(scene);
    add_quad(scene, {-0.5f, 1.0f, -0.5f}, {1, 0, 0}, {0, 0, 1}, lambertian(grey(0.0f)));
    scenes->dark.push_back(std::move(scene));
  }
  return [=](const StabilityMethod& method) {
    StabilityCount found;
    for (const SeenScene& scene : scenes->dark) {
      const StabilityCount lit = lit_pixels(stability_render(
          scene, stability_render_options(method, std::max<std::size_t>(count / 16, 64), 1, seed, 2), method));
      found.failures += lit.failures;
      found.trials += lit.trials;
    }
    for (const SeenScene& scene : scenes->lit) {
      const StabilityCount off =
          rows_off(stability_render(scene, stability_render_options(method, 8 * count, 1024, seed + 1, 2), method),
                   scenes->expected, 1e-3);
      found.failures += off.failures;
      found.trials += off.trials;
    }
    return found;
  };
}

}  // namespace

std::vector<StabilityCase> stability_offset_cases() {
  using enum StabilityMethods;
  const std::string lit = "a path that finds light";
  const std::string rows = "a row of pixels off by 4.5 standard errors and 0.2%";
  return {
      {17, "spawn", "Rays that leave a triangle or a sphere on their side",
       "the surface is met again, by any accelerator", "scale", offsets, powers_of_ten(-8, 8, 2), 1e-8, 1e8,
       "book offset", spawn},
      // A gap of less than the offset of the outer sphere's points is stepped over.
      {18, "shells", "A sphere just within another", "the inner one is missed", "gap in radii", offsets,
       powers_of_ten(-7, -1, 0.5), 3e-7, 0.1, "book offset", shells},
      {19, "room-scale", "A lit room of any size", rows, "scale", renders, powers_of_ten(-16, 16, 4), 1e-16, 1e16,
       "bvh path book offset", room_scale},
      {20, "plates", "A wall just behind glass, a lamp behind the wall", lit, "gap", renders, powers_of_ten(-7, -1),
       1e-7, 0.1, "bvh path book offset", plates},
      {30, "bent-normals", "A wall with bent normals before a lamp", lit, "bend in degrees", renders,
       values(0, 15, 30, 45, 60, 75, 84, 89), 0, 89, "", bent_normals},
      // Shadow rays end a few steps of floats before the lamp: what covers it more closely is not seen.
      {42, "cover", "A lamp 1 above the floor, covered", lit, "gap between lamp and cover", renders,
       powers_of_ten(-7, -2, 0.5), 9e-7, 0.01, "bvh path book offset", cover},
      {44, "ground-shadow", "Light and shadow on a ground sphere and a floor of its size",
       "a path that finds light in the shadow, or a row of lit pixels off", "radius", renders, powers_of_ten(1, 7), 10,
       1e7, "", ground_shadow},
      // At 1e6 a float's step is 0.06, of a room whose lamp hangs 0.02 below the ceiling.
      {45, "room-offset", "A lit room far from the origin", rows, "distance from the origin", renders,
       powers_of_ten(0, 7), 1, 1e5, "bvh path book offset", room_offset},
      // Where three walls meet, a ray's start that is moved off one of them may be moved through another: of paths all
      // of which end in the corner's last hundredth 40 in a million find light at 10, and 3,100 at 1,000.
      {46, "box-corners", "The corner of a closed box of size 2 under a bright sky", lit, "distance from the origin",
       renders, powers_of_ten(0, 5), 1, 1e3, "", box_corners, 4e-3},
  };
}

}  // namespace raylab
