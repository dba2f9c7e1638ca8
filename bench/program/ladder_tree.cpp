#include "ladder_tree.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "geometry/primitive_test.hpp"

namespace raylab::bench {

namespace {

constexpr std::uint32_t kLargestLeaf = 4;

class Builder {
 public:
  Builder(const Geometry& geometry, LadderSplit split) : split_(split) {
    tree_.ids = valid_primitives(geometry);
    for (const PrimitiveId& id : tree_.ids) items_.push_back({primitive_bounds(geometry, id), id});
  }

  LadderTree run() {
    if (items_.empty()) return {};
    tree_.nodes.emplace_back();
    build(0, 0, static_cast<std::uint32_t>(items_.size()), 1);
    for (std::size_t i = 0; i < items_.size(); ++i) tree_.ids[i] = items_[i].id;
    return std::move(tree_);
  }

 private:
  struct Item {
    Bounds bounds;
    PrimitiveId id;
  };

  void build(std::size_t node, std::uint32_t begin, std::uint32_t end, int depth) {
    Bounds bounds;
    for (std::uint32_t i = begin; i < end; ++i) bounds.extend(items_[i].bounds);
    tree_.depth = std::max(tree_.depth, depth);
    const std::uint32_t middle = part(bounds, begin, end, depth);
    tree_.nodes[node] = {bounds, begin, end - begin};
    if (middle == begin) return;
    const std::size_t child = tree_.nodes.size();
    tree_.nodes[node] = {bounds, static_cast<std::uint32_t>(child), 0};
    tree_.nodes.resize(child + 2);
    build(child, begin, middle, depth + 1);
    build(child + 1, middle, end, depth + 1);
  }

  /// Where the second part begins, or `begin` to make a leaf.
  std::uint32_t part(const Bounds& bounds, std::uint32_t begin, std::uint32_t end, int depth) {
    if (end - begin == 1) return begin;
    if (split_ == LadderSplit::heuristic) {
      if (end - begin <= kLargestLeaf) return begin;
      const std::uint32_t middle = depth < kDeepestHeuristic ? part_by_heuristic(begin, end) : begin;
      if (middle != begin) return middle;
    }
    const int axis = bounds.longest_axis();
    std::sort(items_.begin() + begin, items_.begin() + end,
              [axis](const Item& a, const Item& b) { return a.bounds.lower[axis] < b.bounds.lower[axis]; });
    return begin + (end - begin) / 2;
  }

  std::uint32_t part_by_heuristic(std::uint32_t begin, std::uint32_t end) {
    constexpr int kBins = 16;
    Bounds centers;
    for (std::uint32_t i = begin; i < end; ++i) centers.extend(items_[i].bounds.center());
    const vec3 extent = centers.diagonal();
    const auto bin_of = [&](const Item& item, int axis) {
      const float place = (item.bounds.center()[axis] - centers.lower[axis]) / extent[axis];
      return std::clamp(static_cast<int>(kBins * place), 0, kBins - 1);
    };
    int best_axis = -1, best_bin = 0;
    double best_cost = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      if (!(extent[axis] > 0.0f)) continue;
      std::array<Bounds, kBins> boxes;
      std::array<int, kBins> counts{};
      for (std::uint32_t i = begin; i < end; ++i) {
        const auto bin = static_cast<std::size_t>(bin_of(items_[i], axis));
        boxes[bin].extend(items_[i].bounds);
        ++counts[bin];
      }
      std::array<double, kBins> left_costs{};
      Bounds left, right;
      int left_count = 0, right_count = 0;
      for (std::size_t bin = 0; bin < kBins; ++bin) {
        left_costs[bin] = left_count == 0 ? 0.0 : static_cast<double>(left.half_area()) * left_count;
        left.extend(boxes[bin]);
        left_count += counts[bin];
      }
      for (std::size_t bin = kBins - 1; bin > 0; --bin) {
        right.extend(boxes[bin]);
        right_count += counts[bin];
        if (right_count == 0 || right_count == static_cast<int>(end - begin)) continue;
        const double cost = left_costs[bin] + static_cast<double>(right.half_area()) * right_count;
        if (cost < best_cost) {
          best_cost = cost;
          best_axis = axis;
          best_bin = static_cast<int>(bin);
        }
      }
    }
    if (best_axis < 0) return begin;
    const auto second = std::partition(items_.begin() + begin, items_.begin() + end,
                                       [&](const Item& item) { return bin_of(item, best_axis) < best_bin; });
    return static_cast<std::uint32_t>(second - items_.begin());
  }

  LadderSplit split_;
  std::vector<Item> items_;
  LadderTree tree_;
};

}  // namespace

LadderTree build_ladder_tree(const Geometry& geometry, LadderSplit split) { return Builder(geometry, split).run(); }

}  // namespace raylab::bench
