// `grid`: a uniform grid (Amanatides and Woo 1987, "A Fast Voxel Traversal Algorithm for Ray Tracing").
// This file is all it takes to add an accelerator: a class that answers the two queries, and a registration.
#include <algorithm>
#include <cmath>
#include <raylab/accel/accelerator.hpp>
#include <raylab/core/error.hpp>
#include <raylab/core/timing.hpp>
#include <raylab/geometry/intersect.hpp>

namespace {

using namespace raylab;
using Cell = glm::ivec3;

class Grid final : public Accelerator {
 public:
  explicit Grid(const Geometry& geometry) : geometry_(geometry) {
    const Stopwatch watch;
    const std::vector<PrimitiveId> primitives = valid_primitives(geometry);
    for (const PrimitiveId& id : primitives) bounds_.extend(primitive_bounds(geometry, id));
    if (!primitives.empty()) {
      choose_cells(primitives.size());
      fill(primitives);
    }
    report_.primitives = primitives.size();
    report_.invalid_primitives = geometry.primitive_count() - primitives.size();
    report_.bytes = sizeof(*this) + start_.capacity() * sizeof(start_[0]) + items_.capacity() * sizeof(items_[0]);
    report_.seconds = watch.seconds();
  }

  std::optional<Hit> intersect(const Ray& ray) const noexcept override {
    const auto test = [&](const PrimitiveId& id, float t_max) {
      return intersect_primitive(Intersector::watertight, ray, geometry_, id, ray.t_min, t_max);
    };
    std::optional<Hit> closest;
    walk(ray, [&](std::span<const PrimitiveId> ids, float t_exit) {
      for (const PrimitiveId& id : ids) {
        if (const auto hit = test(id, closest ? closest->t : ray.t_max)) closest = hit;
      }
      return closest && closest->t <= t_exit;  // a hit beyond this cell may not be the closest
    });
    return closest;
  }

  bool occluded(const Ray& ray) const noexcept override {
    const auto test = [&](const PrimitiveId& id, float t_max) {
      return intersect_primitive(Intersector::watertight, ray, geometry_, id, ray.t_min, t_max);
    };
    bool found = false;
    walk(ray, [&](std::span<const PrimitiveId> ids, float) {
      found = std::any_of(ids.begin(), ids.end(), [&](const auto& id) { return test(id, ray.t_max).has_value(); });
      return found;
    });
    return found;
  }

  const BuildReport& build_report() const noexcept override { return report_; }

 private:
  static constexpr int kMostCells = 64;
  /// Primitives are entered into all cells that come this near, in cells, so that the rounding of the walk does
  /// not matter.
  static constexpr float kMargin = 0.01f;

  /// About eight cells a primitive, as near to cubes as may be.
  void choose_cells(std::size_t primitives) {
    // No side may be zero: of a flat mesh, or of a single point.
    const float largest = max_component(glm::max(glm::abs(bounds_.lower), glm::abs(bounds_.upper)));
    const vec3 margin = kMargin * bounds_.diagonal() + 1e-4f * largest + 1e-20f;
    bounds_.lower -= margin;
    bounds_.upper += margin;
    const vec3 size = bounds_.diagonal();
    const float along_longest = 2.0f * std::cbrt(static_cast<float>(primitives));
    for (int axis = 0; axis < 3; ++axis) {
      const float wanted = along_longest * size[axis] / max_component(size);
      cells_[axis] = std::clamp(static_cast<int>(wanted), 1, kMostCells);
      cell_size_[axis] = size[axis] / static_cast<float>(cells_[axis]);
    }
  }

  /// Counts first, so that the lists of all cells lie in one array.
  void fill(const std::vector<PrimitiveId>& primitives) {
    start_.assign(static_cast<std::size_t>(cells_.x) * cells_.y * cells_.z + 1, 0);
    for (const PrimitiveId& id : primitives) {
      for_each_cell(id, [&](std::size_t cell) { ++start_[cell + 1]; });
    }
    for (std::size_t i = 1; i < start_.size(); ++i) start_[i] += start_[i - 1];
    items_.resize(start_.back());
    std::vector<std::size_t> next(start_.begin(), start_.end() - 1);
    for (const PrimitiveId& id : primitives) {
      for_each_cell(id, [&](std::size_t cell) { items_[next[cell]++] = id; });
    }
  }

  template <class Action>
  void for_each_cell(const PrimitiveId& id, const Action& action) const {
    const Bounds b = primitive_bounds(geometry_, id);
    const Cell first = cell_at(b.lower - kMargin * cell_size_);
    const Cell last = cell_at(b.upper + kMargin * cell_size_);
    for (int z = first.z; z <= last.z; ++z) {
      for (int y = first.y; y <= last.y; ++y) {
        for (int x = first.x; x <= last.x; ++x) action(index({x, y, z}));
      }
    }
  }

  Cell cell_at(const vec3& p) const {
    const vec3 scaled = glm::clamp((p - bounds_.lower) / cell_size_, vec3(0.0f), vec3(cells_ - 1));
    return Cell(scaled);
  }

  std::size_t index(const Cell& c) const { return (static_cast<std::size_t>(c.z) * cells_.y + c.y) * cells_.x + c.x; }

  /// Calls visit(primitives, t at which the ray leaves the cell) for the cells along the ray, until it says true.
  template <class Visit>
  void walk(const Ray& ray, const Visit& visit) const {
    if (start_.empty()) return;
    float t_enter = ray.t_min;
    float t_leave = ray.t_max;
    for (int axis = 0; axis < 3; ++axis) {
      if (ray.direction[axis] == 0.0f) {
        if (ray.origin[axis] < bounds_.lower[axis] || ray.origin[axis] > bounds_.upper[axis]) return;
        continue;
      }
      const float t0 = (bounds_.lower[axis] - ray.origin[axis]) / ray.direction[axis];
      const float t1 = (bounds_.upper[axis] - ray.origin[axis]) / ray.direction[axis];
      t_enter = std::max(t_enter, std::min(t0, t1));
      t_leave = std::min(t_leave, std::max(t0, t1));
    }
    if (!(t_enter <= t_leave)) return;

    Cell cell = cell_at(ray.at(t_enter));
    for (;;) {
      int axis = 0;
      vec3 t_exit(kInfinity);
      for (int k = 0; k < 3; ++k) {
        if (ray.direction[k] == 0.0f) continue;
        const auto side = static_cast<float>(cell[k] + (ray.direction[k] > 0.0f ? 1 : 0));
        t_exit[k] = (bounds_.lower[k] + side * cell_size_[k] - ray.origin[k]) / ray.direction[k];
        if (t_exit[k] < t_exit[axis]) axis = k;
      }
      const std::size_t i = index(cell);
      if (visit(std::span(items_).subspan(start_[i], start_[i + 1] - start_[i]), t_exit[axis])) return;
      cell[axis] += ray.direction[axis] > 0.0f ? 1 : -1;
      if (t_exit[axis] > t_leave || cell[axis] < 0 || cell[axis] >= cells_[axis]) return;
    }
  }

  const Geometry& geometry_;
  Bounds bounds_;
  Cell cells_{0};
  vec3 cell_size_{0.0f};
  std::vector<std::size_t> start_;  ///< cell i holds items_[start_[i]] up to items_[start_[i + 1]]
  std::vector<PrimitiveId> items_;
  BuildReport report_;
};

std::unique_ptr<Accelerator> make_grid(const Geometry& geometry, const AcceleratorOptions& options) {
  if (options.intersector) throw Error(ErrorKind::usage, "--intersector", "grid is always watertight");
  return std::make_unique<Grid>(geometry);
}

const RegisterAccelerator registered{{"grid", "a uniform grid", make_grid}};

}  // namespace
