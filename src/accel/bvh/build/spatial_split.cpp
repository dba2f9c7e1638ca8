#include "spatial_split.hpp"

#include <algorithm>
#include <cmath>

#include "raylab/geometry/geometry.hpp"

namespace raylab::bvh {

namespace {

constexpr int kMostBins = 32;

/// The box of the part of a triangle on one side of a plane.
struct Cut {
  dvec3 lower{static_cast<double>(kInfinity)};
  dvec3 upper{-static_cast<double>(kInfinity)};

  void extend(const dvec3& p) {
    lower = glm::min(lower, p);
    upper = glm::max(upper, p);
  }
};

bool is_empty(const Primitive& p) { return glm::any(glm::greaterThan(p.lower, p.upper)); }

/// A reference's two sides of a plane. One may be empty: the reference's box reaches farther than its triangle.
struct Sides {
  Primitive left, right;
};

Sides cut(const Geometry& geometry, const Primitive& reference, int axis, float plane) {
  const Triangle triangle = triangle_corners(geometry.meshes[reference.geometry], reference.primitive);
  const dvec3 corners[3] = {dvec3(triangle.p0), dvec3(triangle.p1), dvec3(triangle.p2)};
  const double at = plane;
  Cut left, right;
  for (int i = 0; i < 3; ++i) {
    const dvec3& a = corners[i];
    const dvec3& b = corners[(i + 1) % 3];
    if (a[axis] <= at) left.extend(a);
    if (a[axis] >= at) right.extend(a);
    if ((a[axis] < at) == (b[axis] < at) || a[axis] == at || b[axis] == at) continue;
    dvec3 crossing = a + (b - a) * ((at - a[axis]) / (b[axis] - a[axis]));
    crossing[axis] = at;
    left.extend(crossing);
    right.extend(crossing);
  }
  // A part is grown by what its whole triangle needs, since that is what is tested, and by as much again for the
  // rounding of the crossings.
  const float size = 2.0f * max_component(triangle_bounds(triangle).diagonal());
  const auto box = [&](const Cut& side) {
    Primitive p = reference;
    p.lower = vec3(side.lower);
    p.upper = vec3(side.upper);
    if (is_empty(p)) return p;
    grow(p, size);
    p.lower = glm::max(p.lower, reference.lower);
    p.upper = glm::min(p.upper, reference.upper);
    return p;
  };
  return {box(left), box(right)};
}

/// The planes between the bins of one axis.
class Slices {
 public:
  Slices(float lower, float upper, int bins) : bins_(bins), scale_(static_cast<float>(bins) / (upper - lower)) {
    for (int i = 0; i <= bins; ++i) {
      const float part = static_cast<float>(i) / static_cast<float>(bins);
      planes_[i] = lower * (1.0f - part) + upper * part;
    }
    usable_ = scale_ < kInfinity;
    for (int i = 0; i < bins; ++i) usable_ = usable_ && planes_[i] < planes_[i + 1];
  }

  int bins() const { return bins_; }
  bool usable() const { return usable_; }
  float plane(int i) const { return planes_[i]; }

  /// The bin where something begins at x, and where it ends.
  int first(float x) const {
    int i = guess(x);
    while (i > 0 && x < planes_[i]) --i;
    while (i < bins_ - 1 && x >= planes_[i + 1]) ++i;
    return i;
  }
  int last(float x) const {
    int i = guess(x);
    while (i > 0 && x <= planes_[i]) --i;
    while (i < bins_ - 1 && x > planes_[i + 1]) ++i;
    return i;
  }

 private:
  int guess(float x) const {
    return static_cast<int>(std::clamp((x - planes_[0]) * scale_, 0.0f, static_cast<float>(bins_ - 1)));
  }

  int bins_;
  float planes_[kMostBins + 1];
  float scale_;
  bool usable_;
};

/// A sphere is on the side of its centre.
float sphere_side(const Primitive& p, int axis) { return 0.5f * p.lower[axis] + 0.5f * p.upper[axis]; }

/// The first and the last bin that a reference reaches.
struct Reach {
  int first, last;

  Reach(const Geometry& geometry, const Primitive& reference, int axis, const Slices& slices) {
    const bool is_sphere = geometry.is_sphere(reference.geometry);
    first = slices.first(is_sphere ? sphere_side(reference, axis) : reference.lower[axis]);
    last = is_sphere ? first : std::max(first, slices.last(reference.upper[axis]));
  }
};

/// The references of each bin that begin and that end there.
struct Bins {
  std::uint32_t begins[kMostBins] = {}, ends[kMostBins] = {};
  Box begin_boxes[kMostBins], end_boxes[kMostBins];
};

/// Whether a plane, by the bin behind it, parts at most `spare` references, and may cost less than `most`: without the
/// parts of those that it parts. Cutting references is what takes time, and of primitives that lie on each other nearly
/// all for nothing.
struct Worth {
  bool plane[kMostBins + 1] = {};
  bool any = false;

  Worth(const Bins& bins, int count, std::size_t references, std::size_t spare, Four scale, float most) {
    float right_areas[kMostBins];
    Box right, left;
    for (int bin = count - 1; bin > 0; --bin) {
      right.extend(bins.begin_boxes[bin]);
      right_areas[bin] = scaled_area(right, scale);
    }
    std::size_t begun = 0, ended = 0;
    for (int bin = 1; bin < count; ++bin) {
      left.extend(bins.end_boxes[bin - 1]);
      begun += bins.begins[bin - 1];
      ended += bins.ends[bin - 1];
      if (begun - ended > spare) continue;
      const float left_area = ended == 0 ? 0.0f : scaled_area(left, scale);
      const float right_area = begun == references ? 0.0f : right_areas[bin];
      plane[bin] = left_area * leaf_cost(static_cast<std::uint32_t>(begun)) +
                       right_area * leaf_cost(static_cast<std::uint32_t>(references - ended)) <
                   most;
      any = any || plane[bin];
    }
  }
};

void search_axis(const Geometry& geometry, std::span<const Primitive> references, std::size_t spare, int axis,
                 const Slices& slices, Four scale, float most, SpatialSplit& best) {
  Bins bins;
  for (const Primitive& reference : references) {
    const Reach reach(geometry, reference, axis, slices);
    ++bins.begins[reach.first];
    ++bins.ends[reach.last];
    bins.begin_boxes[reach.first].extend(reference);
    bins.end_boxes[reach.last].extend(reference);
  }
  const Worth worth(bins, slices.bins(), references.size(), spare, scale, std::min(most, best.cost));
  if (!worth.any) return;

  Box boxes[kMostBins];
  for (const Primitive& reference : references) {
    const auto [first, last] = Reach(geometry, reference, axis, slices);
    Primitive rest = reference;
    for (int bin = first; bin < last && !is_empty(rest); ++bin) {
      if (!worth.plane[bin + 1]) continue;
      const Sides sides = cut(geometry, rest, axis, slices.plane(bin + 1));
      if (!is_empty(sides.left)) boxes[bin].extend(sides.left);
      rest = sides.right;
    }
    if (!is_empty(rest)) boxes[last].extend(rest);
  }

  Box right_boxes[kMostBins];
  std::uint32_t right_counts[kMostBins];
  Box box;
  std::uint32_t count = 0;
  for (int bin = slices.bins() - 1; bin > 0; --bin) {
    box.extend(boxes[bin]);
    right_boxes[bin] = box;
    right_counts[bin] = count += bins.ends[bin];
  }
  box = {};
  count = 0;
  for (int bin = 1; bin < slices.bins(); ++bin) {
    box.extend(boxes[bin - 1]);
    count += bins.begins[bin - 1];
    if (!worth.plane[bin] || count == 0 || right_counts[bin] == 0) continue;
    const float cost = scaled_area(box, scale) * leaf_cost(count) +
                       scaled_area(right_boxes[bin], scale) * leaf_cost(right_counts[bin]);
    if (cost < best.cost) best = {axis, slices.plane(bin), cost, count, right_counts[bin], box, right_boxes[bin]};
  }
}

}  // namespace

SpatialSplit find_spatial_split(const Geometry& geometry, std::span<const Primitive> references, std::size_t spare,
                                float most, const Box& bounds, Four scale) {
  const int bins = static_cast<int>(std::min<std::size_t>(kMostBins, 4 + references.size() / 8));
  SpatialSplit best;
  for (int axis = 0; axis < 3; ++axis) {
    const Slices slices(bounds.lower[axis], bounds.upper[axis], bins);
    if (slices.usable()) search_axis(geometry, references, spare, axis, slices, scale, most, best);
  }
  return best;
}

void partition_references(const Geometry& geometry, std::span<const Primitive> references, const SpatialSplit& split,
                          Four scale, std::vector<Primitive>& left, std::vector<Primitive>& right) {
  const int axis = split.axis;
  Box left_box = split.left_box, right_box = split.right_box;
  auto left_count = static_cast<float>(split.left_count);
  auto right_count = static_cast<float>(split.right_count);
  const auto joined = [](Box box, const Primitive& p) {
    box.extend(p);
    return box;
  };
  for (const Primitive& reference : references) {
    if (geometry.is_sphere(reference.geometry)) {
      (sphere_side(reference, axis) < split.plane ? left : right).push_back(reference);
      continue;
    }
    if (!(reference.upper[axis] > split.plane) || !(reference.lower[axis] < split.plane)) {
      (reference.lower[axis] < split.plane ? left : right).push_back(reference);
      continue;
    }
    const Sides sides = cut(geometry, reference, axis, split.plane);
    const bool in_left = !is_empty(sides.left), in_right = !is_empty(sides.right);
    // Whole on one side, if that costs less than in two parts.
    const float left_area = scaled_area(left_box, scale), right_area = scaled_area(right_box, scale);
    const float both = left_area * left_count + right_area * right_count;
    const Box all_left = joined(left_box, reference), all_right = joined(right_box, reference);
    const float only_left = scaled_area(all_left, scale) * left_count + right_area * (right_count - 1.0f);
    const float only_right = left_area * (left_count - 1.0f) + scaled_area(all_right, scale) * right_count;
    if (in_left && in_right && both <= only_left && both <= only_right) {
      left.push_back(sides.left);
      right.push_back(sides.right);
    } else if (!in_right || (in_left && only_left <= only_right)) {
      left.push_back(reference);
      left_box = all_left;
      --right_count;
    } else {
      right.push_back(reference);
      right_box = all_right;
      --left_count;
    }
  }
}

}  // namespace raylab::bvh
