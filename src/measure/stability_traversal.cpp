// What trees and batches do: planes of faces, copies, deep trees, intervals, rays and vertices that are no numbers.
#include <algorithm>

#include "raylab/core/parallel.hpp"
#include "raylab/measure/agreement.hpp"
#include "stability_cases.hpp"

namespace raylab {

namespace {

/// They must meet the box: its sides end in the plane.
StabilityTrial face_planes(double size, std::size_t count, std::uint64_t seed) {
  const auto s = static_cast<float>(size);
  return try_all_hit({{box_mesh(vec3(0.0f), vec3(s))}, {}}, rays_in_faces(s, count, seed));
}

TriangleMesh copies_of_one(std::size_t copies) {
  std::vector<uvec3> triangles(copies, uvec3(0, 1, 2));
  return make_mesh({{-1, -1, 0.1f}, {1, -1, 0}, {0, 1, -0.1f}}, std::move(triangles));
}

/// Many copies of one triangle: few rays each, since each may have to test all of them. A tree deeper than 64 counts
/// as a failure of every ray.
StabilityTrial copies(double number, std::size_t count, std::uint64_t seed) {
  Geometry geometry{{copies_of_one(static_cast<std::size_t>(number))}, {}};
  const std::size_t few = std::clamp(static_cast<std::size_t>(5e6 / number), std::size_t{100}, count);
  KnownRays known{std::move(geometry), random_rays({vec3(-1.0f), vec3(1.0f)}, few, seed), {}};
  const Geometry one{{copies_of_one(1)}, {}};
  const auto exact = make_accelerator("exact", one);
  for (const Ray& ray : known.rays) {
    const auto hit = exact->intersect(ray);
    known.expected.push_back({hit.has_value(), hit ? hit->t : 0.0, 1e-5});
  }
  // Rays within a few ulp of the outline may go either way.
  for (std::size_t i = known.rays.size(); i-- > 0;) {
    if (distance_to_outline(known.rays[i], one, {0, 0}) > 1e-5) continue;
    known.rays.erase(known.rays.begin() + static_cast<std::ptrdiff_t>(i));
    known.expected.erase(known.expected.begin() + static_cast<std::ptrdiff_t>(i));
  }
  const auto trial = try_known(known);
  return [trial, shared = std::make_shared<const KnownRays>(std::move(known))](const StabilityMethod& method) {
    if (shared->geometry.primitive_count() > find_accelerator(method.accel).capabilities.largest_primitives) {
      return StabilityCount{};
    }
    StabilityCount found = trial(method);
    const int depth = make_accelerator(method.accel, shared->geometry, method.options())->build_report().depth;
    if (depth > 64) found.failures = found.trials;
    return found;
  };
}

/// A share of the triangles has a vertex that is no number or too large: the others answer as if they were absent.
StabilityTrial bad_vertices(double share, std::size_t count, std::uint64_t seed) {
  constexpr std::uint32_t kTriangles = 200;
  const TriangleMesh good = triangle_soup(kTriangles, 1.0f, 0.4f, seed);
  TriangleMesh spoilt = good, kept = good;
  kept.triangles.clear();
  const float bad[] = {std::nanf(""), kInfinity, -kInfinity, 3e18f};
  UniformFloats uniform(seed + 1);
  for (std::uint32_t i = 0; i < kTriangles; ++i) {
    if (uniform() < static_cast<float>(share)) {
      spoilt.positions[3 * i + uniform.below(3)][static_cast<int>(uniform.below(3))] = bad[uniform.below(4)];
    } else {
      kept.triangles.push_back(good.triangles[i]);
    }
  }
  struct Pair {
    Geometry with, without;
    std::vector<Ray> rays;
  };
  auto pair = std::make_shared<Pair>();
  pair->without = {{std::move(kept)}, {}};
  pair->with = {{std::move(spoilt)}, {}};
  pair->rays = random_rays(pair->without.bounds(), count, seed + 2);
  return [pair = std::shared_ptr<const Pair>(std::move(pair))](const StabilityMethod& method) {
    const auto tested = make_accelerator(method.accel, pair->with, method.options());
    const std::size_t invalid = pair->with.primitive_count() - pair->without.primitive_count();
    if (tested->build_report().invalid_primitives != invalid) {
      return StabilityCount{pair->rays.size(), pair->rays.size()};
    }
    return differing(answers_of(*tested, pair->rays, method.batch.value_or(false)),
                     answers_of(method, pair->without, pair->rays));
  };
}

/// Triangles at 2^-i on a line: the boxes of a tree by halving are each half as large as the one above.
StabilityTrial powers_of_two(double links, std::size_t count, std::uint64_t seed) {
  const vec3 corners[] = {{0.9f, -0.1f, 0}, {1.1f, -0.1f, 0}, {1, 0.1f, 0.05f}};
  const vec3 centroid = (corners[0] + corners[1] + corners[2]) / 3.0f;
  UniformFloats uniform(seed);
  TriangleMesh chain;
  const auto number = static_cast<std::uint32_t>(links);
  for (std::uint32_t i = 0; i < number; ++i) {
    for (const vec3& corner : corners) chain.positions.push_back(std::ldexp(1.0f, -static_cast<int>(i)) * corner);
    chain.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
  }
  chain.pad_positions();
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i) {
    const float scale = std::ldexp(1.0f, -static_cast<int>(uniform.below(number)));
    const vec3 near = centroid + 0.02f * uniform.in_box(vec3(-1.0f), vec3(1.0f));
    switch (i % 3) {  // along the line through all centroids, both ways, and across it
      case 0:
        rays.push_back({1.5f * scale * near, -near});
        break;
      case 1:
        rays.push_back({-scale * near, scale * near});
        break;
      default:
        rays.push_back({scale * (near - vec3(0, 0, 1)), {0, 0, 1}});
    }
  }
  return try_against_exact({{std::move(chain)}, {}}, std::move(rays));
}

/// Does a triangle so far away change what is hit here?
StabilityTrial far_geometry(double distance, std::size_t count, std::uint64_t seed) {
  const auto d = static_cast<float>(distance);
  struct Pair {
    Geometry near, both;
    std::vector<Ray> rays;
  };
  auto pair = std::make_shared<Pair>();
  const TriangleMesh ball = icosphere(vec3(0.2f, -0.1f, 0.3f), 1.0f, 1);
  pair->near = {{ball}, {}};
  pair->both = {{ball, make_mesh({{d, d, d}, {d * 1.5f, d, d}, {d, d * 1.5f, d}}, {{0, 1, 2}})}, {}};
  pair->rays = rays_at_edges(ball, {0.2f, -0.1f, 0.3f}, 0.3f, count, seed);
  return [pair = std::shared_ptr<const Pair>(std::move(pair))](const StabilityMethod& method) {
    return differing(answers_of(method, pair->both, pair->rays), answers_of(method, pair->near, pair->rays));
  };
}

/// The bits of `list` with the same triangle test, whatever the tree.
StabilityTrial bits_of_list(double scale, std::size_t count, std::uint64_t seed) {
  const auto s = static_cast<float>(scale);
  auto geometry = std::make_shared<const Geometry>(
      Geometry{{icosphere(vec3(0.1f * s, 0.0f, 0.0f), s, 1)}, sphere_soup(10, s, 0.1f * s, seed)});
  std::vector<Ray> rays = random_rays(geometry->bounds(), count, seed + 1);
  return [geometry, rays](const StabilityMethod& method) {
    StabilityMethod list;
    list.accel = "list";
    list.intersector = method.intersector;
    return differing(answers_of(method, *geometry, rays), answers_of(list, *geometry, rays));
  };
}

/// Builds so many identical triangles: a failure takes more than twenty times as long as the same number apart from
/// each other, and a tenth of a second, which clocks and other programs do not make of nothing.
StabilityTrial building_copies(double number, std::size_t, std::uint64_t seed) {
  const auto n = static_cast<std::size_t>(number);
  auto same = std::make_shared<const Geometry>(Geometry{{copies_of_one(n)}, {}});
  auto apart = std::make_shared<const Geometry>(Geometry{{triangle_soup(n, 10.0f, 0.1f, seed)}, {}});
  return [same, apart](const StabilityMethod& method) {
    const double usual = make_accelerator(method.accel, *apart, method.options())->build_report().seconds;
    const double seconds = make_accelerator(method.accel, *same, method.options())->build_report().seconds;
    return StabilityCount{seconds > 0.1 && seconds > 20.0 * usual ? 1u : 0u, 1};
  };
}

}  // namespace

std::vector<StabilityCase> stability_traversal_cases() {
  using enum StabilityMethods;
  const std::string differs = "differs from the exact answer";
  return {
      {9, "face-plane", "Rays in the planes of a box's faces, from outside", "goes past the box", "size of the box",
       queries, powers_of_ten(-6, 6, 2), 1e-6, 1e6, "rtiow watertight", face_planes},
      {21, "copies", "Copies of one triangle", "wrong t, or a tree deeper than 64", "number of copies", queries,
       powers_of_ten(0, 5), 1, 1e5, "", copies},
      {22, "bad-vertices", "Triangles of which some have a vertex that is NaN, infinite or 3e18",
       "not as without them, or not counted", "share of bad triangles", queries, values(0.01, 0.1, 0.5, 0.9), 0.01, 0.9,
       "", bad_vertices},
      {23, "powers-of-two", "Triangles at 2^-i, which make a deep tree", differs, "number of triangles", queries,
       values(4, 8, 16, 36, 48, 64, 96), 4, 96, "", powers_of_two},
      {33, "far-geometry", "A far triangle beside a closed mesh", "another answer than without it",
       "distance of the triangle", queries, powers_of_ten(1, 17, 2), 10, 1e17, "", far_geometry},
      {39, "same-bits", "The bits of list with the same triangle test", "another bit of t", "scale of the scene",
       queries, powers_of_ten(-30, 15, 5), 1e-30, 1e15, "", bits_of_list},
      {40, "build-copies", "Building identical triangles", "20 times as long as triangles apart", "number of triangles",
       qualities, values(1e3, 1e4, 1e5), 1e3, 1e5, "", building_copies},
  };
}

}  // namespace raylab
