// What light adds up to: furnaces, glass, mirrors, depths, normals; estimates against what is known.
#include <algorithm>

#include "raylab/core/parallel.hpp"
#include "stability_cases.hpp"

namespace raylab {

namespace {

using namespace made;

constexpr double kPiD = 3.14159265358979323846;

/// A scene whose picture is the same everywhere, and its radiance.
struct Known {
  SeenScene scene;
  double expected;
};

StabilityTrial estimate(std::vector<Known> scenes, std::size_t count, std::uint64_t seed, int max_depth,
                        double tolerance = 1e-4) {
  auto shared = std::make_shared<const std::vector<Known>>(std::move(scenes));
  return [=](const StabilityMethod& method) {
    StabilityCount found;
    for (const Known& known : *shared) {
      const RenderOptions options = stability_render_options(method, count, 64, seed, max_depth);
      const StabilityCount off = rows_off(stability_render(known.scene, options, method), known.expected, tolerance);
      found.failures += off.failures;
      found.trials += off.trials;
    }
    return found;
  };
}

/// A glowing sphere within a diffuse one: rho Le F / (1 - rho (1 - F)), F the squared ratio of their radii.
StabilityTrial series(double albedo, std::size_t count, std::uint64_t seed) {
  constexpr double kLight = 3.0, kFraction = 0.25;
  SeenScene scene;
  const auto rho = static_cast<double>(static_cast<float>(albedo));
  add_sphere(scene, vec3(0.0f), 2.0f, lambertian(grey(static_cast<float>(albedo))));
  add_sphere(scene, vec3(0.0f), 1.0f, light(grey(static_cast<float>(kLight))));
  look(scene, {0, 0.1f, 1.4f}, {0.2f, 0.3f, 2.0f}, 30.0f);
  return estimate({{std::move(scene), rho * kLight * kFraction / (1.0 - rho * (1.0 - kFraction))}}, count, seed, 2000);
}

/// Unit sphere of glass from a point within from which it is met at that angle: what passes at once.
StabilityTrial glass_from_inside(double degrees, std::size_t count, std::uint64_t seed) {
  const auto away = static_cast<float>(std::sin(degrees * kPiD / 180.0));
  const double cos_i = std::sqrt(1.0 - static_cast<double>(away) * static_cast<double>(away));
  const double sin2_t = 2.25 * static_cast<double>(away) * static_cast<double>(away);
  double reflected = 1.0;
  if (sin2_t < 1.0) {
    const double cos_t = std::sqrt(1.0 - sin2_t);
    const double parallel = (cos_i - 1.5 * cos_t) / (cos_i + 1.5 * cos_t);
    const double perpendicular = (1.5 * cos_i - cos_t) / (1.5 * cos_i + cos_t);
    reflected = 0.5 * (parallel * parallel + perpendicular * perpendicular);
  }
  SeenScene scene;
  add_sphere(scene, vec3(0.0f), 1.0f, glass());
  set_sky(scene, Rgb(1.0f));
  look(scene, {away, 0, 0}, {away, 0, 1}, 0.0005f);
  return estimate({{std::move(scene), 2.25 * (1.0 - reflected)}}, count, seed, 2, 2e-3);
}

StabilityTrial threads(double number, std::size_t count, std::uint64_t seed) {
  return [=](const StabilityMethod& method) {
    RenderOptions options = stability_render_options(method, count, 16, seed);
    const SeenScene scene = lit_room();
    const auto with = [&](int limit, int tile, std::uint32_t pass) {
      const ThreadLimit threads(limit);
      options.tile_size = tile;
      options.pass_samples = pass;
      return stability_render(scene, options, method);
    };
    const Film one = with(1, 16, 16), many = with(static_cast<int>(number), 5, 3);
    return StabilityCount{static_cast<std::size_t>(different_pixels(one, many)),
                          static_cast<std::size_t>(one.width()) * static_cast<std::size_t>(one.height())};
  };
}

/// Spheres of every material under a constant sky, which none of them may be told from.
StabilityTrial furnace(double radiance, std::size_t count, std::uint64_t seed) {
  std::vector<Known> scenes;
  const auto value = static_cast<float>(radiance);
  for (const Material& m : {lambertian(grey(1.0f)), metal(grey(1.0f), 0.0f), glass(), glass(1.0f / 1.5f)}) {
    for (int shape = 0; shape < 3; ++shape) {
      SeenScene scene;
      // Of smooth ones normals differ from the faces': diffuse ones lose a little where they are bent.
      if (shape == 2 && m.kind != Material::Kind::metal) continue;
      if (shape == 0) add_sphere(scene, vec3(0.0f), 1.0f, m);
      if (shape == 1) add_box(scene, vec3(-0.7f), vec3(0.7f, 0.8f, 0.9f), m);
      if (shape == 2) add_smooth_sphere(scene, vec3(0.0f), 1.0f, 16, m);
      set_sky(scene, Rgb(value));
      look(scene, {1.5f, 1.0f, 2.2f}, vec3(0.0f), 20.0f);
      scenes.push_back({std::move(scene), static_cast<double>(value)});
    }
  }
  SeenScene empty;
  set_sky(empty, Rgb(value));
  scenes.push_back({std::move(empty), static_cast<double>(value)});
  return estimate(std::move(scenes), std::max<std::size_t>(count / 4, 256), seed, 2000);
}

/// A metal floor under a lamp all around, and seen from straight above: all is reflected.
StabilityTrial fuzz(double fuzz, std::size_t count, std::uint64_t seed) {
  std::vector<Known> scenes;
  for (const bool box : {false, true}) {
    SeenScene scene;
    add_quad(scene, {-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, metal(grey(1.0f), static_cast<float>(fuzz)));
    if (box) {
      add_box(scene, vec3(-4, -3, -4), vec3(4, 5, 4), light(grey(1.0f)));
    } else {
      add_sphere(scene, vec3(0.3f, 0.1f, 0), 5.0f, light(grey(1.0f)));
    }
    look(scene, {0, 2, 0}, vec3(0.0f), 0.02f);
    scenes.push_back({std::move(scene), 1.0});
  }
  return estimate(std::move(scenes), count, seed, 10);
}

/// A diffuse wall above a mirror, lit by a lamp beside it, directly and by the mirror.
StabilityTrial mirror_floor(double half_side, std::size_t count, std::uint64_t seed) {
  SeenScene scene;
  const auto a = static_cast<float>(half_side);
  add_quad(scene, {-2, 0, -2}, {0, 0, 4}, {4, 0, 0}, metal(grey(0.9f), 0.0f));
  add_quad(scene, {-1, 0, -1}, {2, 0, 0}, {0, 2, 0}, lambertian(grey(0.7f)));
  add_quad(scene, {-a, 1.0f - a, 1}, {0, 2 * a, 0}, {2 * a, 0, 0}, light(grey(5.0f)));
  look(scene, {1.5f, 0.8f, 1.2f}, {0.0f, 0.6f, -1.0f}, 0.5f);
  return [=](const StabilityMethod& method) {
    StabilityMethod other = method;
    other.integrator = method.integrator == IntegratorKind::book ? IntegratorKind::path : IntegratorKind::book;
    other.ray_offset = RayOffset::bounds;
    const Film film = stability_render(scene, stability_render_options(method, 4 * count, 256, seed), method);
    return rows_off(film, stability_render(scene, stability_render_options(other, 4 * count, 256, seed + 1), other),
                    1e-3);
  };
}

/// A smooth sphere of so many rings converges to the sphere: its light differs by less than eight over their number
/// squared, and 0.2%.
StabilityTrial terminator(double rings, std::size_t count, std::uint64_t seed) {
  const auto lit = [](int number) {
    SeenScene scene;
    if (number > 0) {
      add_smooth_sphere(scene, vec3(0.0f), 1.0f, number, lambertian(grey(0.8f)));
    } else {
      add_sphere(scene, vec3(0.0f), 1.0f, lambertian(grey(0.8f)));
    }
    add_quad(scene, {-1, 4, -1}, {2, 0, 0}, {0, 0, 2}, light(grey(10.0f)));
    look(scene, {0, 0, 6}, vec3(0.0f), 25.0f);
    return scene;
  };
  const SeenScene smooth = lit(static_cast<int>(rings)), sphere = lit(0);
  return [=](const StabilityMethod& method) {
    const Estimate a =
        mean_luminance(stability_render(smooth, stability_render_options(method, 4 * count, 16, seed), method));
    const Estimate b =
        mean_luminance(stability_render(sphere, stability_render_options(method, 4 * count, 16, seed + 1), method));
    const double limit = (8.0 / (rings * rings) + 2e-3) * b.mean + 4.5 * std::hypot(a.error, b.error);
    return StabilityCount{std::abs(a.mean - b.mean) > limit ? 1u : 0u, 1};
  };
}

/// Through two panes of glass straight at a lamp: four boundaries, each of which reflects 4%.
StabilityTrial panes(double gap, std::size_t count, std::uint64_t seed) {
  SeenScene scene;
  const auto g = static_cast<float>(gap);
  add_box(scene, {-2, -2, 0}, {2, 2, 0.1f}, glass());
  add_box(scene, {-2, -2, -0.1f - g}, {2, 2, -g}, glass());
  add_quad(scene, {-1, -1, -2}, {2, 0, 0}, {0, 2, 0}, light(grey(1.0f)));
  look(scene, {0, 0, 3}, {0, 0, -1}, 0.02f);
  return estimate({{std::move(scene), 0.96 / 1.12}}, count, seed, 400, 1e-3);
}

/// Glass spheres within each other under a sky, which none may be told from: every other one is filled with what is
/// around them all, or else directions would have to be known to the float's step over the product of the indices.
StabilityTrial indices(double index, std::size_t count, std::uint64_t seed) {
  std::vector<Known> scenes;
  for (const int nested : {1, 8}) {
    SeenScene scene;
    for (int i = 0; i < nested; ++i) {
      const auto relative = static_cast<float>(i % 2 == 0 ? index : 1.0 / index);
      add_sphere(scene, vec3(0.0f), 1.0f - 0.1f * static_cast<float>(i), glass(relative));
    }
    set_sky(scene, Rgb(1.0f));
    look(scene, {1.5f, 1.0f, 2.2f}, vec3(0.0f), 20.0f);
    scenes.push_back({std::move(scene), 1.0});
  }
  return estimate(std::move(scenes), std::max<std::size_t>(count / 4, 256), seed, 10000, 2e-3);
}

/// A closed box of mirrors and white walls, with a lamp: what absorbs nothing is as bright as the lamp, however long
/// the paths.
StabilityTrial mirror_box(double depth, std::size_t count, std::uint64_t seed) {
  SeenScene scene;
  add_box(scene, vec3(-1.0f), vec3(1.0f), metal(grey(1.0f), 0.0f));
  add_sphere(scene, vec3(-0.4f, -0.3f, 0.2f), 0.4f, lambertian(grey(1.0f)));
  add_quad(scene, {-0.5f, 0.9f, -0.5f}, {1, 0, 0}, {0, 0, 1}, light(grey(1.0f)));
  look(scene, {0.7f, -0.2f, 0.8f}, vec3(-0.4f, -0.3f, 0.2f), 20.0f);
  return estimate({{std::move(scene), 1.0}}, std::max<std::size_t>(count / 8, 256), seed, static_cast<int>(depth),
                  1e-3);
}

}  // namespace

std::vector<StabilityCase> stability_light_cases() {
  using enum StabilityMethods;
  const std::string rows = "a row of pixels off by 4.5 standard errors";
  return {
      {26, "furnace-albedo", "A glowing sphere within a diffuse one, against the sum of its series", rows, "albedo",
       renders, values(0.1, 0.5, 0.8, 0.9, 0.95, 0.99), 0.1, 0.99, "", series},
      {27, "glass-inside", "Glass seen from inside, against Fresnel's equations", rows, "angle in degrees", renders,
       values(0, 20, 35, 38, 40, 41, 41.5, 41.8, 42), 0, 42, "", glass_from_inside},
      {29, "threads", "Threads, tiles and passes", "a pixel of other bits than on one thread", "threads", renders,
       values(1, 2, 3, 8), 1, 8, "", threads},
      {52, "mirror-floor", "A wall over a mirror, with and without light sampling", rows, "half side of the lamp",
       renders, values(0.1, 0.2, 0.4, 0.8), 0.1, 0.8, "", mirror_floor},
      {53, "furnace", "Every material under a constant sky, and no object", rows, "radiance of the sky", renders,
       powers_of_ten(-6, 6, 3), 1e-6, 1e6, "", furnace},
      {55, "terminator", "A sphere of few smooth triangles, against the sphere", "its light is off", "rings", renders,
       values(8, 16, 32, 64, 128), 8, 128, "", terminator},
      {56, "panes", "Through two panes at a lamp", rows, "gap", renders, powers_of_ten(-7, -1), 1e-7, 0.1,
       "bvh path book offset", panes},
      {58, "fuzz", "Metal under lamps all around", rows, "fuzz", renders, powers_of_ten(-8, 0), 1e-8, 1, "", fuzz},
      {65, "index", "One and eight spheres of glass under a sky", rows, "refractive index", renders,
       values(0.5, 0.9, 1, 1.0001, 1.5, 2.4, 10, 100), 0.5, 100, "", indices},
      {66, "mirror-box", "A closed box that absorbs nothing", rows, "longest path", renders, powers_of_ten(3, 5), 1e3,
       1e5, "", mirror_box},
  };
}

}  // namespace raylab
