// `rtiow`: the bounding volume hierarchy of Shirley, Black and Hollasch, "Ray Tracing: The Next Week" (v4),
// with its choices and its faults: nodes behind shared pointers, recursion, the median of a full sort along the
// longest axis, one object a leaf, boxes padded by an absolute amount, a slab test that lets NaN through.
// Boxes and slabs are in double, as in the book: in float its padding of 0.0001 vanishes beyond 1024, and a wall of
// the Cornell box with it.
// It is the baseline the other accelerators are measured against: what is wrong here stays wrong.
#include <algorithm>
#include <limits>

#include "backends.hpp"
#include "geometry/primitive_test.hpp"
#include "raylab/core/timing.hpp"

namespace raylab {

namespace {

/// No side of the book's boxes is shorter than this, however large or small the scene.
constexpr double kBookPadding = 0.0001;

/// A ray with what the hittables of one tree need of it.
template <Intersector kind>
struct BookRay {
  explicit BookRay(const Ray& ray) : test(ray), origin(ray.origin), direction(ray.direction) {}
  PrimitiveTest<kind> test;
  dvec3 origin, direction;
};

struct BookBox {
  dvec3 lower = dvec3(std::numeric_limits<double>::infinity());
  dvec3 upper = dvec3(-std::numeric_limits<double>::infinity());

  BookBox() = default;

  BookBox(const dvec3& lowest, const dvec3& highest) : lower(lowest), upper(highest) {
    for (int axis = 0; axis < 3; ++axis) {
      if (upper[axis] - lower[axis] < kBookPadding) {
        lower[axis] -= kBookPadding / 2;
        upper[axis] += kBookPadding / 2;
      }
    }
  }

  void extend(const BookBox& b) {
    lower = glm::min(lower, b.lower);
    upper = glm::max(upper, b.upper);
  }

  int longest_axis() const {
    const dvec3 d = upper - lower;
    if (d.x > d.y) return d.x > d.z ? 0 : 2;
    return d.y > d.z ? 1 : 2;
  }

  double half_area() const {
    const dvec3 d = upper - lower;
    return d.x * d.y + d.y * d.z + d.z * d.x;
  }

  bool hit(const dvec3& origin, const dvec3& direction, double t_min, double t_max) const {
    for (int axis = 0; axis < 3; ++axis) {
      const double inverse = 1.0 / direction[axis];
      const double t0 = (lower[axis] - origin[axis]) * inverse;
      const double t1 = (upper[axis] - origin[axis]) * inverse;
      if (t0 < t1) {
        if (t0 > t_min) t_min = t0;
        if (t1 < t_max) t_max = t1;
      } else {
        if (t1 > t_min) t_min = t1;
        if (t0 < t_max) t_max = t0;
      }
      if (t_max <= t_min) return false;
    }
    return true;
  }
};

template <Intersector kind>
class Hittable {
 public:
  virtual ~Hittable() = default;
  virtual std::optional<Hit> hit(const BookRay<kind>& ray, float t_min, float t_max) const = 0;
  virtual const BookBox& bounding_box() const = 0;
};

template <Intersector kind>
using Objects = std::vector<std::shared_ptr<Hittable<kind>>>;

template <Intersector kind>
class Object final : public Hittable<kind> {
 public:
  Object(const Geometry& geometry, const PrimitiveId& id)
      : geometry_(geometry), id_(id), box_(exact_bounds(geometry, id)) {}

  std::optional<Hit> hit(const BookRay<kind>& ray, float t_min, float t_max) const override {
    return ray.test(geometry_, id_, t_min, t_max);
  }
  const BookBox& bounding_box() const override { return box_; }

 private:
  /// The book does not round the bounds of a sphere outward.
  static BookBox exact_bounds(const Geometry& geometry, const PrimitiveId& id) {
    if (geometry.is_sphere(id.geometry)) {
      const Sphere& s = geometry.spheres[id.primitive];
      const auto radius = static_cast<double>(s.radius);
      return {dvec3(s.center) - radius, dvec3(s.center) + radius};
    }
    const Bounds b = primitive_bounds(geometry, id);
    return {dvec3(b.lower), dvec3(b.upper)};
  }

  const Geometry& geometry_;
  PrimitiveId id_;
  BookBox box_;
};

/// What is learnt of the tree while it is built.
struct Tally {
  std::size_t bytes = 0;
  std::size_t nodes = 0;
  int depth = 0;
  double weighted_area = 0.0;  ///< half areas of the nodes, each times one plus the objects right below it
};

/// Counts the bytes that shared pointers ask for, their reference counts included.
template <class T>
struct CountingAllocator {
  using value_type = T;
  explicit CountingAllocator(std::size_t& bytes) : bytes(&bytes) {}
  template <class U>
  CountingAllocator(const CountingAllocator<U>& other) : bytes(other.bytes) {}
  T* allocate(std::size_t n) {
    *bytes += n * sizeof(T);
    return std::allocator<T>().allocate(n);
  }
  void deallocate(T* p, std::size_t n) { std::allocator<T>().deallocate(p, n); }
  template <class U>
  bool operator==(const CountingAllocator<U>&) const {
    return true;  // any of them frees what another allocated
  }
  std::size_t* bytes;  ///< dangles once the tree is built; allocate() is not called then
};

template <class T, class... Args>
std::shared_ptr<T> make_counted(Tally& tally, Args&&... args) {
  return std::allocate_shared<T>(CountingAllocator<T>(tally.bytes), std::forward<Args>(args)...);
}

template <Intersector kind>
class Node final : public Hittable<kind> {
 public:
  /// The tree over objects[start, end), which must not be empty; sorts them.
  Node(Objects<kind>& objects, std::size_t start, std::size_t end, int depth, Tally& tally) {
    for (std::size_t i = start; i < end; ++i) box_.extend(objects[i]->bounding_box());
    const int axis = box_.longest_axis();
    const std::size_t span = end - start;
    if (span == 1) {
      left_ = right_ = objects[start];  // tested twice, as in the book
    } else if (span == 2) {
      left_ = objects[start];
      right_ = objects[start + 1];
    } else {
      std::sort(objects.begin() + static_cast<std::ptrdiff_t>(start),
                objects.begin() + static_cast<std::ptrdiff_t>(end), [axis](const auto& a, const auto& b) {
                  return a->bounding_box().lower[axis] < b->bounding_box().lower[axis];
                });
      const std::size_t middle = start + span / 2;
      left_ = make_counted<Node>(tally, objects, start, middle, depth + 1, tally);
      right_ = make_counted<Node>(tally, objects, middle, end, depth + 1, tally);
    }
    const int objects_below = span <= 2 ? 2 : 0;
    tally.nodes += 1;
    tally.depth = std::max(tally.depth, depth + 1);
    tally.weighted_area += box_.half_area() * (1 + objects_below);
  }

  std::optional<Hit> hit(const BookRay<kind>& ray, float t_min, float t_max) const override {
    if (!box_.hit(ray.origin, ray.direction, t_min, t_max)) return std::nullopt;
    const auto hit_left = left_->hit(ray, t_min, t_max);
    const auto hit_right = right_->hit(ray, t_min, hit_left ? hit_left->t : t_max);
    return hit_right ? hit_right : hit_left;
  }
  const BookBox& bounding_box() const override { return box_; }

 private:
  std::shared_ptr<Hittable<kind>> left_, right_;
  BookBox box_;
};

template <Intersector kind>
class RtiowBvh final : public Accelerator {
 public:
  explicit RtiowBvh(const Geometry& geometry) {
    const Stopwatch watch;
    Tally tally;
    Objects<kind> objects;
    for (const PrimitiveId& id : valid_primitives(geometry)) {
      objects.push_back(make_counted<Object<kind>>(tally, geometry, id));
    }
    if (!objects.empty()) root_ = make_counted<Node<kind>>(tally, objects, 0, objects.size(), 1, tally);
    report_.seconds = watch.seconds();
    report_.bytes = sizeof(*this) + tally.bytes;
    report_.primitives = objects.size();
    report_.invalid_primitives = geometry.primitive_count() - objects.size();
    report_.nodes = tally.nodes;
    report_.depth = tally.depth;
    if (root_) report_.sah_cost = tally.weighted_area / root_->bounding_box().half_area();
    report_.isa = compiled_isa();
  }

  std::optional<Hit> intersect(const Ray& ray) const noexcept override {
    if (!root_) return std::nullopt;
    return root_->hit(BookRay<kind>(ray), ray.t_min, ray.t_max);
  }

  /// The book has no any-hit query.
  bool occluded(const Ray& ray) const noexcept override { return intersect(ray).has_value(); }

  const BuildReport& build_report() const noexcept override { return report_; }

 private:
  std::shared_ptr<Hittable<kind>> root_;
  BuildReport report_;
};

}  // namespace

std::unique_ptr<Accelerator> make_rtiow(const Geometry& geometry, const AcceleratorOptions& options) {
  return make_with_intersector<RtiowBvh>(options.intersector.value_or(Intersector::book), geometry);
}

}  // namespace raylab
