#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "catch.hpp"
#include "glm_formulas.hpp"
#include "raylab/accel/accelerator.hpp"
#include "raylab/core/parallel.hpp"
#include "raylab/scene/surface_point.hpp"
#include "test_scenes.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed * 1000003) {}
  float unit() { return bits_to_unit(static_cast<std::uint32_t>(mix_bits(++state_ * 0x9e3779b97f4a7c15ull) >> 32)); }
  float sign() { return unit() < 0.5f ? -1.0f : 1.0f; }
  vec3 cube() {
    const float x = 2.0f * unit() - 1.0f;
    const float y = 2.0f * unit() - 1.0f;
    return {x, y, 2.0f * unit() - 1.0f};
  }
  vec3 direction() {
    const float u = unit();
    return uniform_sphere({u, unit()});
  }
  /// A direction at any angle, or (every other one) almost in the plane across n: |cosine| from 1e-7 to 1.
  vec3 around(const vec3& n) {
    if ((++calls_ & 1) != 0) return direction();
    const float z = sign() * std::pow(10.0f, -7.0f * unit());
    const float phi = 2.0f * kPi * unit();
    const float r = std::sqrt(1.0f - z * z);
    return glm::normalize(test::GlmFrame(n).to_world({r * std::cos(phi), r * std::sin(phi), z}));
  }

 private:
  std::uint64_t state_;
  int calls_ = 0;
};

/// An accelerator under test.
struct Tested {
  const char* label;
  const char* name;
  std::optional<Intersector> intersector;
};
constexpr Tested kTested[] = {{"list, watertight", "list", Intersector::watertight},
                              {"list, fast", "list", Intersector::fast},
                              {"embree", "embree", {}},
                              {"embree-robust", "embree-robust", {}}};

std::unique_ptr<Accelerator> make(const Tested& tested, const Geometry& geometry) {
  AcceleratorOptions options;
  options.intersector = tested.intersector;
  return make_accelerator(tested.name, geometry, options);
}

/// Makes one triangle of a shape, of size about 1, at the place `center` it may change.
using Shape = std::function<Triangle(Random&, vec3& center, int index)>;

Triangle any_triangle(Random& random) {
  const vec3 p0 = random.cube();
  const vec3 p1 = random.cube();
  return {p0, p1, random.cube()};
}

Triangle needle(Random& random, float width) {
  const vec3 along = random.direction();
  return {-along, along, (2.0f * random.unit() - 1.0f) * along + width * test::GlmFrame(along).x};
}

/// A triangle across a coordinate axis, at 0 or elsewhere.
Triangle across_axis(Random& random, vec3& center, int axis, bool at_zero) {
  Triangle t = any_triangle(random);
  const float height = at_zero ? 0.0f : 2.0f * random.unit() - 1.0f;
  if (at_zero) center[axis] = 0.0f;
  t.p0[axis] = t.p1[axis] = t.p2[axis] = height;
  return t;
}

TriangleMesh make_triangles(const Shape& shape, float scale, float distance, Random& random) {
  TriangleMesh mesh;
  for (int i = 0; i < 20; ++i) {
    vec3 center = distance * random.cube();
    const Triangle t = shape(random, center, i);
    for (const vec3& p : {t.p0, t.p1, t.p2}) mesh.positions.push_back(scale * (p + center));
    const auto n = static_cast<std::uint32_t>(3 * i);
    mesh.triangles.push_back({n, n + 1, n + 2});
  }
  mesh.pad_positions();
  return mesh;
}

enum class Start { bounds, book, at_hit };

/// What became of rays that start where others have hit.
struct Restarts {
  int started = 0;
  int returned = 0;    ///< hit the triangle they start on
  int not_finite = 0;  ///< had no normal or no start
  int not_unit = 0;    ///< had a normal of another length
  double largest_offset = 0.0;
};

Restarts restart(const Geometry& geometry, const Accelerator& accelerator, float scale, Start start, Random& random) {
  Restarts result;
  const TriangleMesh& mesh = geometry.meshes[0];
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle t = triangle_corners(mesh, i);
    for (int k = 0; k < 160; ++k) {
      const float a = 1.0f - std::sqrt(random.unit());
      const float b = random.unit() * (1.0f - a);
      const vec3 target = (1.0f - a - b) * t.p0 + a * t.p1 + b * t.p2;
      const vec3 d = random.direction();
      const Ray ray{target - 3.0f * scale * d, d};
      const auto hit = accelerator.intersect(ray);
      if (!hit || hit->primitive != i) continue;
      const auto point = surface_point(geometry, ray, *hit);
      const vec3 wi = random.around(point.ng);
      const vec3 origin = start == Start::bounds ? offset_origin(point, wi) : point.position;
      ++result.started;
      if (!is_finite(origin) || !is_finite(point.ng) || !(point.offset > 0.0f)) {
        ++result.not_finite;
        continue;
      }
      result.not_unit += std::abs(glm::length(point.ng) - 1.0f) > 1e-5f;
      result.largest_offset = std::max(result.largest_offset, static_cast<double>(point.offset));
      const Ray next{origin, wi, start == Start::book ? 0.001f : 0.0f};
      const auto again = accelerator.intersect(next);
      result.returned += again && again->primitive == i;
    }
  }
  return result;
}

struct NamedShape {
  const char* name;
  Shape make;
  float farthest;        ///< of the distances from the origin at which the shape is still one
  float largest_offset;  ///< in sizes, to which rounding in a needle's plane equation may lead
};
const NamedShape kShapes[] = {
    {"triangles", [](Random& r, vec3&, int) { return any_triangle(r); }, 1e5f, 1e-3f},
    {"needles 1:1,000", [](Random& r, vec3&, int) { return needle(r, 1e-3f); }, 1e3f, 5e-3f},
    {"needles 1:100,000", [](Random& r, vec3&, int) { return needle(r, 1e-5f); }, 10.0f, 0.5f},
    {"planes across an axis", [](Random& r, vec3& c, int i) { return across_axis(r, c, i % 3, false); }, 1e5f, 1e-3f},
    {"planes across an axis at 0", [](Random& r, vec3& c, int i) { return across_axis(r, c, i % 3, true); }, 1e5f,
     1e-3f},
};

}  // namespace

TEST_CASE("no ray returns to the triangle it starts on, whatever the scale, shape and place", "[stability][offset]") {
  const FlushDenormals flush;
  for (const Tested& tested : kTested) {
    for (const NamedShape& shape : kShapes) {
      int started = 0, returned = 0, broken = 0;
      std::string first;
      for (const float distance : {0.0f, 10.0f, 1e3f, 1e5f}) {
        if (distance > shape.farthest) continue;
        for (int exponent = -8; exponent <= 8; exponent += 2) {
          const float scale = std::pow(10.0f, static_cast<float>(exponent));
          Random random(static_cast<std::uint64_t>(exponent + 9) * 17 + static_cast<std::uint64_t>(distance));
          Geometry geometry;
          geometry.meshes.push_back(make_triangles(shape.make, scale, distance, random));
          const auto accelerator = make(tested, geometry);
          const Restarts r = restart(geometry, *accelerator, scale, Start::bounds, random);
          started += r.started;
          returned += r.returned;
          // Far away the offset is a few roundings of the coordinates.
          const bool sound = r.started >= 900 && r.not_finite == 0 && r.not_unit == 0 &&
                             r.largest_offset < scale * (shape.largest_offset + 4e-6f * distance);
          broken += !sound;
          if (first.empty() && (!sound || r.returned > 0)) {
            first = "; the first at scale 1e" + std::to_string(exponent) + ", " +
                    std::to_string(static_cast<int>(distance)) +
                    " sizes from the origin: " + std::to_string(r.returned) + " of " + std::to_string(r.started) +
                    " returned, " + std::to_string(r.not_finite) + " had no start, offset " +
                    std::to_string(r.largest_offset / scale) + " sizes";
          }
        }
      }
      INFO(tested.label << ", " << shape.name << ": " << returned << " of " << started << " rays returned, " << broken
                        << " unsound" << first);
      CHECK(returned == 0);
      CHECK(broken == 0);
    }
  }
}

TEST_CASE("without the offset, or with the book's, rays do return to where they start", "[stability][offset]") {
  const FlushDenormals flush;
  const auto returned = [](Start start, float scale) {
    Random random(3);
    Geometry geometry;
    geometry.meshes.push_back(make_triangles(kShapes[0].make, scale, 0.0f, random));
    const auto accelerator = make_accelerator("list", geometry);
    const Restarts r = restart(geometry, *accelerator, scale, start, random);
    REQUIRE(r.started > 900);
    return static_cast<double>(r.returned) / r.started;
  };
  // From the hit itself about every third ray, at every scale.
  for (const float scale : {1e-8f, 1.0f, 1e8f}) CHECK(returned(Start::at_hit, scale) > 0.1);
  // t_min = 0.001 serves at the scale it was made for, not where a rounding is more than a thousandth.
  CHECK(returned(Start::book, 1e8f) > 0.1);
  CHECK(returned(Start::book, 1e6f) > 0.05);
}

TEST_CASE("no ray that leaves a sphere hits it, and one that enters it meets the far side", "[stability][offset]") {
  const FlushDenormals flush;
  struct Case {
    float radius;
    vec3 center;
  };
  std::vector<Case> cases;
  for (int exponent = -4; exponent <= 4; ++exponent) {
    const float radius = std::pow(10.0f, static_cast<float>(exponent));
    cases.push_back({radius, vec3(0.0f)});
    cases.push_back({radius, radius * vec3(31.4f, -17.3f, 8.1f)});
  }
  cases.push_back({1.0f, vec3(1e5f, -1e5f, 0.7e5f)});
  cases.push_back({1.0f, vec3(0.0f, 1e5f, 0.0f)});
  for (const Tested& tested : kTested) {
    if (tested.intersector == Intersector::fast) continue;  // differs in triangles only
    for (const Case& c : cases) {
      Geometry geometry;
      geometry.spheres.push_back({c.center, c.radius});
      const auto accelerator = make(tested, geometry);
      Random random(5);
      int started = 0, returned = 0, wrong_far_side = 0;
      for (int k = 0; k < 1000; ++k) {
        const vec3 d = random.direction();
        const vec3 aim = c.center + 0.99f * c.radius * random.unit() * random.direction();
        const Ray ray{aim - 3.0f * c.radius * d, d};
        const auto hit = accelerator->intersect(ray);
        if (!hit) continue;
        ++started;
        const auto point = surface_point(geometry, ray, *hit);
        const vec3 wi = random.around(point.ng);
        const Ray next{offset_origin(point, wi), wi};
        const auto again = accelerator->intersect(next);
        if (glm::dot(wi, point.ng) >= 0.0f) {
          returned += again.has_value();
          continue;
        }
        const dvec3 o = dvec3(next.origin) - dvec3(c.center);
        const double b = glm::dot(o, dvec3(wi)) / glm::dot(dvec3(wi), dvec3(wi));
        const double inside = static_cast<double>(c.radius) * c.radius - glm::dot(o, o);
        const double far_side = -b + std::sqrt(b * b + inside / glm::dot(dvec3(wi), dvec3(wi)));
        wrong_far_side += !again || std::abs(again->t - far_side) > 1e-5 * far_side;
      }
      INFO(tested.label << ", radius " << c.radius << " at " << c.center.x << ' ' << c.center.y << ' ' << c.center.z);
      CHECK(started > 900);
      CHECK(returned == 0);
      CHECK(wrong_far_side == 0);
    }
  }
}

TEST_CASE("no ray that leaves a ground sphere of any radius hits it, and the offset is that of the point",
          "[stability][offset]") {
  const FlushDenormals flush;
  for (const Tested& tested : kTested) {
    for (int exponent = 2; exponent <= 7; ++exponent) {
      const float radius = std::pow(10.0f, static_cast<float>(exponent));
      Geometry geometry;
      geometry.spheres.push_back({vec3(0.0f, -radius, 0.0f), radius});
      const auto accelerator = make(tested, geometry);
      Random random(6);
      int started = 0, returned = 0;
      float largest_offset = 0.0f;
      double worst_height = 0.0;
      for (int k = 0; k < 2000; ++k) {
        const vec3 eye = 10.0f * random.cube() + vec3(0.0f, 11.0f, 0.0f);
        const vec3 d = random.direction();
        const Ray ray{eye, vec3(d.x, -std::abs(d.y) - 0.1f, d.z)};
        const auto hit = accelerator->intersect(ray);
        if (!hit) continue;
        ++started;
        const auto point = surface_point(geometry, ray, *hit);
        largest_offset =
            std::max(largest_offset, (point.offset - 0x1p-47f * radius) / max_component(glm::abs(point.position)));
        const double height = glm::length(dvec3(point.position) + dvec3(0.0, radius, 0.0)) - radius;
        worst_height = std::max(worst_height, std::abs(height) / glm::length(dvec3(point.position)));
        vec3 wi = random.around(point.ng);
        if (glm::dot(wi, point.ng) < 0.0f) wi = -wi;
        returned += accelerator->intersect({offset_origin(point, wi), wi}).has_value();
      }
      INFO(tested.label << ", radius " << radius);
      CHECK(started > 1000);
      CHECK(returned == 0);
      CHECK(largest_offset < 8.0f * kUnitRoundoff);
      CHECK(worst_height < 2e-7);
    }
  }
}

TEST_CASE("normals of spheres are finite where the point is the centre, and right seen from a million radii",
          "[stability][offset]") {
  const FlushDenormals flush;
  Geometry geometry;
  geometry.spheres = {{vec3(3e4f), 9e-4f}, {vec3(0.0f), 1.0f}};
  Random random(9);
  for (int k = 0; k < 2000; ++k) {
    const vec3 d = random.direction();
    const Ray at_tiny{vec3(3e4f) - 2.0f * d, d, 0.0f};
    const auto tiny = surface_point(geometry, at_tiny, {2.0f, 0.0f, 0.0f, geometry.sphere_geometry(), 0});
    REQUIRE(is_finite(tiny.ng));
    REQUIRE(glm::length(tiny.ng) == Approx(1.0f));
    REQUIRE(is_finite(offset_origin(tiny, d)));

    const Ray far{0.9f * random.direction() - 1e6f * d, d};
    const auto hit = make_accelerator("list", geometry)->intersect(far);
    if (!hit || hit->primitive != 1) continue;
    const dvec3 from(far.origin), along(far.direction);
    const double a = glm::dot(along, along), b = glm::dot(from, along);
    const dvec3 moment = glm::cross(from, along);
    const dvec3 n = from + (-b - std::sqrt(a - glm::dot(moment, moment))) / a * along;
    REQUIRE(glm::length(dvec3(surface_point(geometry, far, *hit).ng) - n) < 1e-6);
  }
}

TEST_CASE("slivers and huge triangles have the normals of their corners", "[stability][offset]") {
  const FlushDenormals flush;
  Random random(13);
  double worst = 0.0;
  for (int k = 0; k < 20'000; ++k) {
    const vec3 p0 = random.cube(), p1 = random.cube();
    const float along = random.unit(), width = std::pow(10.0f, -2.0f - 4.0f * random.unit());
    const float scale = k % 2 == 0 ? 1.0f : std::pow(10.0f, 10.0f + 7.0f * random.unit());
    const vec3 p2 = (1.0f - along) * p0 + along * p1 + width * random.cube();
    const Triangle t{scale * p0, scale * p1, scale * p2};
    const dvec3 n = glm::cross(dvec3(t.p1) - dvec3(t.p0), dvec3(t.p2) - dvec3(t.p0));
    const SurfacePoint point = point_on_triangle(t, 0.25f, 0.5f);
    REQUIRE(is_finite(point.ng));
    REQUIRE(point.offset < kInfinity);
    worst = std::max(worst, glm::length(dvec3(point.ng) - glm::normalize(n)));
  }
  // Up to 2^12 of cancellation float decides.
  CHECK(worst < 2e-3);
}

TEST_CASE("triangles of a few units in the last place have unit normals, and rays leave them", "[stability][offset]") {
  const FlushDenormals flush;
  Random random(10);
  int valid = 0, far_off = 0;
  for (int k = 0; k < 20'000; ++k) {
    const vec3 base = vec3(1.0f) + 0.9f * random.cube();
    const auto near = [&] {
      vec3 p = base;
      for (int axis = 0; axis < 3; ++axis) {
        for (int steps = static_cast<int>(4.0f * random.unit()); steps > 0; --steps) p[axis] = next_float_up(p[axis]);
      }
      return p;
    };
    const vec3 p0 = near(), p1 = near();
    const Triangle t{p0, p1, near()};
    const dvec3 n = glm::cross(dvec3(t.p1) - dvec3(t.p0), dvec3(t.p2) - dvec3(t.p0));
    if (n == dvec3(0.0)) continue;
    ++valid;
    const SurfacePoint point = point_on_triangle(t, 0.25f, 0.5f);
    REQUIRE(is_finite(point.ng));
    REQUIRE(is_finite(point.position));
    REQUIRE((point.offset > 0.0f && point.offset < 1e-5f));
    far_off += glm::length(dvec3(point.ng) - glm::normalize(n)) > 1e-6;
  }
  CHECK(valid > 15'000);
  CHECK(far_off == 0);
}

TEST_CASE("a sphere just inside another is found from the outer one", "[stability][offset]") {
  // Radii 1 and 1 + 4e-5: any epsilon that serves a scene of this size steps over the gap.
  const FlushDenormals flush;
  Geometry geometry;
  geometry.spheres = {{vec3(0.0f), 1.0f}, {vec3(0.0f), 1.0f + 4e-5f}};
  for (const Tested& tested : kTested) {
    const auto accelerator = make(tested, geometry);
    Random random(8);
    int tried = 0, found = 0, found_by_book = 0;
    for (int k = 0; k < 2000; ++k) {
      const vec3 d = random.direction();
      const Ray ray{0.9f * random.direction() - 4.0f * d, d};
      const auto hit = accelerator->intersect(ray);
      if (!hit || hit->primitive != 1) continue;
      const auto point = surface_point(geometry, ray, *hit);
      const vec3 wi = random.direction();
      if (glm::dot(wi, point.ng) > -0.1f) continue;
      ++tried;
      const auto inner = accelerator->intersect({offset_origin(point, wi), wi});
      found += inner && inner->primitive == 0 && inner->t < 1e-3f;
      const auto book = accelerator->intersect({point.position, wi, 0.001f});
      found_by_book += book && book->primitive == 0 && book->t < 1e-3f;
    }
    INFO(tested.label);
    CHECK(tried > 500);
    CHECK(found == tried);
    CHECK(found_by_book == 0);
  }
}

TEST_CASE("rays leave a closed box only where their start is rounded onto an edge", "[stability][offset]") {
  // Any offset would let these go: the start lies in the plane of the next wall, the nearest float being there. Of the
  // points of a face half a unit in the last place, over the size, lie so near to an edge.
  const FlushDenormals flush;
  for (const float at : {0.0f, 10.0f, 1e3f, 1e4f, 1e5f}) {
    Scene scene;
    const vec3 lower = vec3(at) - vec3(0.9f, 0.83f, 0.95f);
    add_box(scene, lower, lower + 2.0f, lambertian(grey(0.5f)));
    const auto accelerator = make_accelerator("bvh", scene.geometry);
    Random random(12);
    const vec3 centre = lower + 1.0f;
    Ray ray{centre, random.direction()};
    int left = 0;
    constexpr int kRays = 200'000;
    for (int k = 0; k < kRays; ++k) {
      const auto hit = accelerator->intersect(ray);
      if (!hit) {
        ++left;
        ray = {centre, random.direction()};
        continue;
      }
      const auto point = surface_point(scene.geometry, ray, *hit);
      const vec3 inward = glm::dot(point.ng, centre - point.position) > 0.0f ? point.ng : -point.ng;
      ray.direction = glm::normalize(inward + 0.999f * random.direction());
      ray.origin = offset_origin(point, ray.direction);
    }
    const double size = 2.0, ulp = next_float_up(at + 1.0f) - (at + 1.0f);
    INFO("at " << at << ": " << left << " of " << kRays);
    CHECK(left < 0.75 * kRays * ulp / size + 10.0);
  }
}

TEST_CASE("a surface point keeps the geometric normal beside the interpolated one", "[unit][offset]") {
  Geometry geometry;
  TriangleMesh mesh;
  mesh.positions = {vec3(0, 0, 0), vec3(1, 0, 0), vec3(0, 1, 0)};
  mesh.normals = {glm::normalize(vec3(1, 0, 0.2f)), glm::normalize(vec3(0, 1, 0.2f)), glm::normalize(vec3(0, 0, 1))};
  mesh.triangles = {uvec3(0, 1, 2)};
  mesh.texcoords = {vec2(0, 0), vec2(2, 0), vec2(0, 3)};
  mesh.pad_positions();
  geometry.meshes = {mesh};
  const auto at = [&](float u, float v, float from) {
    const vec3 p(u, v, 0.0f);
    return surface_point(geometry, Ray{p + vec3(0, 0, from), vec3(0, 0, -from)}, Hit{1.0f, u, v, 0, 0});
  };
  const SurfacePoint point = at(0.25f, 0.25f, 1.0f);
  CHECK(glm::length(point.position - vec3(0.25f, 0.25f, 0.0f)) < 1e-6f);
  CHECK(point.ng == vec3(0, 0, 1));
  CHECK(glm::length(point.ns - glm::normalize(0.5f * mesh.normals[0] + 0.25f * (mesh.normals[1] + mesh.normals[2]))) <
        1e-6f);
  CHECK(glm::length(point.uv - vec2(0.5f, 0.75f)) < 1e-6f);

  // The offset is along the geometric normal, to the side of the direction as that normal sees it.
  for (const vec3& wi : {vec3(0.9f, 0.1f, 0.3f), vec3(-0.9f, 0.0f, 0.01f), vec3(0.5f, 0.5f, -0.01f)}) {
    const vec3 origin = offset_origin(point, wi);
    CHECK(origin.x == point.position.x);
    CHECK(origin.y == point.position.y);
    CHECK(origin.z * wi.z > 0.0f);
  }

  // Seen from the back the normals stay where the winding puts them, on one side.
  const SurfacePoint back = at(0.25f, 0.25f, -1.0f);
  CHECK(back.ng == point.ng);
  CHECK(back.ns == point.ns);
  // Normals that point against the winding are turned to its side.
  for (vec3& n : geometry.meshes[0].normals) n = -n;
  CHECK(glm::length(at(0.25f, 0.25f, 1.0f).ns - point.ns) < 1e-6f);
  // Where interpolation gives nothing the geometric normal takes its place.
  geometry.meshes[0].normals = {vec3(1, 0, 0), vec3(-1, 0, 0), vec3(-1, 0, 0)};
  CHECK(at(0.25f, 0.25f, 1.0f).ns == vec3(0, 0, 1));
}

TEST_CASE("a sphere's texture coordinates go around its axis once and from pole to pole", "[unit][offset]") {
  CHECK(sphere_texcoords({0, 1, 0}).y == Approx(1.0f));
  CHECK(sphere_texcoords({0, -1, 0}).y == Approx(0.0f).margin(1e-6));
  CHECK(sphere_texcoords({1, 0, 0}).y == Approx(0.5f));
  CHECK(sphere_texcoords({1, 0, 0}).x == Approx(0.5f));
  CHECK(sphere_texcoords({0, 0, 1}).x == Approx(0.25f));
  CHECK(sphere_texcoords({0, 0, -1}).x == Approx(0.75f));
  CHECK(sphere_texcoords(glm::normalize(vec3(-1, 0, 1e-4f))).x == Approx(0.0f).margin(1e-4));
  CHECK(sphere_texcoords(glm::normalize(vec3(-1, 0, -1e-4f))).x == Approx(1.0f).margin(1e-4));
}
