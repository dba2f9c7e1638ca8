// `list`: every primitive is tested. Without a tree there is nothing but the intersector to be wrong, so it
// judges the others.
#include "backends.hpp"
#include "geometry/primitive_test.hpp"
#include "raylab/core/timing.hpp"

namespace raylab {

namespace {

template <Intersector kind>
class List final : public Accelerator {
 public:
  explicit List(const Geometry& geometry) : geometry_(geometry) {
    const Stopwatch watch;
    primitives_ = valid_primitives(geometry);
    report_.primitives = primitives_.size();
    report_.invalid_primitives = geometry.primitive_count() - primitives_.size();
    report_.bytes = sizeof(*this) + primitives_.capacity() * sizeof(PrimitiveId);
    report_.sah_cost = static_cast<double>(primitives_.size());
    report_.isa = compiled_isa();
    report_.seconds = watch.seconds();
  }

  std::optional<Hit> intersect(const Ray& ray) const noexcept override {
    const PrimitiveTest<kind> test(ray);
    std::optional<Hit> closest;
    float t_max = ray.t_max;
    for (const PrimitiveId& id : primitives_) {
      if (const auto hit = test(geometry_, id, ray.t_min, t_max)) {
        closest = hit;
        t_max = hit->t;
      }
    }
    return closest;
  }

  bool occluded(const Ray& ray) const noexcept override {
    const PrimitiveTest<kind> test(ray);
    for (const PrimitiveId& id : primitives_) {
      if (test(geometry_, id, ray.t_min, ray.t_max)) return true;
    }
    return false;
  }

  const BuildReport& build_report() const noexcept override { return report_; }

 private:
  const Geometry& geometry_;
  std::vector<PrimitiveId> primitives_;
  BuildReport report_;
};

}  // namespace

std::unique_ptr<Accelerator> make_list(const Geometry& geometry, const AcceleratorOptions& options) {
  return make_with_intersector<List>(options.intersector.value_or(Intersector::watertight), geometry);
}

}  // namespace raylab
