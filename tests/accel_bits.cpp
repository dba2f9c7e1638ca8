// The same hits on every machine: checksums that were recorded on x86 and hold on 64-bit Arm.
#include <bit>
#include <cmath>
#include <cstdlib>
#include <fstream>

#include "catch.hpp"
#include "raylab/accel/accelerator.hpp"
#include "raylab/core/parallel.hpp"
#include "raylab/core/random.hpp"
#include "raylab/measure/ray_sets.hpp"
#include "raylab/measure/shapes.hpp"

using namespace raylab;

namespace {

/// A checksum of bits, in their order.
class Checksum {
 public:
  void add(std::uint32_t bits) { sum_ = mix_bits(sum_ ^ bits); }
  void add(float x) { add(std::bit_cast<std::uint32_t>(x)); }
  void add(const vec3& v) {
    for (int axis = 0; axis < 3; ++axis) add(v[axis]);
  }
  std::uint64_t sum() const { return sum_; }

 private:
  std::uint64_t sum_ = 0;
};

/// Triangles of a closed mesh and of a soup, and spheres, of exact coordinates.
Geometry geometry() {
  Geometry g{{icosphere(vec3(0.0f), 1.0f, 4), triangle_soup(3000, 2.0f, 0.3f, 5)}, {}};
  for (int i = 0; i < 40; ++i) g.spheres.push_back({vec3(0.1f * i - 2.0f, 0.05f * i - 1.0f, 0.3f), 0.02f * (i + 1)});
  return g;
}

void print(std::ostream& out, const std::optional<Hit>& hit) {
  if (!hit) {
    out << " miss";
    return;
  }
  out << ' ' << hit->geometry << ' ' << hit->primitive;
  for (const float x : {hit->t, hit->u, hit->v}) out << ' ' << std::bit_cast<std::uint32_t>(x);
}

}  // namespace

TEST_CASE("hits have the same bits on every machine", "[agreement]") {
  const FlushDenormals flush;
  const Geometry g = geometry();
  const std::vector<Ray> rays = random_rays(g.bounds(), 20'000, 11);
  Checksum of_input;
  for (const TriangleMesh& mesh : g.meshes) {
    for (const vec3& p : mesh.positions) of_input.add(p);
  }
  for (const Ray& ray : rays) {
    of_input.add(ray.origin);
    of_input.add(ray.direction);
  }
  CHECK(of_input.sum() == 0xca045081c36186ebull);
  const auto hits_of = [&](const char* name, const AcceleratorOptions& options) {
    const auto accelerator = make_accelerator(name, g, options);
    Checksum hits;
    for (const Ray& ray : rays) {
      const auto hit = accelerator->intersect(ray);
      hits.add(hit ? hit->geometry : 0xffffffffu);
      if (!hit) continue;
      hits.add(hit->primitive);
      for (const float x : {hit->t, hit->u, hit->v}) hits.add(x);
    }
    return hits.sum();
  };
  constexpr std::uint64_t kWatertight = 0xfd972b46946022e4ull;
  for (const Isa isa : kCompiledIsas) {
    if (isa_supported(isa)) CHECK(hits_of("bvh", {.isa = isa}) == kWatertight);
  }
  CHECK(hits_of("list", {}) == kWatertight);
  CHECK(hits_of("list", {.intersector = Intersector::book}) == 0x513e411bd15b5e53ull);
  CHECK(hits_of("exact", {}) == 0xae439790329066f6ull);
}

// A hidden one, for tests/arm64/run, which runs it on both machines and counts the lines that differ: Arm flushes a
// result before it is rounded, x86 after, so that what rounds to 2^-126 is 0 on Arm alone.
TEST_CASE("hits are written at every scale down to 2^-126", "[.hits]") {
  const FlushDenormals flush;
  const char* const path = std::getenv("RAYLAB_HITS");
  REQUIRE(path != nullptr);
  std::ofstream out(path);
  for (int exponent = 0; exponent <= 126; ++exponent) {
    const float scale = std::ldexp(1.0f, -exponent);
    Geometry g = geometry();
    for (TriangleMesh& mesh : g.meshes) {
      for (vec3& p : mesh.positions) p *= scale;
    }
    for (Sphere& sphere : g.spheres) sphere = {sphere.center * scale, sphere.radius * scale};
    std::vector<Ray> rays = random_rays(geometry().bounds(), 500, 12);
    for (Ray& ray : rays) {
      ray.origin *= scale;
      ray.t_min *= scale;
    }
    for (const char* name : {"bvh", "exact"}) {
      const auto accelerator = make_accelerator(name, g, {});
      for (const Ray& ray : rays) {
        out << name << ' ' << exponent;
        print(out, accelerator->intersect(ray));
        out << '\n';
      }
    }
  }
  CHECK(out.flush().good());
}
