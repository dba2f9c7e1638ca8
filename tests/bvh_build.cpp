// `bvh`: its tree on inputs of any shape.
#include <cmath>
#include <optional>

#include "accel/bvh/build/collapse.hpp"
#include "catch.hpp"
#include "raylab/accel/accelerator.hpp"
#include "raylab/core/parallel.hpp"
#include "raylab/measure/ray_sets.hpp"
#include "raylab/measure/shapes.hpp"

using namespace raylab;

namespace {

/// A tree deeper than this could be traversed wrongly: the stack has room for no more.
constexpr int kDepthLimit = 80;

std::vector<Ray> rays_into(const Geometry& geometry, std::size_t count) {
  return random_rays(geometry.bounds(), count, 5);
}

void check_depth_and_hits(const std::string& what, const Geometry& geometry, std::size_t rays) {
  const FlushDenormals flush;
  const auto judge = make_accelerator("list", geometry);
  for (const BuildQuality quality : {BuildQuality::fast, BuildQuality::balanced, BuildQuality::best}) {
    const auto bvh = make_accelerator("bvh", geometry, {.quality = quality});
    INFO(what << ", " << quality_name(quality) << ", depth " << bvh->build_report().depth);
    CHECK(bvh->build_report().primitives == geometry.primitive_count());
    CHECK(bvh->build_report().depth <= kDepthLimit);
    for (const Ray& ray : rays_into(geometry, rays)) {
      const auto expected = judge->intersect(ray);
      REQUIRE(bvh->intersect(ray) == expected);
      REQUIRE(bvh->occluded(ray) == expected.has_value());
    }
  }
}

TriangleMesh repeated(const Triangle& triangle, std::size_t copies) {
  TriangleMesh mesh;
  mesh.positions = {triangle.p0, triangle.p1, triangle.p2};
  mesh.triangles.assign(copies, uvec3(0, 1, 2));
  mesh.pad_positions();
  return mesh;
}

}  // namespace

TEST_CASE("bvh builds on nothing, on one primitive and on many in one place, with bounded depth", "[stability]") {
  const Triangle triangle{{0, 0, 0}, {1, 0, 0.3f}, {0, 1, 0.1f}};
  const Geometry none;
  const auto empty = make_accelerator("bvh", none);
  CHECK_FALSE(empty->intersect({{0, 0, 0}, {1, 0, 0}}).has_value());
  CHECK_FALSE(empty->occluded({{0, 0, 0}, {1, 0, 0}}));
  CHECK(empty->build_report().primitives == 0);

  check_depth_and_hits("one triangle", {{repeated(triangle, 1)}, {}}, 1000);
  check_depth_and_hits("one sphere", {{}, {{{1, 2, 3}, 0.5f}}}, 1000);
  check_depth_and_hits("100,000 copies of a triangle", {{repeated(triangle, 100000)}, {}}, 3);
  check_depth_and_hits("10,000 copies of a sphere", {{}, std::vector<Sphere>(10000, {{1, 2, 3}, 0.5f})}, 10);
}

TEST_CASE("bvh stays shallow on primitives that no plane parts well", "[stability]") {
  std::vector<Sphere> shells, chain, line;
  for (int i = 0; i < 3000; ++i) {
    const auto x = static_cast<float>(i);
    shells.push_back({vec3(0.0f), 1.0f + x});
    line.push_back({{x * x, 0, 0}, 0.3f});
  }
  for (int i = 0; i < 120; ++i) {
    const float scale = std::ldexp(1.0f, 60 - i);
    chain.push_back({vec3(scale, 0, 0), 0.1f * scale});
  }
  check_depth_and_hits("nested spheres", {{}, shells}, 20);
  check_depth_and_hits("spheres along a line", {{}, line}, 20);
  check_depth_and_hits("spheres at powers of two", {{}, chain}, 300);

  TriangleMesh spokes;  // all through one line, so that their boxes overlap
  for (std::uint32_t i = 0; i < 2000; ++i) {
    const float angle = 0.003f * static_cast<float>(i);
    spokes.positions.insert(spokes.positions.end(),
                            {vec3(0, 0, -1), vec3(0, 0, 1), vec3(std::cos(angle), std::sin(angle), 0)});
    spokes.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  spokes.pad_positions();
  check_depth_and_hits("spokes", {{spokes}, {}}, 50);
}

TEST_CASE("bvh builds the same tree with any number of threads", "[unit]") {
  const FlushDenormals flush;
  const Geometry geometry{{triangle_soup(30000, 1.0f, 0.05f, 1), icosphere(vec3(0.2f), 0.5f, 5)},
                          sphere_soup(5000, 1.0f, 0.02f, 1)};
  const std::vector<Ray> rays = rays_into(geometry, 2000);
  for (const BuildQuality quality : {BuildQuality::fast, BuildQuality::balanced, BuildQuality::best}) {
    const auto single = make_accelerator("bvh", geometry, {.threads = 1, .quality = quality});
    for (const int threads : {2, 3, 8}) {
      const auto several = make_accelerator("bvh", geometry, {.threads = threads, .quality = quality});
      CHECK(several->build_report().nodes == single->build_report().nodes);
      CHECK(several->build_report().bytes == single->build_report().bytes);
      CHECK(several->build_report().depth == single->build_report().depth);
      CHECK(several->build_report().sah_cost == single->build_report().sah_cost);
      for (const Ray& ray : rays) REQUIRE(several->intersect(ray) == single->intersect(ray));
    }
  }
}

TEST_CASE("the best tree of bvh moves subtrees to where they cost less", "[unit]") {
  const FlushDenormals flush;
  // Spheres, since space is not split for them: large ones over small ones, which planes part badly.
  std::vector<Sphere> spheres = sphere_soup(20000, 1.0f, 0.01f, 1);
  const std::vector<Sphere> large = sphere_soup(500, 1.0f, 0.5f, 2);
  spheres.insert(spheres.end(), large.begin(), large.end());
  const Geometry geometry{{}, spheres};
  const auto balanced = make_accelerator("bvh", geometry, {.quality = BuildQuality::balanced});
  const auto best = make_accelerator("bvh", geometry, {.quality = BuildQuality::best});
  CHECK(best->build_report().sah_cost < 0.98 * balanced->build_report().sah_cost);
  for (const Ray& ray : rays_into(geometry, 5000)) REQUIRE(best->intersect(ray) == balanced->intersect(ray));
}

TEST_CASE("the best tree of bvh splits the space that large triangles share, and loses none of them", "[unit]") {
  const FlushDenormals flush;
  const Geometry geometry{{triangle_soup(20000, 1.0f, 0.01f, 1), triangle_soup(500, 1.0f, 1.0f, 2)},
                          sphere_soup(100, 1.0f, 0.1f, 3)};
  const auto list = make_accelerator("list", geometry);
  const auto balanced = make_accelerator("bvh", geometry, {.quality = BuildQuality::balanced});
  const auto best = make_accelerator("bvh", geometry, {.quality = BuildQuality::best});
  CHECK(best->build_report().sah_cost < 0.7 * balanced->build_report().sah_cost);
  CHECK(best->build_report().primitives == geometry.primitive_count());
  CHECK(best->build_report().bytes < 1.35 * static_cast<double>(balanced->build_report().bytes));
  for (const auto& rays : {rays_into(geometry, 3000), rays_at_vertices(geometry.meshes[1], vec3(0.0f), 2.0f, 1500, 1),
                           rays_at_edges(geometry.meshes[1], vec3(0.0f), 2.0f, 1500, 1)}) {
    for (const Ray& ray : rays) {
      const auto expected = list->intersect(ray);
      REQUIRE(best->intersect(ray) == expected);
      REQUIRE(best->occluded(ray) == expected.has_value());
    }
  }
}

TEST_CASE("a ray meets the children of a node of bvh in their order, where a plane parts them or one holds the other",
          "[unit]") {
  const FlushDenormals flush;
  UniformFloats uniform(1);
  const auto box_of = [](const Sphere& s) {
    Bounds bounds;
    bounds.extend(s.center - s.radius);
    bounds.extend(s.center + s.radius);
    return bounds;
  };
  const auto entry = [](const Bounds& box, const Ray& ray) -> std::optional<double> {
    double near = 0.0, far = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      const double d = ray.direction[axis], o = ray.origin[axis];
      const double a = (box.lower[axis] - o) / d, b = (box.upper[axis] - o) / d;
      near = std::max(near, std::min(a, b));
      far = std::min(far, std::max(a, b));
    }
    if (near > far) return std::nullopt;
    return near;
  };
  int parted = 0, held = 0;
  for (int pair = 0; pair < 1000; ++pair) {
    const float radius = uniform(0.05f, 0.3f);
    const std::vector<Sphere> spheres{
        {uniform.in_box(vec3(-1.0f), vec3(1.0f)), radius},
        {uniform.in_box(vec3(-1.0f), vec3(1.0f)), radius * std::exp2(uniform(-1.0f, 4.0f))}};
    const Bounds boxes[2] = {box_of(spheres[0]), box_of(spheres[1])};
    const bool is_parted = glm::any(glm::lessThan(boxes[0].upper, boxes[1].lower)) ||
                           glm::any(glm::lessThan(boxes[1].upper, boxes[0].lower));
    const bool is_held = glm::all(glm::lessThan(boxes[1].lower, boxes[0].lower)) &&
                         glm::all(glm::lessThan(boxes[0].upper, boxes[1].upper));
    if (!is_parted && !is_held) continue;
    const bvh::WideTree tree = bvh::build_wide_tree({{}, spheres}, BuildQuality::balanced);
    REQUIRE(bvh::ref_kind(tree.root) == bvh::RefKind::node);
    const auto& node = reinterpret_cast<const bvh::Node&>(tree.lines[bvh::ref_index(tree.root)]);
    for (const Ray& ray : random_rays({vec3(-2.0f), vec3(2.0f)}, 200, static_cast<std::uint64_t>(pair))) {
      const auto first = entry(boxes[0], ray), second = entry(boxes[1], ray);
      if (!first || !second || *first == *second) continue;
      const int octant = (ray.direction.x < 0 ? 1 : 0) | (ray.direction.y < 0 ? 2 : 0) | (ray.direction.z < 0 ? 4 : 0);
      const std::uint32_t nearest = bvh::ref_index(node.child[node.order[octant] & 15u]);
      REQUIRE(tree.ids[nearest].primitive == (*first < *second ? 0u : 1u));
      ++(is_parted ? parted : held);
    }
  }
  CHECK(parted > 100);
  CHECK(held > 100);
}

TEST_CASE("bvh follows the surface area heuristic but for the fast tree", "[unit]") {
  const FlushDenormals flush;
  const Geometry geometry{{triangle_soup(20000, 1.0f, 0.01f, 1), triangle_soup(500, 1.0f, 0.3f, 2)}, {}};
  const auto fast = make_accelerator("bvh", geometry, {.quality = BuildQuality::fast});
  const auto balanced = make_accelerator("bvh", geometry, {.quality = BuildQuality::balanced});
  CHECK(balanced->build_report().sah_cost < 0.95 * fast->build_report().sah_cost);
  for (const Ray& ray : rays_into(geometry, 5000)) REQUIRE(fast->intersect(ray) == balanced->intersect(ray));
}

TEST_CASE("bvh makes the same tree of a mesh whether its triangles share their vertices or each has its own",
          "[unit]") {
  const FlushDenormals flush;
  const Geometry shared{{icosphere(vec3(0.0f), 1.0f, 4)}, {}};
  Geometry separate{{{}}, {}};
  for (std::uint32_t i = 0; i < shared.meshes[0].triangles.size(); ++i) {
    const Triangle t = triangle_corners(shared.meshes[0], i);
    separate.meshes[0].triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    separate.meshes[0].positions.insert(separate.meshes[0].positions.end(), {t.p0, t.p1, t.p2});
  }
  separate.meshes[0].pad_positions();
  const auto a = make_accelerator("bvh", shared);
  const auto b = make_accelerator("bvh", separate);
  CHECK(b->build_report().bytes == a->build_report().bytes);
  CHECK(b->build_report().sah_cost == a->build_report().sah_cost);
  for (const Ray& ray : rays_into(shared, 5000)) REQUIRE(a->intersect(ray) == b->intersect(ray));
}

TEST_CASE("bvh makes wide nodes of geometry whose areas no float holds", "[unit]") {
  const FlushDenormals flush;
  const Geometry large{{icosphere(vec3(0.0f), 1.0f, 4)}, {}}, tiny{{icosphere(vec3(0.0f), 1e-20f, 4)}, {}};
  const std::size_t nodes = make_accelerator("bvh", large)->build_report().nodes;
  const auto bvh = make_accelerator("bvh", tiny);
  CHECK(bvh->build_report().nodes < nodes + nodes / 4);
  CHECK(bvh->build_report().sah_cost > 1.0);
}

TEST_CASE("bvh needs no more memory for triangles that share nothing than their corners twice", "[unit]") {
  const Geometry soup{{triangle_soup(50000, 1.0f, 0.02f, 3)}, {}};
  CHECK(make_accelerator("bvh", soup)->build_report().bytes < 50000u * 72u);
}

TEST_CASE("the options of bvh have names", "[unit]") {
  for (const Isa isa : {Isa::sse42, Isa::avx2, Isa::avx512, Isa::neon}) CHECK(parse_isa(isa_name(isa)) == isa);
  for (const BuildQuality quality : {BuildQuality::fast, BuildQuality::balanced, BuildQuality::best}) {
    CHECK(parse_quality(quality_name(quality)) == quality);
  }
  CHECK_THROWS(parse_isa("mmx"));
  CHECK_THROWS(parse_quality("good"));
}
