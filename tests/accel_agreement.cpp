// All accelerators against `list`, which tests every primitive.
#include "batches.hpp"
#include "catch.hpp"
#include "raylab/core/parallel.hpp"
#include "raylab/measure/agreement_cases.hpp"
#include "raylab/measure/ray_sets.hpp"
#include "raylab/measure/shapes.hpp"

using namespace raylab;
using raylab::test::check_batches;

namespace {

// What a sanitizer has no time for: it makes testing all primitives thirty times as slow.
#ifdef RAYLAB_SANITIZED
constexpr bool kAll = false;
#else
constexpr bool kAll = true;
#endif

/// The book's intersector is no match for the judge's; its tree alone is tested here.
AcceleratorOptions best_options(const std::string& name) {
  AcceleratorOptions options;
  if (name == "rtiow") options.intersector = Intersector::watertight;
  return options;
}

Geometry mixed() {
  return {{triangle_soup(300, 1.0f, 0.4f, 7), icosphere(vec3(0.0f), 0.5f, 2)}, sphere_soup(100, 1.0f, 0.2f, 7)};
}

}  // namespace

TEST_CASE("every accelerator agrees with testing all primitives on 10,000 random rays a scene", "[agreement]") {
  for (const AcceleratorEntry& entry : accelerators()) {
    if (!kAll && entry.name == "list") continue;  // the judge itself
    CHECK(passes_agreement(entry.name, best_options(entry.name), 1, [&](const auto& scene, const auto& report) {
      INFO(entry.name << " on " << scene.name << ": " << to_string(report));
      CHECK(report.agrees());
    }));
    if (kAll || entry.name == "bvh")
      CHECK(passes_agreement(entry.name, best_options(entry.name), 2, [](const auto&, const auto&) {}));
  }
}

namespace {

/// `bvh` with a fault of its own.
class Faulty : public Accelerator {
 public:
  explicit Faulty(const Geometry& geometry) : right_(make_accelerator("bvh", geometry)) {}
  std::optional<Hit> intersect(const Ray& ray) const noexcept override { return right_->intersect(ray); }
  bool occluded(const Ray& ray) const noexcept override { return right_->occluded(ray); }
  const BuildReport& build_report() const noexcept override { return right_->build_report(); }

 private:
  std::unique_ptr<Accelerator> right_;
};
struct IgnoresTMin : Faulty {
  using Faulty::Faulty;
  static Ray from_origin(Ray ray) { return {ray.origin, ray.direction, 0.0f, ray.t_max}; }
  std::optional<Hit> intersect(const Ray& ray) const noexcept override { return Faulty::intersect(from_origin(ray)); }
  bool occluded(const Ray& ray) const noexcept override { return Faulty::occluded(from_origin(ray)); }
};
struct OccludedIgnoresTMax : Faulty {
  using Faulty::Faulty;
  bool occluded(const Ray& ray) const noexcept override {
    return Faulty::occluded({ray.origin, ray.direction, ray.t_min, kInfinity});
  }
};
/// Enters only boxes through which the ray has some way to go.
class LosesFlatBoxes : public Faulty {
 public:
  explicit LosesFlatBoxes(const Geometry& geometry) : Faulty(geometry), geometry_(geometry) {}
  std::optional<Hit> intersect(const Ray& ray) const noexcept override {
    const auto hit = Faulty::intersect(ray);
    if (!hit) return hit;
    const vec3 size = primitive_bounds(geometry_, {hit->geometry, hit->primitive}).diagonal();
    return size.x > 0 && size.y > 0 && size.z > 0 ? hit : std::nullopt;
  }
  bool occluded(const Ray& ray) const noexcept override { return intersect(ray).has_value(); }

 private:
  const Geometry& geometry_;
};
struct ForgetsLastOfBatch : Faulty {
  using Faulty::Faulty;
  void intersect_batch(const RayBatch& rays, const HitBatch& hits) const noexcept override {
    Faulty::intersect_batch(rays, hits);
    if (rays.count % 8 == 7) hits.set(rays.count - 1, std::nullopt);
  }
};
struct OccludesNothingInBatches : Faulty {
  using Faulty::Faulty;
  void occluded_batch(const RayBatch& rays, std::uint8_t* occluded) const noexcept override {
    std::fill_n(occluded, rays.count, std::uint8_t{0});
  }
};

template <class Kind>
std::string verdict_on() {
  const AcceleratorEntry entry{"faulty", "", [](const Geometry& geometry, const AcceleratorOptions&) {
                                 return std::unique_ptr<Accelerator>(std::make_unique<Kind>(geometry));
                               }};
  std::string failed;
  const bool passes = passes_agreement(entry, {}, 1, [&](const AgreementCase& c, const AgreementReport& report) {
    if (!report.agrees()) failed += (failed.empty() ? "" : ", ") + c.name;
  });
  CHECK(passes == failed.empty());
  return failed;
}

}  // namespace

TEST_CASE("the agreement test finds an accelerator with one fault", "[agreement]") {
  CHECK(verdict_on<Faulty>().empty());
  CHECK_FALSE(verdict_on<IgnoresTMin>().empty());
  CHECK_FALSE(verdict_on<OccludedIgnoresTMax>().empty());
  CHECK(verdict_on<LosesFlatBoxes>() == "flat boxes");
  CHECK_FALSE(verdict_on<ForgetsLastOfBatch>().empty());
  CHECK_FALSE(verdict_on<OccludesNothingInBatches>().empty());
}

TEST_CASE("every accelerator answers a batch as it answers its rays one by one", "[agreement]") {
  const FlushDenormals flush;
  const Geometry geometry = mixed();
  std::vector<Ray> rays = random_rays(geometry.bounds(), 3000, 11);
  const std::vector<Ray> axes = axis_aligned_rays(geometry.bounds(), 300, 12);
  rays.insert(rays.end(), axes.begin(), axes.end());
  for (const AcceleratorEntry& entry : accelerators()) {
    INFO(entry.name);
    check_batches(*entry.make(geometry, best_options(entry.name)), rays);
  }
}

TEST_CASE("Embree agrees with testing all primitives, and meets what exact meets, however it is built", "[agreement]") {
  const FlushDenormals flush;
  const Geometry geometry = mixed();
  const auto exact = make_accelerator("exact", geometry);
  for (const char* name : {"embree", "embree-robust"}) {
    for (const BuildQuality quality : {BuildQuality::fast, BuildQuality::balanced, BuildQuality::best}) {
      for (const bool compact : {false, true}) {
        if (!kAll && compact && quality != BuildQuality::balanced) continue;
        const AcceleratorOptions options{.quality = quality, .compact = compact};
        INFO(name << " " << quality_name(quality) << (compact ? " compact" : ""));
        passes_agreement(name, options, 1, [&](const auto& scene, const auto& report) {
          INFO(scene.name << ": " << to_string(report));
          CHECK(report.agrees());
        });
        const auto tested = make_accelerator(name, geometry, options);
        const std::vector<Ray> rays = random_rays(geometry.bounds(), 10'000, 19);
        std::size_t other_presence = 0;
        for (const Ray& ray : rays) other_presence += tested->occluded(ray) != exact->occluded(ray);
        CHECK(other_presence == 0);
      }
    }
  }
}

TEST_CASE("Embree's build quality and compactness reach it: trees differ in size", "[unit]") {
  const Geometry geometry{{triangle_soup(2000, 1.0f, 0.4f, 7)}, {}};
  const auto bytes = [&](const AcceleratorOptions& options) {
    return make_accelerator("embree", geometry, options)->build_report().bytes;
  };
  CHECK(bytes({.quality = BuildQuality::best}) != bytes({.quality = BuildQuality::balanced}));
  CHECK(bytes({.quality = BuildQuality::fast}) != bytes({.quality = BuildQuality::balanced}));
  CHECK(bytes({.compact = true}) < bytes({}));
}

TEST_CASE("the book's and the fast triangle test meet the same well-scaled triangles as the watertight one",
          "[agreement]") {
  for (const char* name : {"rtiow", "list"}) {
    for (const Intersector intersector : {Intersector::book, Intersector::fast}) {
      if (!kAll && name == std::string("list")) continue;  // it has the same test of a triangle
      passes_agreement(name, {intersector, 0}, 3, [&](const AgreementCase& scene, const AgreementReport& report) {
        if (!scene.geometry.spheres.empty()) return;  // the book's spheres have a test of their own
        INFO(name << " " << intersector_name(intersector) << " on " << scene.name << ": " << to_string(report));
        // Not wrong_primitives: on slivers their t is off by more than the tolerance.
        CHECK(report.false_misses.count == 0);
        CHECK(report.false_hits.count == 0);
        CHECK(report.occlusion.count == 0);
      });
    }
  }
}

TEST_CASE("every accelerator agrees with testing all primitives on rays along the axes", "[agreement]") {
  const Geometry geometry = mixed();
  const auto judge = make_accelerator("list", geometry);
  const std::vector<Ray> rays = axis_aligned_rays(geometry.bounds(), 10'000, 5);
  for (const AcceleratorEntry& entry : accelerators()) {
    const auto tested = entry.make(geometry, best_options(entry.name));
    const AgreementReport report = compare_hits(*tested, *judge, geometry, rays);
    INFO(entry.name << ": " << to_string(report));
    CHECK(report.agrees());
  }
}

TEST_CASE("every accelerator gives the same hits for directions of any length", "[agreement]") {
  const Geometry geometry = mixed();
  const auto judge = make_accelerator("list", geometry);
  for (const AcceleratorEntry& entry : accelerators()) {
    const auto tested = entry.make(geometry, best_options(entry.name));
    for (const int k : {-110, -60, -40, -30, -10, 10, 30, 40, 60, 110}) {
      std::vector<Ray> rays = random_rays(geometry.bounds(), 500, 11);
      for (Ray& ray : rays) ray.direction *= std::ldexp(1.0f, k);
      const AgreementReport report = compare_hits(*tested, *judge, geometry, rays);
      INFO(entry.name << ", 2^" << k << ": " << to_string(report));
      CHECK(report.hits > 100);
      CHECK(report.agrees());
    }
  }
}

TEST_CASE("occluded says what intersect says at the ends of the interval, and t lies inside it", "[agreement]") {
  const FlushDenormals flush;
  const Geometry geometry = mixed();
  for (const AcceleratorEntry& entry : accelerators()) {
    for (const float length : {1.0f, 0x1p-50f, 0x1p50f}) {
      const auto accelerator = entry.make(geometry, {});
      for (Ray ray : random_rays(geometry.bounds(), 2000, 13)) {
        ray.direction *= length;
        const auto hit = accelerator->intersect(ray);
        if (!hit) continue;
        const float t = hit->t;
        const float ends[] = {next_float_down(t), t, next_float_up(t)};
        std::vector<Ray> ended = {{ray.origin, ray.direction, t, t}};
        for (const float end : ends) ended.push_back({ray.origin, ray.direction, 0.0f, end});
        for (const float end : ends) ended.push_back({ray.origin, ray.direction, end, kInfinity});
        for (const float end : ends) ended.push_back({ray.origin, ray.direction, end, next_float_up(end)});
        for (const Ray& r : ended) {
          const auto found = accelerator->intersect(r);
          INFO(entry.name << ": " << to_string(Disagreement{r, found, hit}));
          REQUIRE(found.has_value() == accelerator->occluded(r));
          if (found) REQUIRE((found->t > r.t_min && found->t < r.t_max));
        }
      }
    }
  }
}

TEST_CASE("the ends of the interval are open in every accelerator", "[unit]") {
  const FlushDenormals flush;
  // t = 2 without rounding, on a triangle and on a sphere.
  const Geometry geometry{{TriangleMesh{{{-1, -1, 2}, {3, -1, 2}, {-1, 3, 2}}, {{0, 1, 2}}, {}, {}, {}, {}}},
                          {{{10, 0, 3}, 1}}};
  for (const AcceleratorEntry& entry : accelerators()) {
    const auto accelerator = entry.make(geometry, {});
    for (const float x : {0.0f, 10.0f}) {
      INFO(entry.name << " at x = " << x);
      // A few ulp apart, since Embree multiplies the ends by a determinant before it compares.
      const auto ray = [&](float t_min, float t_max) { return Ray{{x, 0, 0}, {0, 0, 1}, t_min, t_max}; };
      CHECK(accelerator->occluded(ray(0.0f, 2.000001f)));
      CHECK_FALSE(accelerator->occluded(ray(0.0f, 1.999999f)));
      CHECK_FALSE(accelerator->occluded(ray(0.0f, 2.0f)));
      CHECK(accelerator->occluded(ray(1.999999f, 2.5f)));
      CHECK_FALSE(accelerator->occluded(ray(2.0f, 2.5f)));
      CHECK_FALSE(accelerator->occluded(ray(2.000001f, 2.5f)));
      CHECK_FALSE(accelerator->occluded(ray(2.5f, 1.5f)));
      CHECK_FALSE(accelerator->intersect(ray(2.5f, 1.5f)));
      if (x == 0.0f) continue;
      // Spheres are no one's but ours: exact to the last float.
      CHECK(accelerator->occluded(ray(0.0f, next_float_up(2.0f))));
      CHECK(accelerator->occluded(ray(next_float_down(2.0f), 2.5f)));
    }
  }
}

TEST_CASE("all threads asking at once get what one gets alone", "[agreement]") {
  const Geometry geometry = mixed();
  const std::vector<Ray> rays = random_rays(geometry.bounds(), 5000, 17);
  for (const AcceleratorEntry& entry : accelerators()) {
    const auto accelerator = entry.make(geometry, {});
    std::vector<std::optional<Hit>> alone(rays.size());
    {
      const FlushDenormals flush;
      for (std::size_t i = 0; i < rays.size(); ++i) alone[i] = accelerator->intersect(rays[i]);
    }
    std::vector<char> same(4 * rays.size());
    parallel_for(same.size(), [&](std::size_t i) {
      const std::size_t k = i % rays.size();
      same[i] = accelerator->intersect(rays[k]) == alone[k] && accelerator->occluded(rays[k]) == alone[k].has_value();
    });
    INFO(entry.name);
    CHECK(std::count(same.begin(), same.end(), 0) == 0);
  }
}
