// `bvh`: the same hits as without a tree, with every instruction set the machine has.
#include <cmath>
#include <limits>

#include "batches.hpp"
#include "catch.hpp"
#include "raylab/accel/accelerator.hpp"
#include "raylab/core/error.hpp"
#include "raylab/core/parallel.hpp"
#include "raylab/measure/ray_sets.hpp"
#include "raylab/measure/shapes.hpp"

using namespace raylab;
using raylab::test::check_batches;

namespace {

/// One `bvh` for each instruction set; those the processor does not have are left out.
std::vector<std::unique_ptr<Accelerator>> for_every_isa(const Geometry& geometry, Intersector intersector) {
  std::vector<std::unique_ptr<Accelerator>> all;
  for (const Isa isa : kCompiledIsas) {
    try {
      all.push_back(make_accelerator("bvh", geometry, {.intersector = intersector, .isa = isa}));
      CHECK(all.back()->build_report().isa == isa_name(isa));
    } catch (const Error& error) {
      REQUIRE(error.kind() == ErrorKind::usage);
    }
  }
  return all;
}

/// Not one bit of a hit may differ from that of `list` with the same intersector.
void check_equal_hits(const std::string& what, const Geometry& geometry, const std::vector<Ray>& rays,
                      const std::vector<Intersector>& intersectors = {Intersector::book, Intersector::fast,
                                                                      Intersector::watertight}) {
  const FlushDenormals flush;
  for (const Intersector intersector : intersectors) {
    const auto list = make_accelerator("list", geometry, {.intersector = intersector});
    for (const auto& bvh : for_every_isa(geometry, intersector)) {
      INFO(what << ", " << intersector_name(intersector) << ", " << bvh->build_report().isa);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        INFO("ray " << i);
        const auto expected = list->intersect(rays[i]);
        REQUIRE(bvh->intersect(rays[i]) == expected);
        REQUIRE(bvh->occluded(rays[i]) == expected.has_value());
      }
      check_batches(*bvh, rays);
    }
  }
}

/// Rays into the box whose directions have components of 0, -0 and denormals.
std::vector<Ray> awkward_rays(const Bounds& bounds, std::size_t count) {
  std::vector<Ray> rays = random_rays(bounds, count, 3);
  const float awkward[] = {0.0f, -0.0f, 1e-40f, -1e-45f, 1e-30f};
  for (std::size_t i = 0; i < rays.size(); ++i) {
    rays[i].direction[static_cast<int>(i) % 3] = awkward[i % 5];
    if (i % 4 == 0) rays[i].direction[static_cast<int>(i + 1) % 3] = awkward[(i / 4) % 5];
    if (i % 2 == 0) rays[i].origin = bounds.center();
  }
  return rays;
}

/// Rays in the planes of triangles, but for rounding, from beside each triangle through its inside; those of one
/// triangle side by side.
std::vector<Ray> rays_in_planes(const TriangleMesh& mesh, std::uint32_t triangles, std::size_t rays_each) {
  UniformFloats random(9);
  std::vector<Ray> rays;
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const Triangle t = triangle_corners(mesh, i);
    for (std::size_t j = 0; j < rays_each; ++j) {
      const auto point = [&](float from, float to) {
        const float a = random(from, to), b = random(0.0f, 0.3f);
        return t.p0 + a * (t.p1 - t.p0) + b * (t.p2 - t.p0);
      };
      const vec3 origin = point(-3.0f, -2.0f);
      rays.push_back({origin, point(0.2f, 0.5f) - origin});
    }
  }
  return rays;
}

/// A triangle across the column of that number, at height z.
void add_across(TriangleMesh& mesh, int column, float z) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  const float x = 4.0f * static_cast<float>(column);
  mesh.positions.insert(mesh.positions.end(), {{x - 1.0f, -1.0f, z}, {x + 3.0f, -1.0f, z}, {x - 1.0f, 3.0f, z}});
  mesh.triangles.push_back({first, first + 1, first + 2});
}

/// Up and down this number of columns in turns, through all that is across them.
std::vector<Ray> rays_along_columns(std::size_t columns, float height, std::size_t count) {
  UniformFloats random(4);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i) {
    const bool up = i / columns % 2 == 0;
    const vec3 origin(4.0f * static_cast<float>(i % columns), random(-0.4f, 0.4f), up ? -1.0f : height + 1.0f);
    rays.push_back({origin, {random(-1e-4f, 1e-4f), 0.0f, up ? 1.0f : -1.0f}});
    rays.back().t_min = random(0.0f, 0.5f * height);
  }
  return rays;
}

/// Beams of 64 rays that fly together, from far and near, wide and narrow, from one point and from a disk: at vertices
/// of the mesh, one ray of four exactly, so that many rays meet edges and vertices up to rounding.
std::vector<Ray> beams(const TriangleMesh& mesh, float size, std::size_t count) {
  UniformFloats random(11);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i) {
    const vec3 at = mesh.positions[i * 7919 % mesh.positions.size()];
    const vec3 from = at + size * random(0.1f, 3.0f) * random.in_box(vec3(-1.0f), vec3(1.0f));
    const float width = size * std::ldexp(1.0f, -static_cast<int>(i % 20));
    const float lens = i % 3 == 0 ? 0.0f : 0.3f * width;
    for (int ray = 0; ray < 64; ++ray) {
      const vec3 target = at + (ray % 4 == 0 ? 0.0f : width) * random.in_box(vec3(-1.0f), vec3(1.0f));
      const vec3 origin = from + lens * random.in_box(vec3(-1.0f), vec3(1.0f));
      rays.push_back({origin, target - origin});
      if (i % 5 == 0) rays.back().t_max = random(0.5f, 1.5f);
      if (i % 7 == 0 && ray % 32 == 15)
        rays.back().origin[static_cast<int>(i % 3)] = std::numeric_limits<float>::quiet_NaN();
    }
  }
  return rays;
}

}  // namespace

TEST_CASE("bvh gives the hits of list to rays that fly together", "[agreement]") {
  for (const float size : {1.0f, 1e-6f, 1e8f}) {
    const Geometry meshes{{icosphere(vec3(0.0f), size, 3), triangle_soup(300, size, 0.3f * size, 5)}, {}};
    check_equal_hits("meshes", meshes, beams(meshes.meshes[0], size, 60), {Intersector::watertight});
    const Geometry far{{icosphere(vec3(size, 100.0f * size, 3.0f * size), size, 3)}, {}};
    check_equal_hits("far from 0", far, beams(far.meshes[0], size, 40), {Intersector::watertight});
  }
  const Geometry mixed{{icosphere(vec3(0.1f), 0.6f, 2)}, sphere_soup(200, 1.0f, 0.2f, 3)};
  check_equal_hits("with spheres", mixed, beams(mixed.meshes[0], 1.0f, 60), {Intersector::watertight});
}

TEST_CASE("bvh gives the hits of list, bit for bit, with every instruction set and intersector", "[agreement]") {
  const Geometry soup{{triangle_soup(1500, 1.0f, 0.3f, 1)}, {}};
  check_equal_hits("soup", soup, random_rays(soup.bounds(), 3000, 1));
  check_equal_hits("soup", soup, awkward_rays(soup.bounds(), 1000));
  const Geometry overlapping{{triangle_soup(200, 1.0f, 6.0f, 2)}, {}};
  check_equal_hits("overlapping", overlapping, random_rays(overlapping.bounds(), 3000, 2));
  const Geometry mixed{{triangle_soup(200, 1.0f, 0.3f, 3), icosphere(vec3(0.1f), 0.6f, 2)},
                       sphere_soup(200, 1.0f, 0.2f, 3)};
  check_equal_hits("mixed", mixed, random_rays(mixed.bounds(), 3000, 3));
  check_equal_hits("mixed", mixed, awkward_rays(mixed.bounds(), 1000));
}

TEST_CASE("batches of bvh get through trees that keep many nodes waiting", "[agreement]") {
  // All boxes of one column are met by all of its rays: as many siblings wait as the tree is deep.
  Geometry column{{TriangleMesh{}}, {}};
  for (int i = 0; i < 40000; ++i) add_across(column.meshes[0], 0, static_cast<float>(i));
  // What a packet meets together holds many parts that half of its rays meet.
  Geometry alternating{{TriangleMesh{}}, {}};
  for (int i = 0; i < 1280; ++i) {
    const int cluster = i / 20;
    add_across(alternating.meshes[0], cluster % 2, 100.0f * static_cast<float>(cluster) + static_cast<float>(i % 20));
  }
  const FlushDenormals flush;
  for (const auto& bvh : for_every_isa(column, Intersector::watertight)) {
    INFO("column, " << bvh->build_report().isa);
    check_batches(*bvh, rays_along_columns(2, 40000.0f, 600));  // the second column is empty
  }
  for (const auto& bvh : for_every_isa(alternating, Intersector::watertight)) {
    INFO("alternating, " << bvh->build_report().isa);
    check_batches(*bvh, rays_along_columns(2, 6400.0f, 600));
  }
}

TEST_CASE("bvh gives the same hits with every instruction set to rays in the planes of triangles", "[agreement]") {
  // Where the ray runs along a triangle but for rounding, it is a matter of rounding whether and where it is hit.
  // A tree may then answer otherwise than `list`, which has no boxes that could be missed; but always the same.
  const FlushDenormals flush;
  const Geometry soup{{triangle_soup(1500, 1.0f, 0.3f, 1)}, {}};
  const std::vector<Ray> rays = rays_in_planes(soup.meshes[0], 200, 48);
  const auto bvhs = for_every_isa(soup, Intersector::watertight);
  std::size_t hits = 0;
  for (const auto& bvh : bvhs) {
    INFO(bvh->build_report().isa);
    for (const Ray& ray : rays) {
      const auto hit = bvh->intersect(ray);
      hits += hit.has_value();
      REQUIRE(hit == bvhs[0]->intersect(ray));
      REQUIRE(bvh->occluded(ray) == hit.has_value());
    }
    check_batches(*bvh, rays);
  }
  CHECK(hits > rays.size() / 2);
}

TEST_CASE("bvh gives the hits of list to rays that start on surfaces and to directions of any length", "[agreement]") {
  const Geometry mixed{{icosphere(vec3(0.0f), 1.0f, 3), triangle_soup(100, 1.0f, 0.5f, 5)},
                       sphere_soup(50, 1.0f, 0.2f, 5)};
  const auto list = make_accelerator("list", mixed);
  std::vector<Ray> rays = random_rays(mixed.bounds(), 3000, 7);
  UniformFloats uniform(8);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Ray& ray = rays[i];
    if (const auto hit = list->intersect(ray)) ray.origin = ray.at(hit->t);
    ray.direction = uniform.in_box(vec3(-1.0f), vec3(1.0f));
    if (i % 5 == 0) ray.origin = mixed.spheres[i % mixed.spheres.size()].center;  // halfway between its two roots
    if (i % 7 == 0) ray.direction *= std::ldexp(1.0f, static_cast<int>(i % 240) - 120);
  }
  // The book's test depends on the length.
  check_equal_hits("on surfaces", mixed, rays, {Intersector::watertight});
}

TEST_CASE("bvh gives the hits of list among triangles of all sizes at once, and occludes what it hits", "[agreement]") {
  const FlushDenormals flush;
  UniformFloats random(21);
  for (const float exponents : {20.0f, 60.0f}) {
    const auto point = [&] {
      vec3 p;
      for (int axis = 0; axis < 3; ++axis) p[axis] = random(-1.0f, 1.0f) * std::exp2(random(-exponents, exponents));
      return p;
    };
    TriangleMesh mesh;
    for (std::uint32_t i = 0; i < 300; ++i) {
      for (int k = 0; k < 3; ++k) mesh.positions.push_back(point());
      mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    std::vector<Ray> rays;
    for (std::uint32_t i = 0; i < 20000; ++i) {
      const Triangle t = triangle_corners(mesh, i % 300);
      const float a = random(0.0f, 1.0f), b = random(0.0f, 1.0f - a);
      const vec3 origin = point();
      rays.push_back({origin, a * t.p0 + b * t.p1 + (1.0f - a - b) * t.p2 - origin});
    }
    const Geometry geometry{{mesh}, {}};
    if (exponents == 20.0f) {
      check_equal_hits("sizes of 2^-20 to 2^20", geometry, rays, {Intersector::watertight});
      continue;
    }
    for (const auto& bvh : for_every_isa(geometry, Intersector::watertight)) check_batches(*bvh, rays);
  }
}

TEST_CASE("of triangles hit at the same distance bvh gives the one with the smallest id, as list does", "[agreement]") {
  const TriangleMesh sphere = icosphere(vec3(0.0f), 1.0f, 2);
  const Geometry geometry{{sphere, sphere}, {{vec3(0.0f), 0.5f}, {vec3(0.0f), 0.5f}}};
  check_equal_hits("vertices", geometry, rays_at_vertices(sphere, vec3(0.0f), 0.55f, 2000, 1));
  check_equal_hits("edges", geometry, rays_at_edges(sphere, vec3(0.0f), 0.55f, 2000, 1));
}

TEST_CASE("bvh leaks nothing at the vertices and edges of closed meshes of any size and place", "[stability]") {
  const FlushDenormals flush;
  struct Place {
    float radius;
    vec3 center;
  };
  for (const Place& place : {Place{2.0f, vec3(0.0f)}, Place{2.0f, {148376, 1234, -223423}}, Place{1e-3f, vec3(0.0f)},
                             Place{1e-6f, vec3(0.0f)}, Place{1e10f, vec3(0.0f)}}) {
    const Geometry geometry{{icosphere(place.center, place.radius, 4)}, {}};
    const float spread = 0.4f * place.radius;
    for (const auto& bvh : for_every_isa(geometry, Intersector::watertight)) {
      std::size_t leaks = 0;
      for (const auto& aimed : {rays_at_vertices(geometry.meshes[0], place.center, spread, 20000, 1),
                                rays_at_edges(geometry.meshes[0], place.center, spread, 20000, 1)}) {
        for (const Ray& ray : aimed) leaks += bvh->intersect(ray) && bvh->occluded(ray) ? 0 : 1;
      }
      INFO("radius " << place.radius << ", " << bvh->build_report().isa);
      CHECK(leaks == 0);
    }
  }
}

TEST_CASE("bvh hits the same with directions of any length, and ends of the interval are open", "[agreement]") {
  const Geometry geometry{{triangle_soup(500, 1.0f, 0.4f, 4)}, sphere_soup(50, 1.0f, 0.3f, 4)};
  std::vector<Ray> rays = random_rays(geometry.bounds(), 600, 4);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    rays[i].direction *= std::ldexp(1.0f, static_cast<int>(i % 201) - 100);
  }
  const FlushDenormals flush;
  const auto list = make_accelerator("list", geometry);
  for (const auto& bvh : for_every_isa(geometry, Intersector::watertight)) {
    for (Ray ray : rays) {
      const auto hit = list->intersect(ray);
      REQUIRE(bvh->intersect(ray) == hit);
      if (!hit) continue;
      ray.t_max = hit->t;
      REQUIRE_FALSE(bvh->occluded(ray));
      REQUIRE_FALSE(bvh->intersect(ray).has_value());
      ray.t_max = next_float_up(hit->t);
      REQUIRE(bvh->occluded(ray));
      REQUIRE(bvh->intersect(ray) == hit);
    }
  }
}
